#include <gtest/gtest.h>

#include <numeric>

#include "meniscus/base.h"

namespace meniscus {
namespace {

TEST(Image, IsEmptyUntilItHasASize) {
  const Image<float> none;
  EXPECT_TRUE(none.empty());
  EXPECT_EQ(none.size(), 0u);
  EXPECT_EQ(none.begin(), none.end());
  EXPECT_TRUE(Image<float>(0, 5).empty());
}

TEST(Image, HoldsTheFillEverywhere) {
  const Image<int> image(4, 3, 7);
  EXPECT_EQ(image.width(), 4);
  EXPECT_EQ(image.height(), 3);
  EXPECT_EQ(std::accumulate(image.begin(), image.end(), 0), 4 * 3 * 7);
}

TEST(Image, StoresRowAfterRowFromTheTop) {
  Image<int> image(4, 3);
  std::iota(image.begin(), image.end(), 0);
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 4; ++x) {
      EXPECT_EQ(image(x, y), y * 4 + x);
      EXPECT_EQ(image.row(y)[x], y * 4 + x);
      EXPECT_EQ(image[static_cast<std::size_t>(y * 4 + x)], y * 4 + x);
    }
}

TEST(Image, WritingOnePixelChangesThatOneOnly) {
  Image<int> image(5, 4, 0);
  image(3, 2) = 1;
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 5; ++x) EXPECT_EQ(image(x, y), x == 3 && y == 2 ? 1 : 0) << x << ", " << y;
}

}  // namespace
}  // namespace meniscus
