// Objects in the water: planes, outlines, axes, groups; and the trapezium around them.
#include <gtest/gtest.h>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "fixtures.h"
#include "shading/trapezium.h"
#include "shading/virtual_eye_map.h"
#include "shading/virtual_eye_object.h"

namespace meniscus {
namespace {

using namespace tests;

/// Water that is a plane: 0.5 + slope x.
HeightField tilted(float slope) {
  HeightField field;
  field.low = {-2, -2};
  field.step = {0.0625f, 0.0625f};
  field.height = Image<float>(65, 65);
  for (int j = 0; j < 65; ++j)
    for (int i = 0; i < 65; ++i) field.height(i, j) = 0.5f + slope * (-2 + 0.0625f * static_cast<float>(i));
  field.normal = Image<vec3>(65, 65, glm::normalize(vec3{-slope, 1, 0}));
  return field;
}

std::vector<WaterObject> objects_of(std::vector<Mesh> meshes, float slope = 0, const VirtualEyeOptions& options = {}) {
  Scene scene = without_ground(uniform_environment());
  std::vector<PlacedSolid> solids;
  for (Mesh& mesh : meshes) solids.push_back({make_solid(std::move(mesh)), glm::mat4(1.0f), {}});
  scene.set_solids(std::move(solids));
  return water_objects(tilted(slope), scene, options);
}

TEST(WaterObjects, HaveThePlaneOfTheWaterAroundThem) {
  for (const float slope : {0.0f, 0.2f}) {
    const auto objects = objects_of({box_mesh({0.5f, 0.1f, -0.1f}, {0.7f, 1.0f, 0.1f})}, slope);
    ASSERT_EQ(objects.size(), 1u);
    EXPECT_LT(glm::length(objects[0].plane_normal - glm::normalize(vec3{-slope, 1, 0})), 1e-4f);
    const vec3 p = objects[0].plane_point;
    EXPECT_NEAR(p.y, 0.5f + slope * p.x, 1e-4f);
    EXPECT_NEAR(p.x, 0.6f, 1e-3f);
  }
}

TEST(WaterObjects, TellWhetherTheyPierceTheSurface) {
  const auto objects = objects_of({box_mesh({-1, 0, 0}, {-0.9f, 1, 0.1f}), box_mesh({0, 0, 0}, {0.1f, 0.4f, 0.1f}),
                                   box_mesh({1, 0.6f, 0}, {1.1f, 1, 0.1f})});
  ASSERT_EQ(objects.size(), 3u);
  EXPECT_TRUE(objects[0].pierces && objects[0].under);
  EXPECT_TRUE(!objects[1].pierces && objects[1].under);
  EXPECT_TRUE(!objects[2].pierces && !objects[2].under);
  EXPECT_EQ(adaptations(objects, {}).size(), 1u);
  VirtualEyeOptions none;
  none.adaptation = false;
  EXPECT_TRUE(adaptations(objects, none).empty());
}

TEST(WaterObjects, HaveTheirMainAxisAlongAnObliquePole) {
  const vec3 top{0.4f, 1, 0.2f}, end{-0.2f, 0, 0};
  const auto objects = objects_of({cylinder_mesh(end, top, 0.02f)});
  ASSERT_EQ(objects.size(), 1u);
  EXPECT_LT(glm::length(objects[0].axis_top - top), 2e-3f);
  EXPECT_LT(glm::length(objects[0].axis_end - end), 2e-3f);
  // The outline is that at the water's level, not that of the whole pole.
  for (const vec2 p : objects[0].outline) EXPECT_LT(glm::length(p - vec2{0.1f, 0.1f}), 0.06f);
}

TEST(WaterObjects, ShareAnEyeWhenTheyAreClose) {
  const std::vector<Mesh> boxes{box_mesh({0, 0, 0}, {0.2f, 1, 0.2f}), box_mesh({0.3f, 0, 0}, {0.5f, 1, 0.2f}),
                                box_mesh({-1, 0, 0}, {-0.8f, 1, 0.2f})};
  VirtualEyeOptions options;
  options.combine_distance = 0.11f;
  const auto combined = objects_of(boxes, 0, options);
  ASSERT_EQ(combined.size(), 2u);
  EXPECT_EQ(combined[0].solids, (std::vector<std::size_t>{0, 1}));
  EXPECT_FLOAT_EQ(combined[0].bounds.high.x, 0.5f);
  options.combine_distance = 0.09f;
  EXPECT_EQ(objects_of(boxes, 0, options).size(), 3u);
}

TEST(WaterObjects, ABasinAroundTheWaterIsNone) {
  EXPECT_TRUE(objects_of({box_mesh({-2, -0.1f, -2}, {2, 0.2f, 2})}).empty());
}

TEST(VirtualEyeObject, TheNearestPointIsOnTheFaceTowardsTheEye) {
  const auto objects = objects_of({box_mesh({-0.2f, 0, -0.1f}, {0.2f, 1, 0.1f})});
  const vec3 a = nearest_point({{0, 0.5f, 0}, {0, 1, 0}}, {0, 2, 3}, objects.at(0));
  EXPECT_LT(glm::length(a - vec3{0, 0.5f, 0.1f}), 1e-4f);
}

TEST(VirtualEyeObject, TheRefractedEyeKeepsTheLengthUpToTheSurface) {
  const ApproximatingPlane plane{{0, 0.5f, 0}, {0, 1, 0}};
  const vec3 eye{0, 2, 3}, a{0.2f, 0.5f, 0.1f};
  const auto virtual_eye = refracted_eye(plane, eye, a, 1 / 1.333f);
  ASSERT_TRUE(virtual_eye);
  EXPECT_NEAR(glm::length(*virtual_eye - a), glm::length(eye - a), 1e-5f);
  const double sin_i = glm::length(vec2{a.x - eye.x, a.z - eye.z}) / glm::length(a - eye);
  const vec3 d = glm::normalize(a - *virtual_eye);
  EXPECT_NEAR(std::sqrt(1 - d.y * d.y), sin_i / 1.333, 1e-5);
  EXPECT_FALSE(refracted_eye(plane, {0, 0.4f, 3}, a, 1.333f));  // total reflection
  EXPECT_LT(glm::length(reflected_eye(plane, eye) - vec3{0, -1, 3}), 1e-6f);
}

TEST(VirtualEyeObject, EntryAndRefractionPointAgree) {
  const ApproximatingPlane plane{{0, 0.5f, 0}, {0, 1, 0}};
  const vec3 eye{0.3f, 2, 3}, target{-0.4f, 0.1f, -0.2f};
  const vec3 at = refraction_point(plane, eye, target, 1 / 1.333f);
  const auto entry = entry_of(plane, eye, glm::normalize(target - at), 1 / 1.333f);
  ASSERT_TRUE(entry);
  EXPECT_LT(glm::length(*entry - at), 2e-5f);
}

TEST(Trapezium, IsWholeBetweenObjectAndEyeAndNothingBehindAndBeside) {
  const auto objects = objects_of({box_mesh({-0.2f, 0, -0.2f}, {0.2f, 1, 0.2f})});
  VirtualEyeOptions options;
  options.trapezium_a = 0.5f;
  options.trapezium_b = 1.0f;
  const Trapezium trapezium(objects.at(0), {0, 3}, Axis::y, options);
  EXPECT_EQ(trapezium.weight({0, 1}), 1.0f);
  EXPECT_EQ(trapezium.weight({0, 0}), 1.0f);
  EXPECT_EQ(trapezium.weight({0, -1}), 0.0f);
  EXPECT_EQ(trapezium.weight({1.2f, 1}), 0.0f);
  EXPECT_EQ(trapezium.weight({0.6f, 0}), 0.0f);
  EXPECT_GT(trapezium.weight({0.6f, 2.8f}), 0.9f);  // wider towards the eye
  float before = 1;
  for (float x = 0; x < 1; x += 0.01f) {
    const float weight = trapezium.weight({x, 1});
    EXPECT_LE(weight, before + 1e-6f);
    EXPECT_LT(before - weight, 0.15f);  // no edge
    before = weight;
  }
}

TEST(CubeMap, InterpolatesTheDirectionAcrossFacesAndTiles) {
  const CubeMap map(48, [](std::span<const vec3> directions, std::span<MapTexel> texels) {
    for (std::size_t i = 0; i < directions.size(); ++i) {
      texels[i].radiance = directions[i];
      texels[i].alpha = 1;
    }
    return true;
  });
  for (int i = 0; i < 2000; ++i) {
    const float z = 1 - 2 * (static_cast<float>(i) + 0.5f) / 2000, turn = 2.39996f * static_cast<float>(i);
    const float r = std::sqrt(1 - z * z);
    const vec3 direction{r * std::cos(turn), r * std::sin(turn), z};
    const CubeMap::Cell cell = map.at(3.0f * direction);
    vec3 sum{0.0f};
    for (int k = 0; k < 4; ++k) sum += cell.weight(k) * cell.texel(k).radiance;
    EXPECT_LT(glm::length(sum - direction), 1e-3f);
  }
  EXPECT_EQ(map.drawn_tiles(), 54u);
}

TEST(CubeMap, DrawsOnlyTheTilesThatAreLookedAt) {
  const CubeMap map(1024, [](std::span<const vec3>, std::span<MapTexel>) { return false; });
  for (int i = 0; i < 10; ++i) EXPECT_EQ(map.at({0.001f * static_cast<float>(i) + 0.001f, -1, 0.001f}).first, nullptr);
  EXPECT_EQ(map.drawn_tiles(), 1u);
  EXPECT_EQ(map.filled_tiles(), 0u);
}

}  // namespace
}  // namespace meniscus
