#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "base/field_axes.h"
#include "render/rain_ground.h"

namespace meniscus {
namespace {

constexpr double kMostTriangles = 2e6;
constexpr float kSkirt = 1.5f;  ///< m beyond the cells over which the relief runs out into the plane

/// Every so many cells along an edge of `count`, the last always; a point more at each end for the skirt.
std::vector<int> picked(int count, int stride) {
  std::vector<int> cells{-1};
  for (int i = 0; i < count - 1; i += stride) cells.push_back(i);
  cells.push_back(count - 1);
  cells.push_back(count);
  return cells;
}

}  // namespace

Mesh relief_mesh(const WetGround& ground, float plane) {
  const FieldAxes axes(ground.options().up);
  const double triangles = 2.0 * ground.width() * ground.height();
  const int stride = std::max(1, static_cast<int>(std::ceil(std::sqrt(triangles / kMostTriangles))));
  const std::vector<int> along_a = picked(ground.width(), stride), along_b = picked(ground.height(), stride);
  const std::size_t width = along_a.size(), height = along_b.size();
  Mesh mesh;
  mesh.positions.resize(width * height);
  mesh.normals.resize(width * height);
  parallel_for(height, 32, [&](std::size_t begin, std::size_t end) {
    for (std::size_t j = begin; j < end; ++j)
      for (std::size_t i = 0; i < width; ++i) {
        const int x = std::clamp(along_a[i], 0, ground.width() - 1);
        const int y = std::clamp(along_b[j], 0, ground.height() - 1);
        vec3 point = ground.place(static_cast<std::size_t>(x) +
                                  static_cast<std::size_t>(ground.width()) * static_cast<std::size_t>(y));
        point[axes.a] += kSkirt * static_cast<float>(along_a[i] - x);
        point[axes.b] += kSkirt * static_cast<float>(along_b[j] - y);
        if (x != along_a[i] || y != along_b[j]) point[axes.up] = plane;
        mesh.positions[i + width * j] = point;
      }
  });
  parallel_for(height, 32, [&](std::size_t begin, std::size_t end) {
    for (std::size_t j = begin; j < end; ++j)
      for (std::size_t i = 0; i < width; ++i) {
        const auto slope = [&](std::size_t low, std::size_t high, int axis) {
          const vec3 across = mesh.positions[high] - mesh.positions[low];
          return across[axes.up] / across[axis];
        };
        const float by_a = slope((i > 0 ? i - 1 : i) + width * j, std::min(i + 1, width - 1) + width * j, axes.a);
        const float by_b = slope(i + width * (j > 0 ? j - 1 : j), i + width * std::min(j + 1, height - 1), axes.b);
        mesh.normals[i + width * j] = glm::normalize(axes.place(-by_a, -by_b, 1.0f));
      }
  });
  mesh.corners.reserve(6 * (width - 1) * (height - 1));
  for (std::size_t j = 0; j + 1 < height; ++j)
    for (std::size_t i = 0; i + 1 < width; ++i) {
      const auto corner = [&](std::size_t x, std::size_t y) {
        return static_cast<std::uint32_t>(i + x + width * (j + y));
      };
      for (const std::uint32_t c : {corner(0, 0), corner(0, 1), corner(1, 0), corner(1, 0), corner(0, 1), corner(1, 1)})
        mesh.corners.push_back(c);
    }
  return mesh;
}

}  // namespace meniscus
