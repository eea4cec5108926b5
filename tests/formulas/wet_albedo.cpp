#include <gtest/gtest.h>
#include <cmath>

#include "meniscus/formulas.h"

namespace meniscus {
namespace {

using formulas::diffuse_reflectance;
using formulas::wet_albedo;

/// Mean of Fresnel's reflectance weighted by the cosine, by the midpoint rule.
double mean_reflectance(float eta) {
  constexpr int kSteps = 4000;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double c = (i + 0.5) / kSteps;
    sum += 2 * c * static_cast<double>(formulas::fresnel_reflectance(static_cast<float>(c), eta)) / kSteps;
  }
  return sum;
}

TEST(DiffuseReflectance, IsTheMeanOfFresnels) {
  for (const float eta : {1.2f, 1.333f, 1.5f, 2.0f, 2.5f})
    EXPECT_NEAR(diffuse_reflectance(eta), mean_reflectance(eta), 2e-4) << eta;
}

TEST(DiffuseReflectance, FromInsideFollowsFromThatFromOutside) {
  // Reversibility: 1 - R_in = (1 - R_out) / eta^2, the share that wet_albedo() keeps.
  for (const float eta : {1.333f, 1.5f})
    EXPECT_NEAR(1.0 - mean_reflectance(1.0f / eta), (1.0 - static_cast<double>(diffuse_reflectance(eta))) / (eta * eta),
                2e-3);
}

TEST(WetAlbedo, IsTheSumOfAllReflectionsUnderTheWater) {
  const double kept = mean_reflectance(1.0f / 1.333f);
  for (const float dry : {0.05f, 0.11f, 0.4f, 0.8f}) {
    double light = 1, out = 0;
    for (int bounce = 0; bounce < 200; ++bounce) {
      light *= static_cast<double>(dry);
      out += light * (1 - kept);
      light *= kept;
    }
    EXPECT_NEAR(wet_albedo(dry, 1.333f), out, 2e-3) << dry;
  }
}

TEST(WetAlbedo, IsDarkerAndNeverFallsWhereTheDryOneRises) {
  EXPECT_EQ(wet_albedo(0.0f, 1.333f), 0.0f);
  EXPECT_NEAR(wet_albedo(1.0f, 1.333f), 1.0f, 1e-6f);
  float before = 0;
  for (float dry = 0.01f; dry < 0.995f; dry += 0.01f) {
    const float wet = wet_albedo(dry, 1.333f);
    EXPECT_LT(wet, dry);
    EXPECT_GT(wet, before);
    EXPECT_LE(wet_albedo(dry, 1.5f), wet) << "darker under a denser liquid";
    before = wet;
  }
}

}  // namespace
}  // namespace meniscus
