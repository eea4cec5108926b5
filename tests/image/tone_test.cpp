#include <gtest/gtest.h>
#include <array>
#include <cmath>

#include "meniscus/image.h"

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

TEST(FilmicCurve, LeavesMidGreyWhereItIs) { EXPECT_NEAR(tone_mapped(vec3{0.18f}, {}).x, 0.18f, 1e-4f); }

TEST(FilmicCurve, IsThePublishedFitOfTheScaledRadiance) {
  for (const double radiance : {0.001, 0.05, 0.18, 0.5, 1.0, 3.0, 9.0}) {
    const double x = 0.72317 * radiance;
    const double published = x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14);
    EXPECT_NEAR(tone_mapped(vec3{static_cast<float>(radiance)}, {}).y, published, 1e-6) << radiance;
  }
}

TEST(FilmicCurve, ReachesBlackAndWhite) {
  EXPECT_EQ(tone_mapped(vec3{0.0f}, {}).x, 0.0f);
  EXPECT_LT(tone_mapped(vec3{9.0f}, {}).x, 1.0f);
  EXPECT_EQ(tone_mapped(vec3{10.1f}, {}).x, 1.0f);
}

TEST(FilmicCurve, KeepsGreyGrey) {
  for (float radiance = 1e-4f; radiance < 100; radiance *= 1.1f) {
    const vec3 c = tone_mapped(vec3{radiance}, {});
    EXPECT_EQ(c.x, c.y);
    EXPECT_EQ(c.y, c.z);
  }
}

TEST(FilmicCurve, NeverDarkensAnyChannelWhenOneGrows) {
  const std::array<float, 9> levels{0, 0.01f, 0.2f, 0.45f, 0.6f, 1, 2.5f, 8, 40};
  for (const float r : levels)
    for (const float g : levels)
      for (const float b : levels)
        for (int channel = 0; channel < 3; ++channel) {
          const vec3 before{r, g, b};
          vec3 after = before;
          after[channel] = after[channel] * 1.05f + 0.01f;
          const vec3 low = tone_mapped(before, {}), high = tone_mapped(after, {});
          for (int i = 0; i < 3; ++i) EXPECT_GE(high[i], low[i] - 2e-7f) << r << ' ' << g << ' ' << b;
          if (low[channel] < 0.999f) {
            EXPECT_GT(high[channel], low[channel]) << r << ' ' << g << ' ' << b;
          }
        }
}

TEST(FilmicCurve, TakesBrightColoursTowardsWhiteAndLeavesDarkOnesAlone) {
  // A bright pure red would stay pure red with a curve on each channel alone.
  EXPECT_GT(tone_mapped({50, 0, 0}, {}).y, 0.5f);
  EXPECT_EQ(tone_mapped({0.4f, 0, 0}, {}).y, 0.0f);
}

TEST(ToneMapping, CountsExposureInStops) {
  const vec3 radiance{0.02f, 0.1f, 0.2f};
  const vec3 brighter = tone_mapped(radiance, {.exposure_ev = 2});
  const vec3 same = tone_mapped(4.0f * radiance, {});
  for (int i = 0; i < 3; ++i) EXPECT_FLOAT_EQ(brighter[i], same[i]);
}

TEST(ToneMapping, CutsOffWhereLinear) {
  const vec3 c = tone_mapped({0.25f, 1, 7}, {.curve = ToneCurve::linear});
  EXPECT_EQ(c, vec3(0.25f, 1, 1));
}

TEST(ToneMapping, TurnsWhatIsNoRadianceIntoBlackOrWhite) {
  for (const ToneCurve curve : {ToneCurve::filmic, ToneCurve::linear}) {
    const ToneOptions options{.curve = curve};
    EXPECT_EQ(tone_mapped({kNan, -1, -kInfinity}, options), vec3(0.0f));
    EXPECT_EQ(tone_mapped({kInfinity, kInfinity, kInfinity}, options), vec3(1.0f));
    EXPECT_EQ(tone_mapped(vec3{1e38f}, {.exposure_ev = 20, .curve = curve}), vec3(1.0f));
  }
}

TEST(Srgb, HasTheStandardsValues) {
  EXPECT_EQ(srgb_from_linear(0), 0.0f);
  EXPECT_EQ(srgb_from_linear(1), 1.0f);
  EXPECT_FLOAT_EQ(srgb_from_linear(0.002f), 0.02584f);
  EXPECT_NEAR(srgb_from_linear(0.2140411f), 0.5f, 1e-6f);  // ((0.5 + 0.055) / 1.055)^2.4
  EXPECT_NEAR(srgb_from_linear(0.18f), 0.46135613f, 1e-6f);
}

TEST(Srgb, ComesBackThroughItsInverse) {
  for (int i = 0; i <= 255; ++i) {
    const float encoded = static_cast<float>(i) / 255.0f;
    EXPECT_NEAR(srgb_from_linear(linear_from_srgb(encoded)), encoded, 1e-6f);
  }
}

TEST(Srgb, ClampsItsArguments) {
  EXPECT_EQ(srgb_from_linear(-1), 0.0f);
  EXPECT_EQ(srgb_from_linear(kInfinity), 1.0f);
  EXPECT_EQ(linear_from_srgb(2), 1.0f);
  EXPECT_EQ(linear_from_srgb(kNan), 0.0f);
}

TEST(Developing, KeepsPureBlackAndPureWhite) {
  const Image<Rgb8> black = developed(Image<vec3>(17, 9, vec3{0.0f}), {});
  for (const Rgb8 pixel : black) EXPECT_EQ(pixel, (Rgb8{0, 0, 0}));
  const Image<Rgb8> white = developed(Image<vec3>(17, 9, vec3{1.0f}), {.curve = ToneCurve::linear});
  for (const Rgb8 pixel : white) EXPECT_EQ(pixel, (Rgb8{255, 255, 255}));
}

TEST(Developing, DithersByLessThanAStepAndKeepsTheMean) {
  for (const float level : {100.0f, 100.25f, 100.5f, 180.8f}) {
    const vec3 radiance{linear_from_srgb(level / 255.0f)};
    double sum = 0;
    const Image<Rgb8> picture = developed(Image<vec3>(16, 16, radiance), {.curve = ToneCurve::linear});
    for (const Rgb8 pixel : picture) {
      EXPECT_LT(std::abs(pixel.g - level), 1.0f);
      EXPECT_EQ(pixel.r, pixel.g);
      EXPECT_EQ(pixel.g, pixel.b);
      sum += pixel.g;
    }
    EXPECT_NEAR(sum / 256, level, 1.0 / 64 + 1e-3) << level;
  }
}

TEST(Developing, SpreadsItsThresholdsEvenly) {
  // Of 64 levels within one step, each must lift a different number of the 64 pixels: all thresholds differ.
  std::array<int, 64> lifted{};
  for (int i = 0; i < 64; ++i) {
    const float level = 120.0f + (static_cast<float>(i) + 0.5f) / 64.0f - 0.004f;
    const Image<vec3> flat(8, 8, vec3{linear_from_srgb(level / 255.0f)});
    for (const Rgb8 pixel : developed(flat, {.curve = ToneCurve::linear}))
      lifted[static_cast<std::size_t>(i)] += pixel.g > 120;
  }
  for (std::size_t i = 1; i < 64; ++i) EXPECT_EQ(lifted[i], lifted[i - 1] + 1) << i;
}

TEST(Developing, GivesTheSameBitsForAnyNumberOfThreads) {
  Image<vec3> radiance(61, 47);
  for (std::size_t i = 0; i < radiance.size(); ++i) radiance[i] = vec3{static_cast<float>(i) * 1e-3f, 0.3f, 0.01f};
  const Image<Rgb8> many = developed(radiance, {});
  const ThreadLimit one(1);
  const Image<Rgb8> single = developed(radiance, {});
  EXPECT_TRUE(std::equal(many.begin(), many.end(), single.begin()));
}

/// Bayer's matrix by its recursion [Bayer1973]: M of twice the size is 4 M, 4 M + 2; 4 M + 3, 4 M + 1.
int bayer(int x, int y, int size) {
  if (size == 1) return 0;
  const int half = size / 2;
  const int quadrant[2][2] = {{0, 2}, {3, 1}};
  return 4 * bayer(x % half, y % half, half) + quadrant[y / half][x / half];
}

TEST(Developing, RoundsLikeThePlainCurve) {
  // Every threshold of the dither meets a fine sweep of brightness.
  constexpr int kWidth = 8 * 256, kHeight = 8 * 64;
  Image<vec3> radiance(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const int step = (y / 8) * (kWidth / 8) + x / 8;
      const float value = 1.02f * static_cast<float>(step) / static_cast<float>(kWidth / 8 * kHeight / 8);
      radiance(x, y) = vec3{value, value * value, 0.01f * value};
    }
  const Image<Rgb8> picture = developed(radiance, {.curve = ToneCurve::linear});
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const float offset = (static_cast<float>(bayer(x % 8, y % 8, 8)) + 0.5f) / 64.0f - 0.5f;
      const auto expected = [&](float value) {
        return static_cast<int>(std::floor(255.0f * srgb_from_linear(std::min(value, 1.0f)) + offset + 0.5f));
      };
      ASSERT_EQ(picture(x, y).r, expected(radiance(x, y).x)) << x << " " << y;
      ASSERT_EQ(picture(x, y).g, expected(radiance(x, y).y)) << x << " " << y;
      ASSERT_EQ(picture(x, y).b, expected(radiance(x, y).z)) << x << " " << y;
    }
}

}  // namespace
}  // namespace meniscus
