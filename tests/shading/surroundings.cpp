#include <gtest/gtest.h>

#include <numbers>

#include "fixtures.h"

namespace meniscus::tests {
namespace {

TEST(Surroundings, ShowTheSceneByDirection) {
  const Surroundings around(without_ground(half_lit_environment()), vec3{0.0f});
  EXPECT_NEAR(around.radiance({0, 1, 0}).x, 1, 1e-3);
  EXPECT_NEAR(around.radiance({0, -1, 0}).x, 0, 1e-3);
  EXPECT_NEAR(around.radiance(glm::normalize(vec3{1, 0.1f, 1})).x, 1, 1e-3);
  EXPECT_NEAR(around.mean().x, 0.5, 0.01);
  EXPECT_NEAR(around.radiance({1, 0, 0}, 0.5f).x, 0.5, 0.05);
}

TEST(Surroundings, ConesBlurMoreTheWiderTheyAre) {
  const Surroundings around(without_ground(half_lit_environment()), vec3{0.0f});
  const vec3 direction = glm::normalize(vec3{1, 0.3f, 0});
  float before = 1.001f;
  for (float cone = 0; cone < 1.5f; cone += 0.05f) {
    const float radiance = around.radiance(direction, cone).x;
    EXPECT_LE(radiance, before + 5e-3f) << cone;
    EXPECT_LT(std::abs(before - radiance), 0.08f) << cone;
    before = radiance;
  }
  EXPECT_LT(before, 0.75f);
}

TEST(Surroundings, AreEvenInEvenLight) {
  const Surroundings around(without_ground(uniform_environment({0.5f, 1, 2})), vec3{1, 2, 3}, 8);
  for (float turn = 0; turn < 6; turn += 0.1f)
    for (const float cone : {0.0f, 0.01f, 0.2f, 2.0f}) {
      const vec3 radiance =
          around.radiance(glm::normalize(vec3{std::cos(turn), std::sin(3 * turn), std::sin(turn)}), cone);
      EXPECT_NEAR(radiance.x, 0.5, 0.005);
      EXPECT_NEAR(radiance.z, 2, 0.02);
    }
}

TEST(Surroundings, GlareOfALampIntegratesToItsIrradiance) {
  Scene scene = without_ground(uniform_environment(vec3{0.0f}));
  scene.set_lamps({{{0, 2, 0}, vec3{0.4f}}});  // 0.1 at the origin: too faint for the limit of brightness to matter
  const Surroundings around(scene, vec3{0.0f}, 8);
  double sum = 0;
  constexpr int kSteps = 400;
  for (int j = 0; j < kSteps; ++j) {
    const double z = (2 * j + 1.0) / kSteps - 1, r = std::sqrt(1 - z * z);
    for (int i = 0; i < 16; ++i) {
      const double turn = 2 * std::numbers::pi * (i + 0.5) / 16;
      sum += around.glare(vec3{0.0f}, {r * std::cos(turn), z, r * std::sin(turn)}, 0.1f).x * 4 * std::numbers::pi /
             (kSteps * 16);
    }
  }
  EXPECT_NEAR(sum, 0.1, 0.003);
  EXPECT_EQ(around.glare(vec3{0.0f}, {0, -1, 0}, 0.01f).x, 0);
}

TEST(Surroundings, TheSunIsNotSeenThroughARoof) {
  EnvironmentOptions options;
  options.sun_direction = {0, 1, 0};
  Scene scene = without_ground(Environment(options));
  EXPECT_GT(Surroundings(scene, vec3{0.0f}, 8).glare(vec3{0.0f}, {0, 1, 0}, 0.01f).x, 1);
  scene.set_solids({{make_solid(box_mesh({-5, 3, -5}, {5, 4, 5})), glm::mat4{1.0f}, {}, false}});
  EXPECT_EQ(Surroundings(scene, vec3{0.0f}, 8).glare(vec3{0.0f}, {0, 1, 0}, 0.01f).x, 0);
}

TEST(Surroundings, RefuseAPlaceThatIsNone) {
  const Scene scene = without_ground(uniform_environment());
  EXPECT_THROW(Surroundings(scene, {std::numeric_limits<float>::quiet_NaN(), 0, 0}), Error);
  EXPECT_THROW(Surroundings(scene, vec3{0.0f}, 0), Error);
  EXPECT_THROW(Surroundings(scene, vec3{0.0f}, 1 << 20), Error);
}

}  // namespace
}  // namespace meniscus::tests
