#include <gtest/gtest.h>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>

#include "analytic_water.h"
#include "fixtures.h"
#include "shading/caustics_map.h"

namespace meniscus {
namespace {

using tests::AnalyticWater;
using tests::flat_water;

const vec3 kUp{0, 1, 0};

Environment sun_from(vec3 direction) {
  EnvironmentOptions options;
  options.sun_direction = direction;
  return Environment(options);
}

Scene floor_under(const Environment& environment, float height = 0) {
  Ground ground;
  ground.height = height;
  return Scene(environment, ground);
}

Material sea(vec3 extinction = {0.4f, 0.1f, 0.05f}) {
  Material material = tests::clear();
  material.extinction = extinction;
  return material;
}

/// Irradiance on a flat floor under flat water from a light at an angle from the vertical, per channel.
vec3 in_closed_form(vec3 facing, double angle, double depth, const Material& material) {
  const double eta = static_cast<double>(material.ior);
  const double bent = std::asin(std::sin(angle) / eta);
  const double transmitted = (1 - tests::reflectance(angle, eta)) * std::cos(angle);
  vec3 result;
  for (int c = 0; c < 3; ++c)
    result[c] = static_cast<float>(static_cast<double>(facing[c]) * transmitted *
                                   std::exp(-static_cast<double>(material.extinction[c]) * depth / std::cos(bent)));
  return result;
}

class FlatWater : public testing::TestWithParam<std::tuple<double, ScreenDirection, bool>> {};

TEST_P(FlatWater, LightsItsFloorAsInClosedForm) {
  const auto [angle, screen, exact] = GetParam();
  const Environment environment =
      sun_from({static_cast<float>(std::sin(angle)), static_cast<float>(std::cos(angle)), 0});
  const Scene scene = floor_under(environment);
  const AnalyticWater water = flat_water({1, 1}, 0.5f);
  CausticsOptions options;
  options.screen = screen;
  options.exact_hits = exact;
  options.screen_width = 128;
  options.map_size = 300;
  const auto light = caustics(water, scene, sea(), options);
  const vec3 expected = in_closed_form(environment.sun_irradiance(), angle, 0.5, sea());
  for (float x : {-0.5f, -0.21f, 0.0f, 0.13f, 0.4f})
    for (float z : {-0.6f, 0.03f, 0.5f}) {
      const WaterLight::Light at = light->at({x, 0, z}, kUp);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(at.refracted[c] / expected[c], 1.0f, 0.01f) << x << " " << z;
      // The test's water has no sides: farther out the sun comes in below it.
      if (x + 0.5 * std::tan(angle) < 0.98) EXPECT_EQ(at.sun, vec3{0.0f});
    }
}

INSTANTIATE_TEST_SUITE_P(Suns, FlatWater,
                         testing::Combine(testing::Values(0.0, 0.5, 1.0),
                                          testing::Values(ScreenDirection::light, ScreenDirection::up),
                                          testing::Bool()));

}  // namespace
}  // namespace meniscus
