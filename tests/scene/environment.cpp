#include <gtest/gtest.h>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>

#include "hdr_writing.h"
#include "meniscus/scene.h"

namespace meniscus {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

/// Integral over the sphere of f(direction) by rings around `axis`, finer close to it.
template <class F>
vec3 over_sphere(vec3 axis, F f) {
  const vec3 side = glm::normalize(glm::cross(axis, std::abs(axis.x) < 0.9f ? vec3{1, 0, 0} : vec3{0, 1, 0}));
  const vec3 other = glm::cross(axis, side);
  constexpr int kRings = 400, kSpokes = 64;
  vec3 sum{0.0f};
  for (int i = 0; i < kRings; ++i) {
    // theta = pi u^2 puts rings close together at the axis.
    const float u = (static_cast<float>(i) + 0.5f) / kRings, theta = kPi * u * u;
    const float weight = 2.0f * kPi * u / kRings * std::sin(theta) * 2.0f * kPi / kSpokes;
    for (int j = 0; j < kSpokes; ++j) {
      const float phi = (static_cast<float>(j) + 0.5f) * 2.0f * kPi / kSpokes;
      sum += weight * f(std::cos(theta) * axis + std::sin(theta) * (std::cos(phi) * side + std::sin(phi) * other));
    }
  }
  return sum;
}

float luminance(vec3 rgb) { return glm::dot(rgb, vec3{0.2126f, 0.7152f, 0.0722f}); }

TEST(Sky, LightsAWhiteGroundToRadianceOne) {
  for (const vec3 sun : {vec3{0.4f, 0.8f, 0.45f}, vec3{-1.0f, 0.6f, 0.3f}, vec3{0.0f, 1.0f, 0.0f}}) {
    EnvironmentOptions options;
    options.sun_direction = sun;
    const Environment environment(options);
    const vec3 white = (environment.irradiance({0, 1, 0}) +
                        environment.sun_irradiance() * glm::dot(environment.sun_direction(), vec3{0, 1, 0})) /
                       kPi;
    EXPECT_NEAR(luminance(white), 1.0f, 0.03f);
    EXPECT_NEAR(white.x, white.z, 0.15f) << "nearly neutral";
  }
}

TEST(Sky, TurnsWithItsUpAxis) {
  EnvironmentOptions y_up, z_up;
  y_up.sun_direction = {0.3f, 0.7f, -0.5f};
  z_up.up = {0, 0, 3.0f};
  z_up.sun_direction = {0.3f, 0.5f, 0.7f};  // turned by 90 degrees around x
  const Environment a(y_up), b(z_up);
  for (float t = 0; t < 6; t += 0.3f) {
    const vec3 d = glm::normalize(vec3{std::cos(t), std::sin(3 * t), std::sin(t)});
    EXPECT_LT(glm::length(a.radiance(d) - b.radiance({d.x, -d.z, d.y})), 1e-4f);
  }
}

TEST(Sky, IsBlueAtTheZenithAndHasNoEdgeAtTheHorizon) {
  const Environment environment{EnvironmentOptions{}};
  const vec3 zenith = environment.radiance({0, 1, 0});
  EXPECT_GT(zenith.z, 1.5f * zenith.x);
  for (float azimuth = 0; azimuth < 6.2f; azimuth += 0.2f) {
    const vec3 along{std::cos(azimuth), 0, std::sin(azimuth)};
    const vec3 above = environment.radiance(glm::normalize(along + vec3{0, 0.004f, 0}));
    const vec3 below = environment.radiance(glm::normalize(along - vec3{0, 0.004f, 0}));
    EXPECT_LT(glm::length(above - below), 0.02f * glm::length(above));
    EXPECT_GT(above.z, above.x) << "neither yellow nor purple";
    EXPECT_GT(above.y, above.x) << "neither yellow nor purple";
  }
}

TEST(Sky, IsNowhereBlackNorNegative) {
  for (const vec3 sun : {vec3{0.4f, 0.8f, 0.45f}, vec3{1.0f, 0.01f, 0.0f}, vec3{1.0f, -0.5f, 0.0f}}) {
    EnvironmentOptions options;
    options.sun_direction = sun;
    const Environment environment(options);
    EXPECT_GE(environment.sun_irradiance().x, 0.0f);
    for (float t = 0; t < 30; t += 0.1f) {
      const vec3 d = glm::normalize(vec3{std::cos(t), std::sin(3.3f * t), std::sin(1.7f * t)});
      for (const float roughness : {0.0f, 0.15f, 0.7f, 1.0f})
        for (int k = 0; k < 3; ++k) EXPECT_GT(environment.radiance(d, roughness)[k], 0.005f);
    }
  }
}

TEST(Environment, IrradianceIsTheCosineIntegralOfItsRadiance) {
  const Environment environment{EnvironmentOptions{}};
  for (const vec3 normal : {vec3{0, 1, 0}, vec3{1, 0, 0}, vec3{0, -1, 0}, glm::normalize(vec3{0.3f, 0.5f, -0.8f})}) {
    const vec3 expected =
        over_sphere(normal, [&](vec3 d) { return std::max(0.0f, glm::dot(d, normal)) * environment.radiance(d); });
    EXPECT_LT(glm::length(environment.irradiance(normal) - expected), 0.03f * glm::length(expected));
  }
}

TEST(Environment, GlareIntegratesToTheSunsIrradianceHoweverWideItIs) {
  const Environment environment{EnvironmentOptions{}};
  for (const float variance : {0.0f, 1e-4f, 1e-2f, 0.3f}) {
    const vec3 sum =
        over_sphere(environment.sun_direction(), [&](vec3 d) { return environment.sun_glare(d, variance); });
    EXPECT_LT(glm::length(sum - environment.sun_irradiance()), 0.01f * glm::length(sum)) << variance;
  }
}

TEST(Environment, BlurKeepsTheMeanAndTakesTheContrast) {
  // A map of white and black halves: the transition between them widens with roughness.
  const tests::TemporaryFile file(tests::flat_hdr(64, 32, [](int, int y) { return y < 16 ? vec3{1.0f} : vec3{0.0f}; }));
  EnvironmentOptions options;
  options.hdr_path = file.path();
  const Environment environment(options);
  float last = 1.0f;
  for (const float roughness : {0.0f, 0.2f, 0.4f, 0.6f, 0.8f, 1.0f}) {
    const float above = environment.radiance(glm::normalize(vec3{1, 0.15f, 0}), roughness).x;
    const float below = environment.radiance(glm::normalize(vec3{1, -0.15f, 0}), roughness).x;
    EXPECT_NEAR(above + below, 1.0f, 0.06f) << roughness;
    EXPECT_LE(above - below, last + 1e-4f) << roughness;
    last = above - below;
  }
  EXPECT_LT(last, 0.3f);
}

TEST(Environment, OfAUniformMapIsUniformInEveryRespect) {
  const tests::TemporaryFile file(tests::flat_hdr(16, 8, [](int, int) { return vec3{1.0f}; }));
  EnvironmentOptions options;
  options.hdr_path = file.path();
  const Environment environment(options);
  EXPECT_EQ(environment.sun_irradiance(), vec3{0.0f});
  for (float t = 0; t < 6; t += 0.3f) {
    const vec3 d = glm::normalize(vec3{std::cos(t), std::sin(3 * t), std::sin(t)});
    for (const float roughness : {0.0f, 0.1f, 0.5f, 1.0f})
      EXPECT_LT(glm::length(environment.radiance(d, roughness) - vec3{1.0f}), 1e-5f);
    EXPECT_LT(glm::length(environment.irradiance(d) - vec3{kPi}), 1e-4f);
  }
}

TEST(Environment, PutsTheUpperEdgeOfAMapUp) {
  const tests::TemporaryFile file(tests::flat_hdr(16, 8, [](int, int y) {
    return y < 2 ? vec3{4.0f, 1.0f, 1.0f} : vec3{1.0f, 1.0f, 2.0f};
  }));
  for (const vec3 up : {vec3{1, 0, 0}, vec3{0, 1, 0}, vec3{0, 0, 1}}) {
    EnvironmentOptions options;
    options.hdr_path = file.path();
    options.up = up;
    const Environment environment(options);
    EXPECT_EQ(environment.radiance(up), (vec3{4.0f, 1.0f, 1.0f}));
    EXPECT_EQ(environment.radiance(-up), (vec3{1.0f, 1.0f, 2.0f}));
  }
}

TEST(Environment, TakesTheSunOutOfAMapThatHoldsOne) {
  // One pixel of 128 x 64 at longitude pixel 96: a quarter turn to the right of the centre, 45 degrees up.
  const tests::TemporaryFile file(tests::flat_hdr(128, 64, [](int x, int y) {
    return x == 96 && y == 16 ? vec3{2048.0f, 1024.0f, 512.0f} : vec3{0.5f};
  }));
  EnvironmentOptions options;
  options.hdr_path = file.path();
  const Environment environment(options);
  const float theta = 16.5f / 64.0f * kPi, solid_angle = 2.0f * kPi * kPi / (128.0f * 64.0f) * std::sin(theta);
  EXPECT_NEAR(environment.sun_irradiance().x, 2047.5f * solid_angle, 1e-2f * 2048.0f * solid_angle);
  EXPECT_NEAR(environment.sun_irradiance().z, 511.5f * solid_angle, 1e-2f * 512.0f * solid_angle);
  EXPECT_NEAR(environment.sun_direction().y, std::cos(theta), 1e-3f);
  EXPECT_LT(glm::length(environment.radiance(environment.sun_direction()) - vec3{0.5f}), 1e-5f);
}

TEST(Environment, RefusesDirectionsWithoutLength) {
  EnvironmentOptions options;
  options.sun_direction = vec3{0.0f};
  EXPECT_THROW(Environment{options}, Error);
  options = {};
  options.up = vec3{0.0f};
  EXPECT_THROW(Environment{options}, Error);
  options = {};
  options.hdr_path = "/nowhere/sky.hdr";
  EXPECT_THROW(Environment{options}, Error);
}

}  // namespace
}  // namespace meniscus
