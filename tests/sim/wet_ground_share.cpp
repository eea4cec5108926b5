/// How the water of a hit is shared.                                                     [Mizukami2013] 4.6.1, fig. 7
#include <gtest/gtest.h>

#include "ground_scenes.h"

namespace meniscus {
namespace {

using namespace test;

constexpr double kMilli = 1e-3;

/// Steel of 3 x 3 cells, the middle one `middle` mm high, left, right, near and far as given.
WetGround cross(float middle, float left, float right, float near, float far) {
  return WetGround(ground_of({{0, near / 1000, 0}, {left / 1000, middle / 1000, right / 1000}, {0, far / 1000, 0}}));
}

void hit(WetGround& ground, std::size_t cell, double depth) { ground.add(cell, depth * area_of(ground)); }

TEST(WaterOfAHit, IsSharedInFifthsBetweenEqualLevels) {
  WetGround ground = cross(0, 0, 0, 0, 0);
  hit(ground, 4, 1 * kMilli);
  for (std::size_t c : {4, 1, 3, 5, 7}) EXPECT_NEAR(ground.depth(c), 0.2 * kMilli, 1e-15) << c;
  for (std::size_t c : {0, 2, 6, 8}) EXPECT_EQ(ground.depth(c), 0) << c;
}

TEST(WaterOfAHit, IsSharedInThirdsBetweenTwoWalls) {
  // As in the paper: one dimension.                                                            [Mizukami2013] fig. 7 a
  WetGround ground(ground_of({{1, 1, 1, 1, 1}, {0, 0, 0, 0, 0}, {1, 1, 1, 1, 1}}));
  hit(ground, 7, 3 * kMilli);
  for (std::size_t c : {6, 7, 8}) EXPECT_NEAR(ground.depth(c), 1 * kMilli, 1e-15) << c;
  for (std::size_t c : {5, 9}) EXPECT_EQ(ground.depth(c), 0) << c;
}

TEST(WaterOfAHit, LeavesForBothNeighboursOfAHighCellBetweenTwoWalls) {
  // Fig. 7 b, step 2: half of the water each, D_h = 1 mm, H_0 = 4 mm > max(2.5, 1) + 1 mm.
  WetGround ground(ground_of({{1, 1, 1, 1, 1}, {0, 0.0025f, 0.004f, 0.001f, 0}, {1, 1, 1, 1, 1}}));
  hit(ground, 7, 2 * kMilli);
  EXPECT_EQ(ground.depth(7), 0);
  EXPECT_NEAR(ground.depth(6), 1 * kMilli, 1e-15);
  EXPECT_NEAR(ground.depth(8), 1 * kMilli, 1e-15);
}

TEST(WaterOfAHit, LevelsACellThatIsLittleHigherThanItsNeighboursBetweenTwoWalls) {
  // Step 3: H_0 = 4 mm < max(3.5, 1) + 1 mm; 2 mm come to the lowest alone, up to 3 mm.
  WetGround ground(ground_of({{1, 1, 1, 1, 1}, {0, 0.0035f, 0.004f, 0.001f, 0}, {1, 1, 1, 1, 1}}));
  hit(ground, 7, 2 * kMilli);
  EXPECT_EQ(ground.depth(7), 0);
  EXPECT_EQ(ground.depth(6), 0);
  EXPECT_NEAR(ground.depth(8), 2 * kMilli, 1e-15);
  // 5.5 mm more level all three: 3 + 3.5 + 4 + 5.5 = 16 mm, by D_h = 2.75 mm still step 3.
  hit(ground, 7, 5.5 * kMilli);
  const double level = 16.0 / 3 * kMilli;
  EXPECT_NEAR(ground.depth(7), level - 4 * kMilli, 1e-9);
  EXPECT_NEAR(ground.depth(6), level - 3.5 * kMilli, 1e-9);
  EXPECT_NEAR(ground.depth(8), level - 1 * kMilli, 1e-9);
}

TEST(WaterOfAHit, LeavesInQuartersForFourLowNeighbours) {
  WetGround ground = cross(5, 1, 2, 3, 4);  // 5 > 4 + 0.8
  hit(ground, 4, 3.2 * kMilli);
  EXPECT_EQ(ground.depth(4), 0);
  for (std::size_t c : {1, 3, 5, 7}) EXPECT_NEAR(ground.depth(c), 0.8 * kMilli, 1e-15) << c;
}

TEST(WaterOfAHit, FillsFourNeighboursFromTheLowestUp) {
  WetGround ground = cross(5, 1, 2, 3, 4);  // 5 < 4 + 1.1: 1 + 2 + 3 + 4.4 = 10.4 mm, over three cells
  hit(ground, 4, 4.4 * kMilli);
  const double level = 10.4 / 3;
  EXPECT_NEAR(ground.depth(3), (level - 1) * kMilli, 1e-9);
  EXPECT_NEAR(ground.depth(5), (level - 2) * kMilli, 1e-9);
  EXPECT_NEAR(ground.depth(1), (level - 3) * kMilli, 1e-9);
  EXPECT_EQ(ground.depth(7), 0);
  EXPECT_EQ(ground.depth(4), 0);
}

TEST(WaterOfAHit, GoesToLowerNeighboursOnlyAndNotToHigherOnes) {
  WetGround ground = cross(5, 1, 2, 5, 9);  // two are lower: a half each
  hit(ground, 4, 2 * kMilli);
  EXPECT_NEAR(ground.depth(3), 1 * kMilli, 1e-15);
  EXPECT_NEAR(ground.depth(5), 1 * kMilli, 1e-15);
  for (std::size_t c : {1, 4, 7}) EXPECT_EQ(ground.depth(c), 0) << c;
}

TEST(WaterOfAHit, StaysInAHoleUntilItIsFull) {
  WetGround ground = cross(0, 2, 2, 2, 4);
  hit(ground, 4, 1.5 * kMilli);
  EXPECT_NEAR(ground.depth(4), 1.5 * kMilli, 1e-15);
  for (std::size_t c : {1, 3, 5, 7}) EXPECT_EQ(ground.depth(c), 0) << c;
  hit(ground, 4, 1.5 * kMilli);  // 0.5 to the brim, 1 mm over four cells
  EXPECT_NEAR(ground.depth(4), 2.25 * kMilli, 1e-9);
  for (std::size_t c : {1, 3, 5}) EXPECT_NEAR(ground.depth(c), 0.25 * kMilli, 1e-9) << c;
  EXPECT_EQ(ground.depth(7), 0);
}

TEST(WaterOfAHit, RunsOverTheBorderWhereThatIsLevelOrDownhill) {
  // A lone cell: four neighbours outside, as high as its ground.
  WetGround lone(ground_of({{0}}));
  hit(lone, 0, 1 * kMilli);
  EXPECT_NEAR(lone.depth(0), 0.2 * kMilli, 1e-15);
  EXPECT_NEAR(lone.budget().drained, 0.8 * kMilli * area_of(lone), 1e-18);
  hit(lone, 0, 0.1 * kMilli);  // all four are lower by 0.2 mm > 0.025 mm
  EXPECT_NEAR(lone.depth(0), 0.2 * kMilli, 1e-15);
  // Over the edge of a plain: a fifth.
  WetGround plain(ground_of({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}));
  hit(plain, 3, 1 * kMilli);
  EXPECT_NEAR(plain.budget().drained, 0.2 * kMilli * area_of(plain), 1e-18);
  // Not where the land rises towards the border.
  WetGround inwards(ground_of({{3, 2, 0, 2, 3}}));
  hit(inwards, 0, 1 * kMilli);
  EXPECT_EQ(inwards.budget().drained, 0);
  EXPECT_NEAR(inwards.depth(1), 1 * kMilli, 1e-15);
}

TEST(WaterOfAHit, SoaksIntoDryNeighbours) {
  WetGround ground(ground_of({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}, GroundMaterial::concrete));
  hit(ground, 4, ground.capacity(4) + 1 * kMilli);
  EXPECT_NEAR(ground.depth(4), 0.2 * kMilli, 1e-12);
  for (std::size_t c : {1, 3, 5, 7}) {
    EXPECT_NEAR(ground.soaked(c), 0.2 * kMilli, 1e-12) << c;
    EXPECT_EQ(ground.depth(c), 0);
    EXPECT_EQ(ground.wetness(c), Wetness::dry);
  }
}

TEST(WaterOfAHit, IsSharedAlikeWhereverTheGroundLies) {
  // Turned by a quarter: the same numbers in other places.
  const auto f = [](int i, int j) { return 0.001 * ((7 * i + 5 * j * j) % 11); };
  WetGround ground(ground_from(6, 6, f)), turned(ground_from(6, 6, [&](int i, int j) { return f(j, i); }));
  for (std::size_t k = 0; k < 200; ++k) {
    const std::size_t i = (k * 5) % 6, j = (k * 7 + k / 6) % 6;
    hit(ground, i + 6 * j, 2 * kMilli);
    hit(turned, j + 6 * i, 2 * kMilli);
  }
  for (std::size_t j = 0; j < 6; ++j)
    for (std::size_t i = 0; i < 6; ++i)
      EXPECT_NEAR(ground.depth(i + 6 * j), turned.depth(j + 6 * i), 1e-12) << i << " " << j;
}

TEST(WaterOfAHit, IsNeitherMadeNorLost) {
  WetGround ground(rough_ground(60));
  std::mt19937 random(1);
  std::uniform_int_distribution<std::size_t> cell(0, ground.size() - 1);
  std::exponential_distribution<double> volume(1 / 4e-9);
  double fallen = 0;
  for (int k = 1; k <= 100'000; ++k) {
    const double v = volume(random);
    fallen += v;
    ground.add(cell(random), v);
    if (k % 5'000 == 0) ground.flow(0.5);
    if (k % 40'000 == 0) ground.settle();
    if (k % 30'000 == 0) {
      ground.rain(1e-5);
      fallen += 1e-5 * area_of(ground) * static_cast<double>(ground.size());
    }
  }
  const WaterBudget budget = ground.budget();
  EXPECT_NEAR(budget.fallen / fallen, 1, 1e-12);
  EXPECT_LT(missing_part(ground), 1e-9);
  EXPECT_GT(budget.soaked, 0);
  EXPECT_GT(budget.standing, 0);
  EXPECT_GT(budget.drained, 0);
  for (std::size_t c = 0; c < ground.size(); ++c) {
    ASSERT_GE(ground.depth(c), 0);
    ASSERT_LE(ground.soaked(c), ground.capacity(c));
  }
}

}  // namespace
}  // namespace meniscus
