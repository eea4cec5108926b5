// One interface and the picture of the scene; options; flat sides against a tank's walls.
#include <gtest/gtest.h>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>

#include "fixtures.h"
#include "shading/refraction.h"

namespace meniscus {
namespace {

using namespace tests;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

Scene pool(Environment environment) {
  Ground ground;
  ground.height = -0.5f;
  ground.square = 1.0f;
  ground.albedo = vec3{0.7f};
  ground.second_albedo = vec3{0.2f};
  return Scene(std::move(environment), ground);
}

/// Level water at height 0 over the view.
SurfaceBuffers level(const View& view) {
  SurfaceBuffers buffers = even(view.width, view.height, 0, {0, 1, 0}, 0);
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x) {
      const Ray ray = view.ray({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
      const float depth = -ray.origin.y / ray.direction.y;
      buffers.depth(x, y) = depth > 0 ? depth : kInfinity;
      buffers.coverage(x, y) = depth > 0 ? 1.0f : 0.0f;
      buffers.thickness(x, y) = 0.5f / -ray.direction.y;
    }
  return buffers;
}

TEST(RefractionInImageSpace, ShowsAPoolsFloorAsSnellsLawDoes) {
  const Scene scene = pool(uniform_environment());
  const View view = perspective_view({0, 3, 2}, {0, 0, 0}, {0, 1, 0}, 0.7f, 120, 90);
  const SceneBuffers behind = scene.see(view);
  OpticsInputs optics;
  optics.options.refraction = RefractionMethod::image_space;
  optics.behind = &behind;
  Material material = clear();
  material.extinction = {0.3f, 0.6f, 1.2f};
  const Image<vec3> picture = shade(view, {}, level(view), scene, material, optics);
  int compared = 0, bent = 0;
  for (int y = 10; y < 80; y += 3)
    for (int x = 10; x < 110; x += 3) {
      const Ray ray = view.ray({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
      const glm::dvec3 d(ray.direction), at = glm::dvec3(ray.origin) - glm::dvec3(ray.origin.y / ray.direction.y) * d;
      glm::dvec3 in(d.x / 1.333, 0, d.z / 1.333);
      in.y = -std::sqrt(1 - glm::dot(in, in));
      const double path = 0.5 / -in.y;
      const vec3 floor(at + path * in);
      const auto square = [](float v) { return std::abs(v - std::round(v)); };
      if (square(floor.x) < 0.12f || square(floor.z) < 0.12f) continue;  // not at the squares' edges
      const Ray down{floor + vec3{0, 1, 0}, {0, -1, 0}};
      const vec3 albedo = scene.radiance(down, 1e-4f);
      const double r = reflectance(std::acos(-d.y), 1.333);
      for (int k = 0; k < 3; ++k)
        ASSERT_NEAR(picture(x, y)[k],
                    r + (1 - r) * static_cast<double>(albedo[k]) *
                            std::exp(-static_cast<double>(material.extinction[k]) * path),
                    0.01)
            << x << " " << y;
      ++compared;
      bent += glm::length(scene.radiance(ray, 1e-4f) - albedo) > 0.2f;
    }
  EXPECT_GT(compared, 200);
  EXPECT_GT(bent, 20) << "the test must tell bent from straight";
}

TEST(RefractionInImageSpace, IsNearlyARayWithASingleInterface) {
  // The two differ in how the hit is found only.
  struct Level : Surface {
    SurfaceBuffers see(const View& view, std::span<const vec2>, StageTimes*) const override { return level(view); }
    Image<float> thickness(const View& view, std::span<const vec2>, StageTimes*) const override {
      return level(view).thickness;
    }
    bool can_march() const override { return true; }
    void crossings(std::span<const Ray>, std::span<const float>, std::span<const float>, std::span<const std::uint8_t>,
                   std::span<Crossing>) const override {}
    Bounds bounds() const override { return {vec3{-9}, vec3{9}}; }
  } water;
  const Scene scene = pool(Environment{EnvironmentOptions{}});
  const View view = perspective_view({0, 2, 3}, {0, 0, 0}, {0, 1, 0}, 0.5f, 160, 120);
  const SceneBuffers behind = scene.see(view);
  OpticsInputs optics;
  optics.options.refraction = RefractionMethod::image_space;
  optics.options.bounces = 1;
  optics.behind = &behind;
  optics.surface = &water;
  const Material material = material_preset("water", 1.0f);
  const SurfaceBuffers seen = water.see(view, {}, nullptr);
  const Image<vec3> a = shade(view, {}, seen, scene, material, optics);
  optics.options.refraction = RefractionMethod::ray_traced;
  const Image<vec3> b = shade(view, {}, seen, scene, material, optics);
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += glm::dot(a[i] - b[i], a[i] - b[i]) / 3;
  EXPECT_LT(std::sqrt(sum / static_cast<double>(a.size())), 0.03);
}

TEST(RefractionInImageSpace, IsAWhiteFurnace) {
  Ground white;
  white.height = -0.5f;
  white.albedo = white.second_albedo = vec3{1.0f};
  const Scene scene(uniform_environment(), white);
  const View view = perspective_view({0, 0.8f, 3}, {0, 0, 0}, {0, 1, 0}, 0.7f, 60, 50);
  const SceneBuffers behind = scene.see(view);
  OpticsInputs optics{{RefractionMethod::image_space}, &behind, nullptr};
  for (const vec3& radiance : shade(view, {}, level(view), scene, clear(), optics))
    ASSERT_LT(glm::length(radiance - vec3{1}), 2e-3f);
}

TEST(Optics, RefusesOptionsOutOfRange) {
  const Scene scene = without_ground(uniform_environment());
  const View view = looking({0, -1, 0});
  const SurfaceBuffers water = even(8, 6, 5, {0, 1, 0}, 1);
  const SceneBuffers behind = scene.see(view), other = scene.see(looking({0, -1, 0}, 9, 6));
  const auto code = [&](const OpticsInputs& inputs) {
    try {
      shade(view, {}, water, scene, clear(), inputs);
    } catch (const Error& error) {
      return error.code() == ErrorCode::invalid_argument;
    }
    return false;
  };
  using M = RefractionMethod;
  const auto refused = [&](int iterations, float threshold, int bounces) {
    OpticsInputs inputs;
    inputs.options.iterations = iterations;
    inputs.options.threshold = threshold;
    inputs.options.bounces = bounces;
    return code(inputs);
  };
  EXPECT_FALSE(refused(8, 0, 8));
  EXPECT_TRUE(refused(0, 0, 8));
  EXPECT_TRUE(refused(257, 0, 8));
  EXPECT_TRUE(refused(8, -1.0f, 8));
  EXPECT_TRUE(refused(8, 0, 0));
  EXPECT_TRUE(refused(8, 0, 65));
  EXPECT_TRUE(code({{M::virtual_eye}, nullptr, nullptr}));
  EXPECT_TRUE(code({{M::image_space}, nullptr, nullptr}));
  EXPECT_TRUE(code({{M::image_space}, &other, nullptr}));
  EXPECT_FALSE(code({{M::image_space}, &behind, nullptr}));
  EXPECT_EQ(refraction_method_of("ray_traced"), M::ray_traced);
  EXPECT_EQ(refraction_method_of("image_space"), M::image_space);
  EXPECT_EQ(refraction_method_of("thickness"), M::thickness);
  EXPECT_EQ(refraction_method_of("virtual_eye"), M::virtual_eye);
  EXPECT_THROW(refraction_method_of("magic"), Error);
}

TEST(FlatSides, StandAgainstATanksWalls) {
  Tank tank;
  tank.style = TankStyle::glass;
  tank.inside = {{0, 0, 0}, {1, 1, 1}};
  const float spacing = 0.05f;
  const Ray ray{{2, 0.5f, 0.5f}, {-1, 0, 0}};
  // Rough and half a spacing behind the pane: flat, on the pane.
  float distance = 1.025f;
  vec3 normal = glm::normalize(vec3{1, 0.3f, -0.2f});
  flatten_at_walls(tank, spacing, ray, distance, normal);
  EXPECT_NEAR(distance, 1.0f, 1e-6f);
  EXPECT_LT(glm::length(normal - vec3{1, 0, 0}), 1e-6f);
  // The rounded edge of the water's level turns, and stays where it is: the way to the pane leads through the air.
  distance = 1.025f;
  normal = glm::normalize(vec3{0.7f, 0.71f, 0});
  flatten_at_walls(tank, spacing, ray, distance, normal);
  EXPECT_EQ(distance, 1.025f);
  EXPECT_GT(normal.x, 0.75f);
  // Bulging through the pane it is cut off there.
  distance = 0.99f;
  normal = glm::normalize(vec3{1, 0.1f, 0});
  flatten_at_walls(tank, spacing, ray, distance, normal);
  EXPECT_NEAR(distance, 1.0f, 1e-6f);
  // The top of the water, and water in the middle, stay.
  for (const vec3 other : {vec3{0.1f, 1, 0}, vec3{-1, 0, 0}}) {
    distance = 1.025f;
    normal = glm::normalize(other);
    flatten_at_walls(tank, spacing, ray, distance, normal);
    EXPECT_EQ(distance, 1.025f);
    EXPECT_LT(glm::length(normal - glm::normalize(other)), 1e-6f);
  }
  distance = 1.3f;
  normal = {1, 0, 0};
  flatten_at_walls(tank, spacing, ray, distance, normal);
  EXPECT_EQ(distance, 1.3f);
  // Between near and far it changes smoothly.
  float before = 0;
  for (float t = 1.0f; t < 1.15f; t += 0.001f) {
    distance = t;
    normal = {1, 0, 0};
    flatten_at_walls(tank, spacing, ray, distance, normal);
    EXPECT_GE(distance, before - 1e-5f);
    EXPECT_LT(distance - before, t > 1.0005f ? 0.01f : 2.0f);
    before = distance;
  }
}

}  // namespace
}  // namespace meniscus
