#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "base/field_axes.h"
#include "render/rain_ground.h"

namespace meniscus {
namespace {

constexpr double kMostTriangles = 2e6;
/// Where slopes on both sides of a point differ by more, an edge is between them; faces steeper than this are flat.
constexpr float kEdge = 0.5f;
constexpr float kSkirt = 1.5f;  ///< m beyond the cells over which the relief runs out into the plane

/// Every so many cells along an edge of `count`, the last always; a point more at each end for the skirt.
std::vector<int> picked(int count, int stride) {
  std::vector<int> cells{-1};
  for (int i = 0; i < count - 1; i += stride) cells.push_back(i);
  cells.push_back(count - 1);
  cells.push_back(count);
  return cells;
}

/// Slope at a point between two others: the mean of both sides, or that of the flatter where there is an edge.
float slope_of(float before, float after) {
  if (std::abs(before - after) < kEdge) return 0.5f * (before + after);
  return std::abs(before) < std::abs(after) ? before : after;
}

/// Normal of four points as a whole, upwards.
vec3 flat_normal(const Mesh& mesh, const std::array<std::uint32_t, 4>& quad, const FieldAxes& axes) {
  const auto& p = mesh.positions;
  vec3 normal = glm::cross(p[quad[3]] - p[quad[0]], p[quad[2]] - p[quad[1]]);
  if (normal[axes.up] < 0) normal = -normal;
  return glm::normalize(normal);
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
        const auto along = [&](std::size_t k, std::size_t count, std::size_t stride_of, int axis) {
          const std::size_t here = i + width * j;
          const float before = k > 0 ? slope(here - stride_of, here, axis) : slope(here, here + stride_of, axis);
          const float after = k + 1 < count ? slope(here, here + stride_of, axis) : before;
          return slope_of(before, after);
        };
        const float by_a = along(i, width, 1, axes.a), by_b = along(j, height, width, axes.b);
        mesh.normals[i + width * j] = glm::normalize(axes.place(-by_a, -by_b, 1.0f));
      }
  });
  mesh.corners.reserve(6 * (width - 1) * (height - 1));
  for (std::size_t j = 0; j + 1 < height; ++j)
    for (std::size_t i = 0; i + 1 < width; ++i) {
      std::array<std::uint32_t, 4> quad;
      for (std::size_t k = 0; k < 4; ++k) quad[k] = static_cast<std::uint32_t>(i + k % 2 + width * (j + k / 2));
      // Kerbs and other steps keep their edges: their faces have corners of their own.
      const vec3 normal = flat_normal(mesh, quad, axes);
      if (normal[axes.up] * std::sqrt(1 + kEdge * kEdge) < 1)
        for (std::uint32_t& corner : quad) {
          mesh.positions.push_back(vec3(mesh.positions[corner]));
          mesh.normals.push_back(normal);
          corner = static_cast<std::uint32_t>(mesh.positions.size() - 1);
        }
      for (const int k : {0, 2, 1, 1, 2, 3}) mesh.corners.push_back(quad[static_cast<std::size_t>(k)]);
    }
  return mesh;
}

}  // namespace meniscus
