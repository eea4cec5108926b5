#include <gtest/gtest.h>
#include <cmath>

#include "image/short_number.h"
#include "image/text.h"
#include "meniscus/image.h"

namespace meniscus {
namespace {

constexpr Rgb8 kBackground{90, 120, 150};

const auto red_to_green = [](float t) { return vec3{1 - t, t, 0}; };

Image<Rgb8> with_legend(int width, int height, std::string_view title = "speed, m/s", float low = 0,
                        float high = 2.5f) {
  Image<Rgb8> picture(width, height, kBackground);
  draw_legend(picture, title, low, high, red_to_green);
  return picture;
}

struct Box {
  int left = 1 << 30, top = 1 << 30, right = -1, bottom = -1;
};

/// What of the picture has changed.
Box drawn(const Image<Rgb8>& picture) {
  Box box;
  for (int y = 0; y < picture.height(); ++y)
    for (int x = 0; x < picture.width(); ++x)
      if (picture(x, y) != kBackground)
        box = {std::min(box.left, x), std::min(box.top, y), std::max(box.right, x), std::max(box.bottom, y)};
  return box;
}

TEST(ShortNumber, HasThreeSignificantDigits) {
  EXPECT_EQ(short_number(0), "0");
  EXPECT_EQ(short_number(-0.0), "0");
  EXPECT_EQ(short_number(1), "1");
  EXPECT_EQ(short_number(1.5), "1.5");
  EXPECT_EQ(short_number(-3.14159), "-3.14");
  EXPECT_EQ(short_number(9.996), "10");
  EXPECT_EQ(short_number(0.0012345), "0.00123");
  EXPECT_EQ(short_number(1000), "1000");
  EXPECT_EQ(short_number(12345), "12300");
  EXPECT_EQ(short_number(99999), "1e5");
  EXPECT_EQ(short_number(1.2345e-7), "1.23e-7");
  EXPECT_EQ(short_number(-2.5e30), "-2.5e30");
  EXPECT_EQ(short_number(1000.5, 5), "1000.5");
  EXPECT_EQ(short_number(std::nan("")), "nan");
}

TEST(Legend, StandsInTheLowerRightCorner) {
  for (const auto& [width, height] :
       {std::pair{1920, 1080}, std::pair{640, 360}, std::pair{512, 512}, std::pair{300, 900}}) {
    const Box box = drawn(with_legend(width, height));
    EXPECT_GT(box.left, 0) << width;
    EXPECT_GT(box.top, height / 2) << width;
    EXPECT_LT(box.right, width - 1) << width;
    EXPECT_LT(box.bottom, height - 1) << width;
    EXPECT_GT(box.right, width - width / 20) << width;
    EXPECT_GT(box.bottom, height - height / 10) << width;
  }
}

TEST(Legend, GrowsWithThePicture) {
  const Box small = drawn(with_legend(640, 320)), large = drawn(with_legend(2560, 1280));
  EXPECT_NEAR(large.bottom - large.top + 1, 4 * (small.bottom - small.top + 1), 2);
}

TEST(Legend, ShowsTheColoursFromLowToHigh) {
  const Image<Rgb8> picture = with_legend(1280, 720);
  const Box box = drawn(picture);
  // Along the rows of the bar, red falls and green rises from pure red to pure green.
  int rows_of_bar = 0;
  for (int y = box.top; y <= box.bottom; ++y) {
    std::vector<Rgb8> bar;
    for (int x = box.left; x <= box.right; ++x)
      if (picture(x, y).b == 0) bar.push_back(picture(x, y));
    if (bar.size() < 100) continue;
    ++rows_of_bar;
    EXPECT_EQ(bar.front(), (Rgb8{255, 0, 0}));
    EXPECT_EQ(bar.back(), (Rgb8{0, 255, 0}));
    for (std::size_t i = 1; i < bar.size(); ++i) EXPECT_TRUE(bar[i].r <= bar[i - 1].r && bar[i].g >= bar[i - 1].g);
  }
  EXPECT_GE(rows_of_bar, 12);
}

TEST(Legend, ShowsItsValues) {
  // Other values, other letters; the same values, the same picture.
  const auto differs = [](const Image<Rgb8>& a, const Image<Rgb8>& b) { return compare(a, b).pixels_differing > 0; };
  EXPECT_FALSE(differs(with_legend(640, 360), with_legend(640, 360)));
  EXPECT_TRUE(differs(with_legend(640, 360), with_legend(640, 360, "speed, m/s", 0.1f, 2.4f)));
  EXPECT_TRUE(differs(with_legend(640, 360), with_legend(640, 360, "speed, m/z")));
  // Three digits cannot tell 1000 from 1001: more are taken.
  EXPECT_TRUE(differs(with_legend(640, 360, "p", 1000, 1001), with_legend(640, 360, "p", 1000, 1000)));
}

TEST(Legend, StaysInsideOfAnyPicture) {
  for (int width = 0; width < 260; width += width < 40 ? 1 : 13)
    for (int height = 0; height < 120; height += height < 40 ? 1 : 9) {
      const Image<Rgb8> picture =
          with_legend(width, height, "a title that is longer than most pictures are wide", -1.23e-10f, 4.56e20f);
      if (width > 8 && height > 16) {
        EXPECT_GT(drawn(picture).right, 0) << width << " x " << height;
      }
    }
}

TEST(Legend, TakesAnyTextAndAnyValues) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  std::string every_byte;
  for (int i = 0; i < 256; ++i) every_byte += static_cast<char>(i);
  Image<Rgb8> picture(4000, 300, kBackground);
  draw_legend(picture, every_byte, nan, infinity, red_to_green);
  draw_legend(picture, "", -infinity, infinity, [&](float) { return vec3{nan, infinity, -1}; });
  EXPECT_GT(drawn(picture).right, 0);
}

TEST(Text, DrawsEveryLetterInsideOfItsWidthAndLine) {
  for (char c = ' '; c <= '~'; ++c) {
    Image<Rgb8> picture(40, 30, kBackground);
    const std::string letter(1, c);
    draw_text(picture, letter, 10, 10, 1, Rgb8{255, 255, 255});
    const Box box = drawn(picture);
    if (c == ' ') {
      EXPECT_EQ(box.right, -1);
      continue;
    }
    EXPECT_GE(box.left, 10) << c;
    EXPECT_LT(box.right, 10 + text_width_units(letter)) << c;
    EXPECT_GE(box.top, 10) << c;
    EXPECT_LT(box.bottom, 10 + kLineUnits + 1) << c;
  }
}

TEST(Text, IsCutOffAtThePicturesEdges) {
  Image<Rgb8> picture(20, 12, kBackground);
  draw_text(picture, "Wave", -7, -3, 3, Rgb8{255, 255, 255});
  draw_text(picture, "Wave", 15, 9, 3, Rgb8{255, 255, 255});
  EXPECT_GT(drawn(picture).right, 0);
}

}  // namespace
}  // namespace meniscus
