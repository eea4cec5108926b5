#include "render/solid_depths.h"

namespace meniscus {

Image<float> solid_depths(const View& view, const Scene& scene, const SceneBuffers* seen) {
  if (seen) return seen->depth;
  Image<float> depth(view.width, view.height);
  const auto width = static_cast<std::size_t>(view.width);
  parallel_for(static_cast<std::size_t>(view.height), 8, [&](std::size_t begin, std::size_t end) {
    std::vector<Ray> rays(width);
    for (std::size_t y = begin; y < end; ++y) {
      for (std::size_t x = 0; x < width; ++x)
        rays[x] = view.ray({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
      scene.distances(rays, {depth.data() + y * width, width});
    }
  });
  return depth;
}

}  // namespace meniscus
