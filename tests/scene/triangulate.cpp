#include "scene/triangulate.h"

#include <gtest/gtest.h>
#include <cmath>
#include <glm/geometric.hpp>

namespace meniscus {
namespace {

/// Sum of the triangles' areas and of their signed areas around `normal`.
std::pair<float, float> areas(const std::vector<vec3>& points, const std::vector<std::uint32_t>& corners, vec3 normal) {
  float sum = 0, signed_sum = 0;
  for (std::size_t t = 0; t < corners.size(); t += 3) {
    const vec3 across =
        glm::cross(points[corners[t + 1]] - points[corners[t]], points[corners[t + 2]] - points[corners[t]]);
    sum += 0.5f * glm::length(across);
    signed_sum += 0.5f * glm::dot(across, normal);
  }
  return {sum, signed_sum};
}

TEST(Triangulate, CoversConcavePolygonsOnce) {
  // A star in a slanted plane, either way around: where triangles overlap or leave the star, areas differ.
  const vec3 u = glm::normalize(vec3{1, 0.2f, 0.1f}), normal = glm::normalize(glm::cross(u, vec3{0, 1, 0.5f})),
             v = glm::cross(normal, u);
  for (const int spikes : {3, 5, 8, 40})
    for (const bool reversed : {false, true}) {
      std::vector<vec3> points;
      std::vector<std::uint32_t> polygon, corners;
      for (int i = 0; i < 2 * spikes; ++i) {
        const float phi = 3.14159265f * static_cast<float>(reversed ? -i : i) / static_cast<float>(spikes);
        const float r = i % 2 ? 0.4f : 1.0f;
        points.push_back(vec3{5, 6, 7} + r * (std::cos(phi) * u + std::sin(phi) * v));
        polygon.push_back(static_cast<std::uint32_t>(i));
      }
      triangulate(points, polygon, corners);
      ASSERT_EQ(corners.size(), 3u * static_cast<std::size_t>(2 * spikes - 2));
      const auto [area, signed_area] = areas(points, corners, normal);
      const float exact = 0.4f * static_cast<float>(spikes) * std::sin(3.14159265f / static_cast<float>(spikes));
      EXPECT_NEAR(area, exact, 1e-4f);
      EXPECT_NEAR(signed_area, reversed ? -exact : exact, 1e-4f);
    }
}

TEST(Triangulate, EndsOnPolygonsThatAreNone) {
  const std::vector<vec3> points{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 0, 0}};
  for (const std::vector<std::uint32_t>& polygon :
       {std::vector<std::uint32_t>{0, 2, 1, 3}, {0, 1, 4, 1}, {0, 0, 0, 0, 0}, {0, 1, 2, 3, 0, 1, 2, 3}}) {
    std::vector<std::uint32_t> corners;
    triangulate(points, polygon, corners);
    EXPECT_EQ(corners.size(), 3 * (polygon.size() - 2));
  }
  std::vector<std::uint32_t> corners;
  triangulate(points, std::vector<std::uint32_t>{0, 1}, corners);
  EXPECT_TRUE(corners.empty());
}

}  // namespace
}  // namespace meniscus
