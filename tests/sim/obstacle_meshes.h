/// Closed meshes as obstacles.
#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "meniscus/sim.h"

namespace meniscus {

inline ObstacleShape mesh_of(std::vector<vec3> positions, std::vector<std::uint32_t> corners) {
  ObstacleShape shape;
  shape.kind = ObstacleShape::Kind::mesh;
  shape.positions = std::move(positions);
  shape.corners = std::move(corners);
  return shape;
}

inline ObstacleShape box_triangles(vec3 size) {
  std::vector<vec3> positions;
  for (int i = 0; i < 8; ++i) positions.push_back(size * (vec3(i & 1, (i >> 1) & 1, i >> 2) - 0.5f));
  return mesh_of(positions, {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                             2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5});
}

/// A ball of about 0.4 m radius with hills and dales, so that it is nowhere convex for long.
inline ObstacleShape bumpy_mesh(int n) {
  std::vector<vec3> positions;
  std::vector<std::uint32_t> corners;
  const auto place = [&](int i, int j) {
    const float down = std::numbers::pi_v<float> * static_cast<float>(j) / static_cast<float>(n);
    const float turn = 2 * std::numbers::pi_v<float> * static_cast<float>(i % (2 * n)) / static_cast<float>(2 * n);
    const vec3 d{std::sin(down) * std::cos(turn), std::cos(down), std::sin(down) * std::sin(turn)};
    return d * (0.4f + 0.1f * std::sin(7 * d.x) * std::sin(6 * d.y + 1) * std::sin(5 * d.z + 2));
  };
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i < 2 * n; ++i) positions.push_back(j == 0 || j == n ? place(0, j) : place(i, j));
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(j * 2 * n + i % (2 * n)); };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < 2 * n; ++i)
      for (const std::uint32_t corner :
           {at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)})
        corners.push_back(corner);
  return mesh_of(positions, corners);
}

/// Two long thin blades that meet at a sharp edge.
inline ObstacleShape wedge_mesh() {
  return mesh_of({{-0.5f, 0, -0.4f},
                  {-0.5f, 0, 0.4f},
                  {0.5f, 0.03f, -0.4f},
                  {0.5f, 0.03f, 0.4f},
                  {0.5f, -0.2f, -0.4f},
                  {0.5f, -0.2f, 0.4f}},
                 {0, 1, 2, 1, 3, 2, 0, 4, 1, 1, 4, 5, 2, 3, 4, 3, 5, 4, 0, 2, 4, 1, 5, 3});
}

}  // namespace meniscus
