#include "base/random.h"

#include <gtest/gtest.h>
#include <set>

namespace meniscus {
namespace {

// The first numbers of SplitMix64 from state 1234567, as its authors publish them.
TEST(Draws, AreSplitMix64) {
  Draws draws(1234567);
  EXPECT_EQ(draws.bits(), 6457827717110365317u);
  EXPECT_EQ(draws.bits(), 3203168211198807973u);
  EXPECT_EQ(draws.bits(), 9817491932198370423u);
  EXPECT_EQ(mixed(1234567), 6457827717110365317u);
}

TEST(Draws, AreUniformBetweenZeroAndOne) {
  Draws draws(1, 2);
  double sum = 0, squares = 0;
  const int count = 100000;
  for (int i = 0; i < count; ++i) {
    const double u = draws.uniform();
    ASSERT_GE(u, 0);
    ASSERT_LT(u, 1);
    sum += u;
    squares += u * u;
  }
  EXPECT_NEAR(sum / count, 0.5, 5 * std::sqrt(1.0 / 12 / count));
  EXPECT_NEAR(squares / count, 1.0 / 3, 5 * std::sqrt(4.0 / 45 / count));
}

TEST(Draws, AreNormalOfDeviationOne) {
  Draws draws(3, 4);
  double sum = 0, squares = 0, fourth = 0;
  const int count = 100000;
  int beyond = 0;
  for (int i = 0; i < count; ++i) {
    const double x = draws.normal();
    sum += x;
    squares += x * x;
    fourth += x * x * x * x;
    beyond += std::abs(x) > 1.959964;
  }
  EXPECT_NEAR(sum / count, 0, 5 / std::sqrt(count));
  EXPECT_NEAR(squares / count, 1, 5 * std::sqrt(2.0 / count));
  EXPECT_NEAR(fourth / count, 3, 5 * std::sqrt(96.0 / count));
  EXPECT_NEAR(beyond / double(count), 0.05, 5 * std::sqrt(0.05 * 0.95 / count));
}

TEST(Draws, DifferBySeedAndById) {
  std::set<std::uint64_t> first;
  for (std::uint64_t seed = 0; seed < 100; ++seed)
    for (std::uint64_t id = 0; id < 100; ++id) first.insert(Draws(seed, id).bits());
  EXPECT_EQ(first.size(), 10000u);
  EXPECT_EQ(Draws(7, 8).bits(), Draws(7, 8).bits());
}

}  // namespace
}  // namespace meniscus
