#include <gtest/gtest.h>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <numbers>

#include "meniscus/scene.h"

namespace meniscus {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
const vec3 kUp{0, 1, 0};

float luminance(vec3 rgb) { return glm::dot(rgb, vec3{0.2126f, 0.7152f, 0.0722f}); }

/// Made once each, as their tables take time.
const Environment& under(float cover, float scale = 1) {
  static std::map<std::pair<float, float>, Environment> made;
  if (const auto found = made.find({cover, scale}); found != made.end()) return found->second;
  EnvironmentOptions options;
  options.cloud_cover = cover;
  options.radiance_scale = scale;
  return made.emplace(std::pair{cover, scale}, Environment(options)).first->second;
}

vec3 at_elevation(float degrees, float turn) {
  const float e = degrees * kPi / 180;
  return {std::cos(e) * std::cos(turn), std::sin(e), std::cos(e) * std::sin(turn)};
}

TEST(OvercastSky, LightsAWhiteGroundToRadianceOneAtAnyCover) {
  for (const float cover : {0.0f, 0.25f, 0.5f, 1.0f}) {
    const Environment& sky = under(cover);
    const vec3 white =
        (sky.irradiance(kUp) + sky.sun_irradiance() * std::max(0.0f, glm::dot(sky.sun_direction(), kUp))) / kPi;
    EXPECT_NEAR(luminance(white), 1.0f, 0.03f) << cover;
    EXPECT_NEAR(white.x, white.z, 0.15f) << "nearly neutral at " << cover;
  }
}

TEST(OvercastSky, IsThreeTimesAsBrightAtTheZenithAsAtTheHorizon) {
  const Environment& sky = under(1);
  const vec3 zenith = sky.radiance(kUp);
  for (const float elevation : {5.0f, 20.0f, 45.0f, 70.0f})
    for (const float turn : {0.0f, 1.0f, 3.0f, 5.5f}) {
      const vec3 expected = zenith * ((1 + 2 * std::sin(elevation * kPi / 180)) / 3);
      EXPECT_LT(glm::length(sky.radiance(at_elevation(elevation, turn)) - expected), 0.01f * glm::length(expected));
    }
  // Of the irradiance E of a horizontal plane, the zenith's radiance is 9 / (7 pi).
  EXPECT_NEAR(luminance(zenith), 9.0f / 7.0f, 0.01f);
}

TEST(OvercastSky, TakesTheSunAwayByItsCover) {
  const vec3 clear = under(0).sun_irradiance();
  EXPECT_LT(glm::length(under(0.25f).sun_irradiance() - 0.75f * clear), 1e-5f);
  EXPECT_EQ(under(1).sun_irradiance(), vec3{0.0f});
  const vec3 direction = at_elevation(35, 2);
  const vec3 half = 0.5f * (under(0).radiance(direction) + under(1).radiance(direction));
  EXPECT_LT(glm::length(under(0.5f).radiance(direction) - half), 1e-4f);
}

TEST(RadianceScale, ScalesAllLight) {
  const Environment &whole = under(0.25f), &dim = under(0.25f, 0.02f);
  for (const float elevation : {-60.0f, -5.0f, 10.0f, 50.0f}) {
    const vec3 d = at_elevation(elevation, 1.2f);
    EXPECT_LT(glm::length(dim.radiance(d) - 0.02f * whole.radiance(d)), 1e-6f);
    for (const float roughness : {0.05f, 0.3f, 1.0f})
      EXPECT_LT(glm::length(dim.radiance(d, roughness) - 0.02f * whole.radiance(d, roughness)), 1e-6f);
    EXPECT_LT(glm::length(dim.irradiance(d) - 0.02f * whole.irradiance(d)), 1e-6f);
  }
  EXPECT_LT(glm::length(dim.sun_irradiance() - 0.02f * whole.sun_irradiance()), 1e-6f);
  const vec3 sun = whole.sun_direction();
  EXPECT_LT(glm::length(dim.sun_glare(sun, 0.01f) - 0.02f * whole.sun_glare(sun, 0.01f)), 1e-4f);
}

TEST(OvercastSky, RefusesWhatIsNoCoverOrScale) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  for (const float cover : {-0.1f, 1.1f, nan, inf}) {
    EnvironmentOptions options;
    options.cloud_cover = cover;
    EXPECT_THROW(Environment{options}, Error);
  }
  for (const float scale : {-1.0f, nan, inf}) {
    EnvironmentOptions options;
    options.radiance_scale = scale;
    EXPECT_THROW(Environment{options}, Error);
  }
}

}  // namespace
}  // namespace meniscus
