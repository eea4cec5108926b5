#include <gtest/gtest.h>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "meniscus/scene.h"
#include "scene/chequer.h"

namespace meniscus {
namespace {

/// Mean of a chequer under a tent by many points.
float brute_force(vec2 point, vec2 width) {
  constexpr int kPoints = 400;
  float first = 0, all = 0;
  for (int j = 0; j < kPoints; ++j)
    for (int i = 0; i < kPoints; ++i) {
      const float u = (static_cast<float>(i) + 0.5f) * (2.0f / kPoints) - 1.0f;
      const float v = (static_cast<float>(j) + 0.5f) * (2.0f / kPoints) - 1.0f;
      const float weight = (1.0f - std::abs(u)) * (1.0f - std::abs(v));
      const int square =
          static_cast<int>(std::floor(point.x + width.x * u)) + static_cast<int>(std::floor(point.y + width.y * v));
      all += weight;
      if (square % 2 == 0) first += weight;
    }
  return first / all;
}

TEST(Chequer, MeanIsThatOfManyPoints) {
  for (const vec2 width : {vec2{0.1f, 0.1f}, vec2{0.7f, 0.2f}, vec2{1.3f, 0.9f}, vec2{5.0f, 0.4f}, vec2{2.5f, 3.5f}})
    for (float x = -2.3f; x < 2.0f; x += 0.61f)
      for (float y = -1.7f; y < 2.0f; y += 0.83f)
        EXPECT_NEAR(chequer_fraction({x, y}, width), brute_force({x, y}, width), 5e-3f) << x << " " << y;
}

TEST(Chequer, FadesToHalfWhenSquaresAreSmall) {
  for (float x = -2.3f; x < 2.0f; x += 0.1f) EXPECT_NEAR(chequer_fraction({x, 0.5f}, {60.0f, 0.1f}), 0.5f, 0.01f);
}

Ground chequered() {
  Ground ground;
  ground.square = 0.5f;
  ground.albedo = vec3{0.8f};
  ground.second_albedo = vec3{0.2f};
  return ground;
}

const Environment& sky() {
  static const Environment environment{EnvironmentOptions{}};
  return environment;
}

class HalfLight : public WaterLight {
  Light at(vec3, vec3) const override {
    Light light;
    light.sun = vec3{0.0f};
    light.sky = vec3{0.5f};
    return light;
  }
};

TEST(Ground, IsAsFarAsItsPlane) {
  Ground ground;
  ground.up = {0, 0, 2.0f};
  ground.height = 1.0f;
  const Scene scene(sky(), ground);
  const vec3 down = glm::normalize(vec3{1, 0, -1});
  EXPECT_NEAR(scene.ground_distance({{5, 5, 4}, down}), 3.0f * std::numbers::sqrt2_v<float>, 1e-5f);
  EXPECT_EQ(scene.ground_distance({{5, 5, 4}, -down}), std::numeric_limits<float>::infinity());
  EXPECT_EQ(scene.ground_distance({{5, 5, 0}, -down}), std::numeric_limits<float>::infinity()) << "seen from below";
  ground.visible = false;
  EXPECT_EQ(Scene(sky(), ground).ground_distance({{5, 5, 4}, down}), std::numeric_limits<float>::infinity());
}

TEST(Ground, IsADiffuseMirrorOfSunAndSky) {
  const Scene scene(sky(), chequered());
  const vec3 light = sky().irradiance({0, 1, 0}) + sky().sun_irradiance() * sky().sun_direction().y;
  const vec3 first = scene.radiance({{0.25f, 3.0f, -0.25f}, {0, -1, 0}}, 1e-4f);
  const vec3 second = scene.radiance({{0.75f, 3.0f, -0.25f}, {0, -1, 0}}, 1e-4f);
  EXPECT_NEAR((first + second).y, light.y / std::numbers::pi_v<float>, 1e-4f);
  EXPECT_NEAR(std::abs(first.y - second.y), 0.6f * light.y / std::numbers::pi_v<float>, 1e-4f);
}

TEST(Ground, TakesTheLightThatReachesIt) {
  Scene scene(sky(), Ground{});
  scene.set_water_light(std::make_shared<HalfLight>());
  const vec3 seen = scene.radiance({{0, 1, 0}, {0, -1, 0}}, 0.0f);
  EXPECT_NEAR(seen.y, 0.5f * 0.5f * sky().irradiance({0, 1, 0}).y / std::numbers::pi_v<float>, 1e-5f);
}

TEST(Ground, FadesIntoTheHorizonWithoutAnEdge) {
  Ground ground = chequered();
  ground.fade_radius = 20.0f;
  for (const float fade : {0.0f, 20.0f}) {
    ground.fade_radius = fade;
    const Scene scene(sky(), ground);
    // A column of a picture from 40 degrees down to the horizon, as wide as its pixels.
    const float pixel = 1e-3f;
    vec3 last{0.0f};
    for (float angle = 0.05f; angle > -0.01f; angle -= pixel) {
      const vec3 seen = scene.radiance({{0.1f, 2, 0.2f}, {std::cos(angle), -std::sin(angle), 0.0f}}, pixel);
      if (angle < 0.045f) {
        EXPECT_LT(glm::length(seen - last), 0.06f) << fade << " " << angle;
      }
      last = seen;
    }
    EXPECT_LT(glm::length(last - sky().radiance({1, 0.01f, 0})), 0.02f);
  }
}

TEST(Ground, DoesNotShimmerFarAway) {
  const Scene scene(sky(), chequered());
  // Neighbouring pixels where a pixel holds several squares.
  float low = 1e9f, high = 0;
  for (float x = -0.1f; x < 0.1f; x += 0.002f) {
    const float value = scene.radiance({{0, 2, 0}, glm::normalize(vec3{x, -0.02f, 1.0f})}, 0.002f).y;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  EXPECT_LT(high - low, 0.03f * high);
}

}  // namespace
}  // namespace meniscus
