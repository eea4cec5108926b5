#include "meniscus/formulas/kernels.h"

#include <gtest/gtest.h>
#include <cmath>
#include <numbers>

namespace meniscus::formulas {
namespace {

struct NamedKernel {
  const char* name;
  float (*value)(float, float);
  float (*slope)(float, float);
};

constexpr NamedKernel kKernels[] = {{"cubic_spline", cubic_spline, cubic_spline_slope},
                                    {"poly6", poly6, poly6_slope},
                                    {"wyvill", wyvill, wyvill_slope},
                                    {"spiky", spiky, spiky_slope}};
constexpr float kSupports[] = {0.003f, 0.1f, 1.0f, 2.0f, 37.0f};

/// Integral of f(r) over a ball of radius h by Simpson's rule along the radius.
template <class F>
double over_ball(double h, F f) {
  constexpr int kIntervals = 2000;
  double sum = 0;
  for (int i = 0; i <= kIntervals; ++i) {
    const double r = h * i / kIntervals;
    const double weight = i == 0 || i == kIntervals ? 1 : (i % 2 == 1 ? 4 : 2);
    sum += weight * r * r * f(static_cast<float>(r));
  }
  return 4 * std::numbers::pi * sum * h / kIntervals / 3;
}

TEST(Kernels, IntegrateToOneOverTheirSupport) {
  for (const NamedKernel& kernel : kKernels)
    for (const float h : kSupports)
      EXPECT_NEAR(over_ball(h, [&](float r) { return kernel.value(r, h); }), 1.0, 2e-5) << kernel.name << ", h = " << h;
}

TEST(Kernels, VanishAtAndBeyondTheirSupport) {
  for (const NamedKernel& kernel : kKernels)
    for (const float h : kSupports)
      for (const float beyond : {1.0f, 1.0001f, 1.5f, 100.0f}) {
        // Relative to W(0): the polynomials of Wyvill cancel to rounding at r = h.
        EXPECT_NEAR(kernel.value(beyond * h, h) / kernel.value(0, h), 0.0f, 1e-6f) << kernel.name << " " << beyond;
        EXPECT_NEAR(kernel.slope(beyond * h, h) * h / kernel.value(0, h), 0.0f, 2e-6f) << kernel.name << " " << beyond;
      }
}

TEST(Kernels, AreNotNegativeAndFallMonotonically) {
  for (const NamedKernel& kernel : kKernels) {
    float before = kernel.value(0, 1);
    for (float q = 0.01f; q < 1.2f; q += 0.01f) {
      const float here = kernel.value(q, 1);
      EXPECT_GE(here, 0.0f) << kernel.name << " " << q;
      EXPECT_LE(here, before) << kernel.name << " " << q;
      EXPECT_LE(kernel.slope(q, 1), 1e-5f) << kernel.name << " " << q;
      before = here;
    }
  }
}

TEST(Kernels, HaveSlopesThatMatchDifferences) {
  for (const NamedKernel& kernel : kKernels)
    for (const float h : kSupports) {
      const double unit = static_cast<double>(kernel.value(0, h)) / h;
      for (int i = 1; i < 40; ++i) {
        const float q = (static_cast<float>(i) + 0.3f) / 40.0f, step = 2e-3f;
        const float low = (q - step) * h, high = (q + step) * h;
        const double difference =
            (static_cast<double>(kernel.value(high, h)) - kernel.value(low, h)) / (static_cast<double>(high) - low);
        EXPECT_NEAR(kernel.slope(q * h, h) / unit, difference / unit, 1e-3)
            << kernel.name << ", h = " << h << ", q = " << q;
      }
    }
}

TEST(Kernels, ScaleWithTheCubeOfTheSupport) {
  for (const NamedKernel& kernel : kKernels)
    for (const float q : {0.0f, 0.2f, 0.5f, 0.8f})
      EXPECT_NEAR(kernel.value(q * 0.25f, 0.25f), 64.0f * kernel.value(q, 1.0f), 64.0f * 2e-6f * kernel.value(0, 1))
          << kernel.name;
}

TEST(CubicSpline, HasTheValuesOfItsTwoPieces) {
  // 8 / (pi h^3) times 1 at the centre, 1/4 at the knot, and 1 - 6 q^2 + 6 q^3 and 2 (1 - q)^3 around it.
  const double top = 8 / std::numbers::pi;
  EXPECT_NEAR(cubic_spline(0.0f, 1.0f), top, 1e-6);
  EXPECT_NEAR(cubic_spline(0.5f, 1.0f), 0.25 * top, 1e-6);
  for (double q = 0; q < 1; q += 0.05) {
    const double expected = q <= 0.5 ? 1 - 6 * q * q + 6 * q * q * q : 2 * std::pow(1 - q, 3);
    EXPECT_NEAR(cubic_spline(static_cast<float>(q), 1.0f), top * expected, 2e-6) << q;
  }
}

TEST(Wyvill, HasTheShapeOfTheSoftObject) {
  // One at the centre, one half at half the radius [Wyvill1990].
  EXPECT_NEAR(wyvill(0.5f, 1.0f) / wyvill(0.0f, 1.0f), 0.5f, 1e-6f);
}

TEST(PcaWeight, IsOneMinusTheCubeOfTheDistance) {
  EXPECT_EQ(pca_weight(0.0f, 3.0f), 1.0f);
  EXPECT_NEAR(pca_weight(1.5f, 3.0f), 0.875f, 1e-7f);
  EXPECT_EQ(pca_weight(3.0f, 3.0f), 0.0f);
  EXPECT_EQ(pca_weight(5.0f, 3.0f), 0.0f);
}

}  // namespace
}  // namespace meniscus::formulas
