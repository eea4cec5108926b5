#include <gtest/gtest.h>
#include <cmath>

#include "meniscus/image.h"

namespace meniscus {
namespace {

/// Noise from a small generator of its own, so that it is the same everywhere.
Image<Rgb8> noise(int width, int height, std::uint32_t seed) {
  Image<Rgb8> picture(width, height);
  const auto next = [&] {
    seed = seed * 1664525u + 1013904223u;
    return static_cast<std::uint8_t>(seed >> 24);
  };
  for (Rgb8& pixel : picture) pixel = {next(), next(), next()};
  return picture;
}

double luma(Rgb8 c) { return 0.2126 * c.r + 0.7152 * c.g + 0.0722 * c.b; }

/// [Wang2004] as it is written: every window's means, variances and covariance by two passes over its pixels.
double ssim_by_definition(const Image<Rgb8>& a, const Image<Rgb8>& b) {
  const int across = std::min(11, a.width()), down = std::min(11, a.height());
  const auto weight = [&](int i, int j) {
    const double x = i - 0.5 * (across - 1), y = j - 0.5 * (down - 1);
    return std::exp(-(x * x + y * y) / (2 * 1.5 * 1.5));
  };
  double weights = 0;
  for (int j = 0; j < down; ++j)
    for (int i = 0; i < across; ++i) weights += weight(i, j);
  double sum = 0;
  int windows = 0;
  for (int y = 0; y + down <= a.height(); ++y)
    for (int x = 0; x + across <= a.width(); ++x, ++windows) {
      double mean_a = 0, mean_b = 0, variance_a = 0, variance_b = 0, covariance = 0;
      for (int j = 0; j < down; ++j)
        for (int i = 0; i < across; ++i) {
          mean_a += weight(i, j) / weights * luma(a(x + i, y + j));
          mean_b += weight(i, j) / weights * luma(b(x + i, y + j));
        }
      for (int j = 0; j < down; ++j)
        for (int i = 0; i < across; ++i) {
          const double w = weight(i, j) / weights;
          const double da = luma(a(x + i, y + j)) - mean_a, db = luma(b(x + i, y + j)) - mean_b;
          variance_a += w * da * da;
          variance_b += w * db * db;
          covariance += w * da * db;
        }
      const double c1 = 6.5025, c2 = 58.5225;
      sum += (2 * mean_a * mean_b + c1) * (2 * covariance + c2) /
             ((mean_a * mean_a + mean_b * mean_b + c1) * (variance_a + variance_b + c2));
    }
  return sum / windows;
}

TEST(Comparison, OfEqualPicturesIsPerfect) {
  const Image<Rgb8> picture = noise(40, 30, 1);
  const ImageDifference difference = compare(picture, picture);
  EXPECT_EQ(difference.psnr_db, std::numeric_limits<double>::infinity());
  EXPECT_NEAR(difference.ssim, 1, 1e-12);
  EXPECT_EQ(difference.max_difference, 0);
  EXPECT_EQ(difference.pixels_differing, 0u);
}

TEST(Comparison, CountsAndMeasuresSinglePixels) {
  Image<Rgb8> a(20, 10, Rgb8{50, 60, 70});
  Image<Rgb8> b = a;
  b(3, 4).g = 90;
  b(19, 9).b = 60;
  const ImageDifference difference = compare(a, b);
  EXPECT_EQ(difference.pixels_differing, 2u);
  EXPECT_EQ(difference.max_difference, 30);
  EXPECT_NEAR(difference.psnr_db, 10 * std::log10(255.0 * 255.0 / ((900.0 + 100.0) / 600.0)), 1e-9);
}

TEST(Psnr, OfBlackAndWhiteIsZero) {
  EXPECT_NEAR(compare(Image<Rgb8>(8, 8), Image<Rgb8>(8, 8, Rgb8{255, 255, 255})).psnr_db, 0, 1e-12);
}

TEST(Psnr, OfADifferenceOfOneEverywhereIs48Decibels) {
  EXPECT_NEAR(compare(Image<Rgb8>(8, 8), Image<Rgb8>(8, 8, Rgb8{1, 1, 1})).psnr_db, 48.1308036, 1e-6);
}

TEST(Ssim, OfFlatPicturesIsTheLuminanceTermAlone) {
  // No variance: (2 a b + C1) / (a^2 + b^2 + C1).
  const double expected = (2 * 100.0 * 150.0 + 6.5025) / (100.0 * 100.0 + 150.0 * 150.0 + 6.5025);
  EXPECT_NEAR(compare(Image<Rgb8>(20, 20, Rgb8{100, 100, 100}), Image<Rgb8>(20, 20, Rgb8{150, 150, 150})).ssim,
              expected, 1e-9);
}

TEST(Ssim, IsItsDefinition) {
  const Image<Rgb8> a = noise(37, 23, 3);
  Image<Rgb8> b = a;
  for (std::size_t i = 0; i < b.size(); i += 3) b[i] = {b[i].g, b[i].b, static_cast<std::uint8_t>(b[i].r / 2)};
  EXPECT_NEAR(compare(a, b).ssim, ssim_by_definition(a, b), 1e-10);
  EXPECT_LT(compare(a, b).ssim, 0.95);
  EXPECT_NEAR(compare(b, a).ssim, compare(a, b).ssim, 1e-12);
}

TEST(Ssim, TakesPicturesSmallerThanItsWindow) {
  for (const auto& [width, height] : {std::pair{1, 1}, std::pair{5, 30}, std::pair{30, 4}, std::pair{10, 11}}) {
    const Image<Rgb8> a = noise(width, height, 5), b = noise(width, height, 6);
    EXPECT_NEAR(compare(a, b).ssim, ssim_by_definition(a, b), 1e-10) << width << " x " << height;
  }
}

TEST(Ssim, IsNegativeForANegative) {
  Image<Rgb8> a(24, 24), b(24, 24);
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 24; ++x) {
      const std::uint8_t v = (x + y) % 2 ? 200 : 55;
      a(x, y) = {v, v, v};
      b(x, y) = {static_cast<std::uint8_t>(255 - v), static_cast<std::uint8_t>(255 - v),
                 static_cast<std::uint8_t>(255 - v)};
    }
  EXPECT_LT(compare(a, b).ssim, -0.9);
}

TEST(Comparison, GivesTheSameBitsForAnyNumberOfThreads) {
  const Image<Rgb8> a = noise(90, 70, 7), b = noise(90, 70, 8);
  const ImageDifference many = compare(a, b);
  const ThreadLimit one(1);
  const ImageDifference single = compare(a, b);
  EXPECT_EQ(many.ssim, single.ssim);
  EXPECT_EQ(many.psnr_db, single.psnr_db);
}

TEST(Comparison, RefusesDifferentSizesAndSaysThem) {
  try {
    compare(Image<Rgb8>(4, 5), Image<Rgb8>(5, 4));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
    EXPECT_NE(std::string(error.what()).find("4 x 5"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("5 x 4"), std::string::npos) << error.what();
  }
}

TEST(Comparison, TakesEmptyPictures) { EXPECT_EQ(compare({}, {}).ssim, 1); }

}  // namespace
}  // namespace meniscus
