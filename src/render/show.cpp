#include "render/show.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace meniscus {
namespace {

vec3 normal_colour(const View& view, vec3 normal) {
  const vec3 seen{glm::dot(normal, view.right), glm::dot(normal, view.up), -glm::dot(normal, view.forward)};
  const vec3 srgb = glm::clamp(0.5f * seen + 0.5f, 0.0f, 1.0f);
  return {linear_from_srgb(srgb.x), linear_from_srgb(srgb.y), linear_from_srgb(srgb.z)};
}

}  // namespace

Show show_of(std::string_view name) {
  if (name == "water") return Show::water;
  if (name == "normals") return Show::normals;
  if (name == "thickness") return Show::thickness;
  if (name == "depth") return Show::depth;
  throw Error(ErrorCode::invalid_argument, {"there is nothing to show of that name",
                                            "water, normals, thickness or depth",
                                            std::string(name),
                                            {},
                                            {},
                                            {},
                                            {}});
}

Image<vec3> shown(Show show, const View& view, const SurfaceBuffers& buffers) {
  if (show == Show::water) throw Error(ErrorCode::invalid_argument, "the shaded water is not one of the buffers");
  float nearest = std::numeric_limits<float>::infinity(), farthest = 0, thickest = 0;
  for (std::size_t i = 0; i < buffers.depth.size(); ++i) {
    if (!(buffers.coverage[i] > 0) || !(buffers.depth[i] < std::numeric_limits<float>::infinity())) continue;
    nearest = std::min(nearest, buffers.depth[i]);
    farthest = std::max(farthest, buffers.depth[i]);
    thickest = std::max(thickest, buffers.thickness[i]);
  }
  Image<vec3> picture(buffers.depth.width(), buffers.depth.height(), vec3{1.0f});
  // Where the outline crosses a pixel whose centre misses the water, a neighbour tells its colour.
  const auto source = [&](std::size_t i) {
    const auto seen = [&](std::size_t k) { return buffers.depth[k] < std::numeric_limits<float>::infinity(); };
    const auto width = static_cast<std::size_t>(picture.width());
    if (seen(i)) return i;
    if (i % width > 0 && seen(i - 1)) return i - 1;
    if (i % width + 1 < width && seen(i + 1)) return i + 1;
    if (i >= width && seen(i - width)) return i - width;
    if (i + width < picture.size() && seen(i + width)) return i + width;
    return picture.size();
  };
  parallel_for(picture.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (!(buffers.coverage[i] > 0)) continue;
      const std::size_t from = source(i);
      if (from == picture.size()) continue;
      vec3 colour{0};
      switch (show) {
        case Show::water:
          break;
        case Show::normals:
          colour = normal_colour(view, buffers.normal[from]);
          break;
        case Show::thickness:
          colour = colormap_at(Colormap::viridis, buffers.thickness[i] / std::max(thickest, 1e-20f));
          break;
        case Show::depth:
          colour = vec3{1.0f - 0.9f * (buffers.depth[from] - nearest) / std::max(farthest - nearest, 1e-20f)};
          break;
      }
      picture[i] = glm::mix(picture[i], colour, std::min(buffers.coverage[i], 1.0f));
    }
  });
  return picture;
}

}  // namespace meniscus
