// Fields bent towards planes around objects.
#include "surface/fixtures.h"
#include "surface/height_field_grid.h"

namespace meniscus {
namespace {

using namespace surface_tests;

HeightField rough() {
  HeightField field = blank_field(Axis::y, {vec3{0.0f}, vec3{2.0f}}, 0.05f);
  for (int j = 0; j < 41; ++j)
    for (int i = 0; i < 41; ++i)
      field.height(i, j) =
          i < 4 ? -kInfinity
                : 0.6f + 0.1f * std::sin(0.7f * static_cast<float>(i)) * std::cos(0.4f * static_cast<float>(j));
  find_normals(field);
  return field;
}

PlaneAdaptation plane_at(vec2 centre, vec3 normal, float half = 0.2f, float width = 0.3f) {
  PlaneAdaptation plane;
  plane.point = {centre.x, 0.55f, centre.y};
  plane.normal = glm::normalize(normal);
  plane.outline = {centre + vec2{-half, -half}, centre + vec2{half, -half}, centre + vec2{half, half},
                   centre + vec2{-half, half}};
  plane.width = width;
  return plane;
}

TEST(Adapt, IsThePlaneInsideAndItselfBeyondAndLinearBetween) {
  const HeightField before = rough();
  HeightField after = before;
  const PlaneAdaptation plane = plane_at({1, 1}, {0.1f, 1, -0.05f});
  adapt(after, {&plane, 1});
  for (int j = 0; j < 41; ++j)
    for (int i = 0; i < 41; ++i) {
      const vec3 p = before.point(static_cast<float>(i), static_cast<float>(j), 0);
      const float dx = std::max(std::abs(p.x - 1) - 0.2f, 0.0f), dz = std::max(std::abs(p.z - 1) - 0.2f, 0.0f);
      const float part = std::clamp(1 - std::hypot(dx, dz) / 0.3f, 0.0f, 1.0f);
      if (!(before.height(i, j) > -kInfinity)) {
        EXPECT_EQ(after.height(i, j), -kInfinity);
        continue;
      }
      const float level = 0.55f - (0.1f * (p.x - 1) - 0.05f * (p.z - 1));
      EXPECT_NEAR(after.height(i, j), before.height(i, j) + part * (level - before.height(i, j)), 1e-5f);
      const vec3 normal = (1 - part) * before.normal(i, j) + part * plane.normal;
      EXPECT_LT(degrees_between(after.normal(i, j), normal), 0.05);
    }
}

TEST(Adapt, WeighsSeveralPlanesWithoutJumps) {
  HeightField field = rough();
  const std::vector<PlaneAdaptation> planes{plane_at({0.8f, 1}, {0.1f, 1, 0}), plane_at({1.35f, 1}, {-0.2f, 1, 0.1f})};
  adapt(field, planes);
  const vec2 inside = field.grid_point({1.35f, 0, 1});
  EXPECT_NEAR(field.at(inside.x, inside.y).height, 0.55f, 1e-4f);
  for (const vec3 normal : field.normal) EXPECT_NEAR(glm::length(normal), 1.0f, 1e-5f);
}

TEST(Adapt, PassesOverPlanesThatAreNone) {
  const HeightField before = rough();
  HeightField after = before;
  std::vector<PlaneAdaptation> planes(4, plane_at({1, 1}, {0, 1, 0}));
  planes[0].normal = {1, 0, 0};
  planes[1].normal = vec3{0.0f};
  planes[2].point.y = std::nanf("");
  planes[3].outline.clear();
  adapt(after, planes);
  EXPECT_TRUE(same_bits(before.height, after.height));
  EXPECT_TRUE(same_bits(before.normal, after.normal));
  // A line and a point are outlines, too; without a width only they themselves are bent.
  PlaneAdaptation line = plane_at({1, 1}, {0, 1, 0}, 0.2f, 0.0f);
  line.outline = {{0.8f, 1}, {1.2f, 1}};
  adapt(after, {&line, 1});
  for (const float height : after.height) EXPECT_FALSE(std::isnan(height));
}

}  // namespace
}  // namespace meniscus
