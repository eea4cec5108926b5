#include <gtest/gtest.h>

#include <cmath>

#include "sim/splash_cases.h"

namespace meniscus {
namespace {

void expect_same(const std::vector<WaterPiece>& a, const std::vector<WaterPiece>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].kind, b[i].kind);
    EXPECT_EQ(a[i].from, b[i].from);
    EXPECT_EQ(a[i].to, b[i].to);
    EXPECT_EQ(a[i].radius, b[i].radius);
    EXPECT_EQ(a[i].opacity, b[i].opacity);
  }
}

void expect_same(const std::vector<Landing>& a, const std::vector<Landing>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].time, b[i].time);
    EXPECT_EQ(a[i].point, b[i].point);
    EXPECT_EQ(a[i].volume, b[i].volume);
  }
}

TEST(Splashes, AddedTogetherAreThoseAddedOneByOne) {
  const std::vector<Impact> impacts = all_kinds_of_impacts(700, 2);
  Splashes one_by_one({});
  std::vector<double> expected;
  for (const Impact& impact : impacts) expected.push_back(one_by_one.add(impact));
  for (const int threads : {1, 2, 5}) {
    const ThreadLimit limit(threads);
    Splashes together({});
    std::vector<double> flies(impacts.size(), -1.0);
    // In two goes, so that the second stands behind something.
    together.add(std::span(impacts).first(100), std::span(flies).first(100));
    together.add(std::span(impacts).subspan(100), std::span(flies).subspan(100));
    EXPECT_EQ(flies, expected);
    EXPECT_EQ(together.size(), one_by_one.size());
    EXPECT_EQ(together.droplets(), one_by_one.droplets());
    std::vector<WaterPiece> some, all;
    together.pieces(0, nullptr, some);
    one_by_one.pieces(0, nullptr, all);
    EXPECT_GT(all.size(), 100u);
    expect_same(some, all);
    EXPECT_GT(one_by_one.landings(-1, 1).size(), 1000u);
    expect_same(together.landings(-1, 1), one_by_one.landings(-1, 1));
  }
}

TEST(Splashes, AreNotAddedWhenOneOfThemIsBad) {
  std::vector<Impact> impacts = all_kinds_of_impacts(200, 1);
  impacts.back().velocity.x = std::nanf("");
  std::vector<double> flies(impacts.size());
  Splashes splashes({});
  EXPECT_THROW(splashes.add(impacts, flies), Error);
  EXPECT_EQ(splashes.size(), 0u);
  EXPECT_EQ(splashes.droplets(), 0u);
  impacts.pop_back();
  EXPECT_THROW(splashes.add(impacts, flies), Error);  // one number too many
  splashes.add({}, {});
  EXPECT_EQ(splashes.size(), 0u);
}

// More of them than one piece of parallel work looks through.
TEST(Splashes, LandInOrderOfTimeHoweverManyThereAre) {
  const std::vector<Impact> impacts = all_kinds_of_impacts(9000, 2);
  Splashes splashes({});
  std::vector<double> flies(impacts.size());
  splashes.add(impacts, flies);
  const std::vector<Landing> landings = splashes.landings(-2, 60);
  double volume = 0, all = 0, before = -2;
  for (const Landing& landing : landings) {
    EXPECT_GE(landing.time, before);
    before = landing.time;
    volume += landing.volume;
  }
  for (const double one : flies) all += one;
  EXPECT_NEAR(volume, all, 1e-9 * all);
}

}  // namespace
}  // namespace meniscus
