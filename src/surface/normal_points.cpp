#include <cmath>
#include <glm/geometric.hpp>

#include "surface/normal_filter.h"

namespace meniscus {

void take_filtered_normals(const View& view, const SurfaceBuffers& coarse, std::span<const vec2> points,
                           float tolerance, SurfaceBuffers& fine) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const Image<vec3>& normals = coarse.unbent_normal.empty() ? coarse.normal : coarse.unbent_normal;
  parallel_for(points.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (!(fine.depth[i] < kInfinity)) continue;
      const Ray ray = view.ray(points[i]);
      const vec3 own = ray.origin + fine.depth[i] * ray.direction;
      const int x = static_cast<int>(points[i].x), y = static_cast<int>(points[i].y);
      vec3 sum{0};
      for (int qy = std::max(y - 1, 0); qy <= std::min(y + 1, view.height - 1); ++qy)
        for (int qx = std::max(x - 1, 0); qx <= std::min(x + 1, view.width - 1); ++qx) {
          const float depth = coarse.depth(qx, qy);
          if (!(depth < kInfinity)) continue;
          const Ray other = view.ray({static_cast<float>(qx) + 0.5f, static_cast<float>(qy) + 0.5f});
          const vec3 normal = normals(qx, qy);
          const float off_plane = glm::dot(normal, own - (other.origin + depth * other.direction)) / tolerance;
          const float agreement = glm::dot(normal, fine.normal[i]);
          sum += normal * std::exp(-0.5f * off_plane * off_plane + (agreement - 1.0f) / kNormalSharpness);
        }
      sum += 0.05f * fine.normal[i];
      fine.normal[i] = glm::normalize(sum);
    }
  });
}

}  // namespace meniscus
