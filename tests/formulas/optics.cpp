#include "meniscus/formulas/optics.h"

#include <gtest/gtest.h>
#include <cmath>

namespace meniscus::formulas {
namespace {

constexpr float kWater = 1.333f;
constexpr float kIndices[] = {1.333f, 1.47f, 2.4f, 1.0f / 1.333f, 1.0f / 1.47f};

TEST(Fresnel, AtNormalIncidenceIsTheSquareOfTheRelativeIndexStep) {
  for (const float eta : kIndices) {
    const float expected = std::pow((eta - 1.0f) / (eta + 1.0f), 2.0f);
    EXPECT_NEAR(fresnel(1.0f, eta).reflectance, expected, 1e-6f);
    EXPECT_NEAR(fresnel(1.0f, eta).reflectance_s, fresnel(1.0f, eta).reflectance_p, 1e-6f);
  }
}

TEST(Fresnel, AgreesWithTheSineAndTangentLaws) {
  for (const float eta : {1.333f, 1.47f, 2.4f}) {
    for (double angle = 0.05; angle < 1.55; angle += 0.05) {
      const double behind = std::asin(std::sin(angle) / eta);
      const double s = std::pow(std::sin(angle - behind) / std::sin(angle + behind), 2);
      const double p = std::pow(std::tan(angle - behind) / std::tan(angle + behind), 2);
      const Interface f = fresnel(static_cast<float>(std::cos(angle)), eta);
      EXPECT_NEAR(f.reflectance_s, s, 2e-5) << eta << " " << angle;
      EXPECT_NEAR(f.reflectance_p, p, 2e-5) << eta << " " << angle;
      EXPECT_NEAR(f.reflectance, 0.5 * (s + p), 2e-5);
      EXPECT_NEAR(f.cos_t, std::cos(behind), 1e-5);
    }
  }
}

TEST(Fresnel, ConservesEnergyOfTheFields) {
  // Reflected plus transmitted flux is one: T = eta cos_t / cos_i * t^2 with the transmitted amplitudes t.
  for (float c = 0.05f; c <= 1.0f; c += 0.05f) {
    const Interface f = fresnel(c, kWater);
    const float t_s = 2.0f * c / (c + kWater * f.cos_t);
    const float t_p = 2.0f * c / (kWater * c + f.cos_t);
    EXPECT_NEAR(f.reflectance_s + kWater * f.cos_t / c * t_s * t_s, 1.0f, 2e-6f);
    EXPECT_NEAR(f.reflectance_p + kWater * f.cos_t / c * t_p * t_p, 1.0f, 2e-6f);
  }
}

TEST(Fresnel, ReflectsNoParallelLightAtBrewstersAngle) {
  for (const float eta : kIndices) EXPECT_LT(fresnel(std::cos(std::atan(eta)), eta).reflectance_p, 1e-11f) << eta;
}

TEST(Fresnel, IsAMirrorAtGrazingIncidence) {
  EXPECT_FLOAT_EQ(fresnel(0.0f, kWater).reflectance, 1.0f);
  EXPECT_GT(fresnel(0.001f, kWater).reflectance, 0.99f);
}

TEST(Fresnel, IsTheSameFromBothSidesAlongTheSameRay) {
  for (float c = 0.1f; c <= 1.0f; c += 0.1f) {
    const Interface in = fresnel(c, kWater);
    EXPECT_NEAR(in.reflectance, fresnel(in.cos_t, 1.0f / kWater).reflectance, 1e-5f);
  }
}

TEST(Fresnel, ReflectsTotallyBeyondTheCriticalAngleAndNotBefore) {
  const float critical = std::asin(1.0f / kWater);
  EXPECT_EQ(fresnel(std::cos(critical + 0.01f), 1.0f / kWater).reflectance, 1.0f);
  EXPECT_EQ(fresnel(std::cos(critical + 0.01f), 1.0f / kWater).cos_t, 0.0f);
  EXPECT_LT(fresnel(std::cos(critical - 0.01f), 1.0f / kWater).reflectance, 0.8f);
  EXPECT_GT(fresnel(std::cos(critical - 0.01f), 1.0f / kWater).cos_t, 0.0f);
}

TEST(Fresnel, IsFiniteForCosinesOutsideTheirRange) {
  for (const float c : {-2.0f, -1e-6f, 1.0000002f, 7.0f}) {
    const Interface f = fresnel(c, kWater);
    EXPECT_TRUE(f.reflectance >= 0.0f && f.reflectance <= 1.0f && f.cos_t >= 0.0f) << c;
  }
}

TEST(Snell, KeepsTheSineOverTheIndexAndThePlaneOfIncidence) {
  const vec3 normal = normalize(vec3(0.2f, 1.0f, -0.3f));
  for (const float eta : kIndices) {
    for (float a = 0.0f; a < 6.0f; a += 0.37f) {
      const vec3 incident = normalize(vec3(std::cos(a), -1.7f, std::sin(a)));
      const float cos_i = -dot(incident, normal);
      const Interface f = fresnel(cos_i, eta);
      if (f.cos_t <= 0.0f) continue;
      const vec3 behind = refracted(incident, normal, eta, f.cos_t);
      // n x d is the tangential part: it is divided by eta and keeps its direction.
      EXPECT_LT(length(cross(normal, incident) - eta * cross(normal, behind)), 2e-6f);
      EXPECT_NEAR(length(behind), 1.0f, 1e-6f);
      EXPECT_NEAR(-dot(behind, normal), f.cos_t, 2e-6f);
      EXPECT_NEAR(dot(cross(normal, incident), behind), 0.0f, 1e-6f);
    }
  }
}

TEST(Snell, LeavesASlabInTheDirectionInWhichItWasEntered) {
  const vec3 normal(0.0f, 1.0f, 0.0f);
  const vec3 incident = normalize(vec3(0.9f, -0.4f, 0.2f));
  const Interface in = fresnel(-dot(incident, normal), kWater);
  const vec3 inside = refracted(incident, normal, kWater, in.cos_t);
  const Interface out = fresnel(-dot(inside, normal), 1.0f / kWater);
  EXPECT_LT(length(refracted(inside, normal, 1.0f / kWater, out.cos_t) - incident), 1e-6f);
}

TEST(Mirror, KeepsTheTangentialPartAndTurnsTheNormalPart) {
  const vec3 normal = normalize(vec3(0.2f, 1.0f, -0.3f));
  const vec3 incident = normalize(vec3(0.5f, -0.7f, 0.1f));
  const vec3 out = mirrored(incident, normal);
  EXPECT_NEAR(dot(out, normal), -dot(incident, normal), 1e-6f);
  EXPECT_LT(length(cross(out - incident, normal)), 1e-6f);
  EXPECT_NEAR(length(out), 1.0f, 1e-6f);
}

TEST(BeerLambert, MultipliesOverConsecutivePaths) {
  const vec3 extinction(0.3f, 1.1f, 4.0f);
  const vec3 whole = beer_lambert(extinction, 0.7f);
  const vec3 parts = beer_lambert(extinction, 0.3f) * beer_lambert(extinction, 0.4f);
  EXPECT_LT(length(whole - parts), 1e-6f);
  EXPECT_NEAR(whole.y, std::exp(-0.77), 1e-6);
  EXPECT_EQ(beer_lambert(extinction, 0.0f), vec3(1.0f));
}

}  // namespace
}  // namespace meniscus::formulas
