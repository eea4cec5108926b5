#include <gtest/gtest.h>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "analytic_water.h"
#include "fixtures.h"
#include "shading/light_map.h"

namespace meniscus {
namespace {

/// A ball or a square slab, whose thickness is known; a slab may have waves along x.
class Body : public Surface {
 public:
  static constexpr float kPeriod = 1.0f;
  Body(vec3 half, bool ball, float wave = 0) : half_(half), ball_(ball), wave_(wave) {}
  /// The depth alone, as if from above: where the body's box begins.
  SurfaceBuffers see(const View& view, std::span<const vec2>, StageTimes*) const override {
    SurfaceBuffers seen;
    seen.depth = Image<float>(view.width, view.height, std::numeric_limits<float>::infinity());
    const Image<float> chords = thickness(view, {}, nullptr);
    for (int y = 0; y < view.height; ++y)
      for (int x = 0; x < view.width; ++x) {
        const Ray ray = view.ray({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
        if (chords(x, y) > 0) seen.depth(x, y) = (2 * half_.y - ray.origin.y) / ray.direction.y;
      }
    return seen;
  }
  Image<float> thickness(const View& view, std::span<const vec2>, StageTimes*) const override {
    Image<float> image(view.width, view.height);
    for (int y = 0; y < view.height; ++y)
      for (int x = 0; x < view.width; ++x)
        image(x, y) = chord(view.ray({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f}));
    return image;
  }
  Bounds bounds() const override {
    Bounds box;
    if (half_.x > 0) {
      box.add({-half_.x, 0, -half_.z});
      box.add({half_.x, 2 * half_.y, half_.z});
    }
    return box;
  }

 private:
  float chord(const Ray& ray) const {
    const vec3 origin = ray.origin - vec3{0, half_.y, 0};
    if (ball_) {
      const float b = glm::dot(origin, ray.direction), c = glm::dot(origin, origin) - half_.y * half_.y;
      return b * b > c ? 2.0f * std::sqrt(b * b - c) : 0.0f;
    }
    const vec3 a = (-half_ - origin) / ray.direction, b = (half_ - origin) / ray.direction;
    const vec3 low = glm::min(a, b), high = glm::max(a, b);
    const float length = std::min(high.x, std::min(high.y, high.z)) - std::max(low.x, std::max(low.y, low.z));
    return length > 0 ? length + wave_ * std::cos(2.0f * 3.14159265f / kPeriod * ray.origin.x) : 0.0f;
  }
  vec3 half_;
  bool ball_;
  float wave_;
};

Environment under_sun(vec3 direction) {
  EnvironmentOptions options;
  options.sun_direction = direction;
  return Environment(options);
}

const vec3 kSun{0.02f, 1.0f, 0.01f};

TEST(SoftShadow, IsWholeWithoutWaterAndFarFromIt) {
  const Environment environment = under_sun(kSun);
  const Material water = material_preset("water", 1.0f);
  const auto none = soft_shadow(Body(vec3{0.0f}, false), environment, Ground{}, water);
  EXPECT_EQ(none->at({0, 0, 0}, vec3{0, 1, 0}).sun, vec3{1.0f});
  EXPECT_EQ(none->at({0, 0, 0}, vec3{0, 1, 0}).sky, vec3{1.0f});
  const auto some = soft_shadow(Body(vec3{1.0f}, false), environment, Ground{}, water);
  EXPECT_EQ(some->at({30, 0, 0}, vec3{0, 1, 0}).sun, vec3{1.0f});
  EXPECT_EQ(some->at({0, 0, -30}, vec3{0, 1, 0}).sky, vec3{1.0f});
}

TEST(SoftShadow, UnderASlabIsFresnelTimesBeer) {
  Material material = tests::clear();
  material.extinction = {0.2f, 0.5f, 1.5f};
  const auto light = soft_shadow(Body({2, 0.5f, 2}, false), under_sun({0, 1, 0}), Ground{}, material);
  const double r = tests::reflectance(0, 1.333);
  for (int k = 0; k < 3; ++k)
    EXPECT_NEAR(light->at({0.1f, 0, 0.2f}, vec3{0, 1, 0}).sun[k],
                (1 - 2 * r) * std::exp(-static_cast<double>(material.extinction[k])), 2e-3);
}

TEST(SoftShadow, UnderAnOpaqueBodyIsDark) {
  const auto light = soft_shadow(Body(vec3{1.0f}, false), under_sun(kSun), Ground{}, material_preset("clay", 1.0f));
  EXPECT_LT(light->at({0, 0, 0}, vec3{0, 1, 0}).sun.x, 0.01f);
  EXPECT_LT(light->at({0, 0, 0}, vec3{0, 1, 0}).sky.x, 0.5f);
  EXPECT_GT(light->at({0, 0, 0}, vec3{0, 1, 0}).sky.x, 0.05f);
}

TEST(SoftShadow, FallsWhereTheSunThrowsIt) {
  // A slab 2 m high under a sun at 45 degrees: its shadow reaches 2 m away from the sun and not towards it.
  const auto light =
      soft_shadow(Body({0.5f, 1.0f, 0.5f}, false), under_sun({1, 1, 0}), Ground{}, material_preset("clay", 1.0f));
  EXPECT_LT(light->at({-1.8f, 0, 0}, vec3{0, 1, 0}).sun.x, 0.1f);
  EXPECT_GT(light->at({1.0f, 0, 0}, vec3{0, 1, 0}).sun.x, 0.95f);
}

TEST(SoftShadow, IsGatheredUnderABallAndMissingAtItsRim) {
  const auto light = soft_shadow(Body(vec3{1.0f}, true), under_sun({0, 1, 0}), Ground{}, tests::clear());
  EXPECT_GT(light->at({0, 0, 0}, vec3{0, 1, 0}).sun.x, 1.1f);
  EXPECT_LT(light->at({0.93f, 0, 0}, vec3{0, 1, 0}).sun.x, 0.6f);
}

TEST(SoftShadow, IsNeitherMadeNorLostByBending) {
  // Under waves light is gathered and thinned out; its mean over a period is that of level water.
  const auto light = soft_shadow(Body({2, 0.5f, 2}, false, 0.05f), under_sun({0, 1, 0}), Ground{}, tests::clear());
  double sum = 0, low = 9, high = 0;
  constexpr int kSteps = 400;
  for (int i = 0; i < kSteps; ++i) {
    const float x = Body::kPeriod * (static_cast<float>(i) / kSteps - 0.5f);
    const double value = static_cast<double>(light->at({x, 0, 0.1f}, vec3{0, 1, 0}).sun.x);
    sum += value;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  EXPECT_NEAR(sum / kSteps, 1 - 2 * tests::reflectance(0, 1.333), 0.01);
  EXPECT_GT(high, 1.2);
  EXPECT_LT(low, 0.9);
}

TEST(SoftShadow, HasNoSteps) {
  const auto light = soft_shadow(Body({0.7f, 0.5f, 0.4f}, false), under_sun({0.5f, 0.7f, 0.3f}), Ground{},
                                 material_preset("water", 1.0f));
  vec3 last = light->at({-3, 0, 0.1f}, vec3{0, 1, 0}).sun;
  for (float x = -3; x < 3; x += 0.002f) {
    const vec3 now = light->at({x, 0, 0.1f}, vec3{0, 1, 0}).sun;
    for (int k = 0; k < 3; ++k) ASSERT_TRUE(now[k] >= 0 && now[k] < 3.0f);
    EXPECT_LT(glm::length(now - last), 0.15f) << x;
    last = now;
  }
}

TEST(SoftShadow, KnowsNoShadowOfASunBelowTheHorizon) {
  const auto light =
      soft_shadow(Body(vec3{1.0f}, false), under_sun({1, -0.2f, 0}), Ground{}, material_preset("clay", 1.0f));
  EXPECT_EQ(light->at({0, 0, 0}, vec3{0, 1, 0}).sun, vec3{1.0f});
  EXPECT_LT(light->at({0, 0, 0}, vec3{0, 1, 0}).sky.x, 0.7f);
}

TEST(SoftShadow, GivesTheSameBitsForAnyNumberOfThreads) {
  const Environment environment = under_sun({0.3f, 0.8f, 0.1f});
  std::vector<std::shared_ptr<const WaterLight>> lights;
  for (const int threads : {1, 2, 5}) {
    const ThreadLimit limit(threads);
    lights.push_back(
        soft_shadow(Body({0.7f, 0.5f, 0.4f}, true), environment, Ground{}, material_preset("water", 1.0f)));
  }
  for (float x = -1; x < 1; x += 0.013f) {
    EXPECT_EQ(lights[0]->at({x, 0, 0.1f}, vec3{0, 1, 0}).sun, lights[1]->at({x, 0, 0.1f}, vec3{0, 1, 0}).sun);
    EXPECT_EQ(lights[0]->at({x, 0, 0.1f}, vec3{0, 1, 0}).sky, lights[2]->at({x, 0, 0.1f}, vec3{0, 1, 0}).sky);
  }
}

TEST(SoftShadow, LeavesBodiesThatStandOutOfTheWaterInFullLight) {
  const Material clay = material_preset("clay", 1.0f);
  for (const bool on_bodies : {false, true}) {
    const auto light =
        soft_shadow(Body({2, 0.5f, 2}, false), under_sun({0, 1, 0}), Ground{}, clay, nullptr, {}, on_bodies);
    EXPECT_LT(light->at({0, -1.0f, 0}, {0, 1, 0}).sun.y, 0.1f) << "under it";
    EXPECT_EQ(light->at({0, 1.2f, 0}, {0, 1, 0}).sun.y > 0.99f, on_bodies) << "above it";
  }
}

TEST(SoftShadow, BeginsAtTheWaterHoweverLowTheSun) {
  // Along a post in the middle of flat water, on its sunny side: full light above the water, less below it.
  const tests::AnalyticWater water = tests::flat_water({2, 2}, 0.5f);
  for (const float elevation : {0.35f, 0.8f, 1.2f}) {
    const vec3 sun{std::cos(elevation), std::sin(elevation), 0};
    const auto soft = soft_shadow(water, under_sun(sun), Ground{}, material_preset("clay", 1.0f), nullptr, {}, true);
    const auto sky = sky_shadow(water, under_sun(sun), Ground{}, material_preset("clay", 1.0f), {}, true);
    for (const float height : {0.55f, 0.65f, 0.9f, 1.5f}) {
      EXPECT_EQ(soft->at({0.1f, height, 0}, {1, 0, 0}).sun, vec3{1.0f}) << elevation << " " << height;
      EXPECT_EQ(soft->at({0.1f, height, 0}, {1, 0, 0}).sky, vec3{1.0f}) << elevation << " " << height;
      if (height > 0.6f) {
        EXPECT_EQ(sky->at({0.1f, height, 0}, {1, 0, 0}).sky, vec3{1.0f}) << elevation << " " << height;
      }
    }
    for (const float height : {0.1f, 0.45f}) {
      EXPECT_LT(soft->at({0.1f, height, 0}, {1, 0, 0}).sun.y, 0.5f) << elevation << " " << height;
      EXPECT_LT(soft->at({0.1f, height, 0}, {1, 0, 0}).sky.y, 0.99f) << elevation << " " << height;
    }
  }
}

TEST(SoftShadow, MeetsASlopingBankAtTheWaterline) {
  // However coarse the map, everywhere along the shore of still water under a sun aslant.
  const float level = 0.5f;
  const tests::AnalyticWater water = tests::flat_water({2, 2}, level);
  const Environment environment = under_sun({0.6f, 0.7f, 0.35f});
  const Material clay = material_preset("clay", 1.0f);
  const vec3 normal = glm::normalize(vec3{-0.3f, 1, 0});
  const auto bank = [&](float height, float along) { return vec3{0.2f + (height - level) / 0.3f, height, along}; };
  const auto soft = soft_shadow(water, environment, Ground{}, clay, nullptr, {}, true);
  const auto sky = sky_shadow(water, environment, Ground{}, clay, {}, true);
  for (float along = -1; along < 1; along += 0.0037f) {
    for (const auto& light : {soft, sky}) {
      EXPECT_EQ(light->at(bank(level + 0.001f, along), normal).sun, vec3{1.0f}) << along;
      EXPECT_EQ(light->at(bank(level + 0.001f, along), normal).sky, vec3{1.0f}) << along;
      EXPECT_LT(light->at(bank(level - 0.015f, along), normal).sky.y, 0.9f) << along;
    }
    EXPECT_LT(soft->at(bank(level - 0.015f, along), normal).sun.y, 0.1f) << along;
  }
}

}  // namespace
}  // namespace meniscus
