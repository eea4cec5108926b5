#include <gtest/gtest.h>
#include <cmath>
#include <vector>

#include "meniscus/image.h"

namespace meniscus {
namespace {

TEST(Averaging, KeepsEqualSamplesExactly) {
  for (const vec3 value : {vec3{0.1f, 0.2f, 0.7f}, vec3{0.0f}, vec3{1e-20f}, vec3{3e38f, 1, 2}, vec3{-1, 0.5f, 0}}) {
    const std::vector<vec3> samples(7, value);
    EXPECT_EQ(averaged(samples), value);
  }
}

TEST(Averaging, OfNothingIsBlack) { EXPECT_EQ(averaged({}), vec3(0.0f)); }

TEST(Averaging, IsTheHarmonicallyWeightedMeanForGrey) {
  // Weights 1/2 and 1/4 for luma 1 and 3: (1/2 + 3/4) / (3/4).
  const std::vector<vec3> samples{vec3{1.0f}, vec3{3.0f}};
  EXPECT_FLOAT_EQ(averaged(samples).x, 5.0f / 3.0f);
}

TEST(Averaging, WeighsByTheLumaOfBt709) {
  // A green of 1 has luma 0.7152, black has weight 1.
  const std::vector<vec3> samples{vec3{0, 1, 0}, vec3{0.0f}};
  const double weight = 1 / 1.7152;
  EXPECT_NEAR(averaged(samples).y, weight / (weight + 1), 1e-6);
}

TEST(Averaging, KeepsTheStepsOfAnEdgeUnderTheSun) {
  // An edge between water (0.1) and the sun's glitter (1000) that covers 0 .. 8 of 8 samples: its steps on the
  // display must be alike. In the plain mean the first sample alone would already give white.
  std::vector<vec3> samples(8, vec3{0.1f});
  float last = tone_mapped(averaged(samples), {}).x;
  for (std::size_t covered = 0; covered < 4; ++covered) {
    samples[covered] = vec3{1000.0f};
    const float now = tone_mapped(averaged(samples), {}).x;
    EXPECT_GT(now - last, 0.03f) << covered;
    EXPECT_LT(now - last, 0.3f) << covered;
    last = now;
  }
}

TEST(Averaging, DoesNotSpreadNanOrInfinity) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  const std::vector<vec3> samples{vec3{0.5f}, vec3{nan, 0.5f, 0.5f}, vec3{infinity}, vec3{-infinity, 0, 0}};
  const vec3 mean = averaged(samples);
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(std::isfinite(mean[i])) << mean[i];
}

TEST(Downsampling, KeepsAConstantImage) {
  const vec3 value{0.3f, 12.7f, 0.001f};
  for (const int factor : {1, 2, 3}) {
    const Image<vec3> small = downsampled(Image<vec3>(12, 6, value), factor);
    EXPECT_EQ(small.width(), 12 / factor);
    EXPECT_EQ(small.height(), 6 / factor);
    for (const vec3 pixel : small) EXPECT_EQ(pixel, value);
  }
}

TEST(Downsampling, AveragesEachSquareAlone) {
  Image<vec3> picture(6, 4);
  for (std::size_t i = 0; i < picture.size(); ++i)
    picture[i] = vec3{static_cast<float>(i), 1, static_cast<float>(i * i)};
  const Image<vec3> small = downsampled(picture, 2);
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 3; ++x) {
      const std::vector<vec3> samples{picture(2 * x, 2 * y), picture(2 * x + 1, 2 * y), picture(2 * x, 2 * y + 1),
                                      picture(2 * x + 1, 2 * y + 1)};
      EXPECT_EQ(small(x, y), averaged(samples));
    }
}

TEST(Downsampling, RefusesWhatDoesNotDivide) {
  const Image<vec3> picture(6, 4);
  for (const int factor : {0, -1, 3, 4}) {
    try {
      downsampled(picture, factor);
      FAIL() << factor;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
    }
  }
}

}  // namespace
}  // namespace meniscus
