/// The ground's water at rest; the hollows themselves: hollows.cpp.
#include <gtest/gtest.h>

#include "ground_scenes.h"
#include "sim/ground_constants.h"

namespace meniscus {
namespace {

using namespace test;

TEST(WaterAtRest, FillsABowlLevelByItsVolume) {
  WetGround ground(ground_from(40, 40, [](int i, int j) {
    const double x = i - 19.5, y = j - 19.5;
    return 1e-4 * (x * x + y * y);
  }));
  const double volume = 6e-4;
  for (int k = 0; k < 10; ++k) ground.add(20 + 40 * 20, volume / 10);
  ground.settle();
  // The level under which the bowl's cells hold this volume.
  double low = 0, high = 0.1;
  for (int k = 0; k < 100; ++k) {
    const double level = 0.5 * (low + high);
    double held = 0;
    for (std::size_t c = 0; c < ground.size(); ++c)
      if (level > static_cast<double>(ground.bed(c)) + kHeldFilm) held += level - static_cast<double>(ground.bed(c));
    (held * area_of(ground) < volume ? low : high) = level;
  }
  int puddle = 0;
  for (std::size_t c = 0; c < ground.size(); ++c) {
    if (ground.depth(c) <= kHeldFilm) continue;
    EXPECT_NEAR(level_of(ground, c), low, 1e-6);
    ++puddle;
  }
  EXPECT_GT(puddle, 100);
  EXPECT_EQ(ground.budget().drained, 0);
  EXPECT_LT(missing_part(ground), 1e-12);
}

TEST(WaterAtRest, LeavesAFilmOnASlope) {
  for (GroundMaterial material : {GroundMaterial::concrete, GroundMaterial::steel}) {
    WetGround ground(ground_from(
        30, 20, [](int i, int j) { return 0.001 * i + 0.0005 * j; }, material));
    ground.rain(0.003);
    ground.settle();
    for (std::size_t c = 0; c < ground.size(); ++c) {
      ASSERT_NEAR(ground.depth(c), kHeldFilm, 1e-15);
      ASSERT_EQ(ground.soaked(c), ground.capacity(c));
    }
    const double left = 0.003 - kHeldFilm - ground.capacity(0);
    EXPECT_NEAR(ground.budget().drained, left * 600 * area_of(ground), 1e-12);
  }
}

TEST(WaterAtRest, WetsItsWayDown) {
  WetGround ground(ground_from(
      12, 3, [](int i, int j) { return j == 1 ? 0.001 * i : 1.0; }, GroundMaterial::asphalt));
  const double held = ground.capacity(0) + kHeldFilm;
  ground.add(22, 4.5 * held * area_of(ground));  // on the channel's cell 10, a share of it on cell 9
  ground.settle();
  double all = 0;
  for (std::size_t i = 0; i < 12; ++i) all += ground.depth(12 + i) + ground.soaked(12 + i);
  EXPECT_NEAR(all, 4.5 * held, 1e-12);
  for (std::size_t i : {7, 8, 9}) {
    EXPECT_EQ(ground.soaked(12 + i), ground.capacity(0)) << i;
    EXPECT_NEAR(ground.depth(12 + i), kHeldFilm, 1e-12) << i;
  }
  for (std::size_t i : {0, 1, 2, 3, 4}) EXPECT_EQ(ground.soaked(12 + i), 0) << i;
}

TEST(WaterAtRest, IsWhatAnHourOfFlowComesTo) {
  // So much rain that all hollows spill: then it does not matter which way water goes. The last of it falls gently, so
  // that what has sloshed over the brims is there again.
  WetGround settled(rough_ground(16, 11)), flowing(rough_ground(16, 11));
  settled.rain(0.03);
  settled.settle();
  flowing.rain(0.02);
  flowing.flow(60);
  for (int k = 0; k < 100; ++k) {
    flowing.rain(1e-4);
    flowing.flow(2);
  }
  flowing.flow(3000);
  double deepest = 0;
  for (std::size_t c = 0; c < settled.size(); ++c) {
    EXPECT_NEAR(settled.depth(c), flowing.depth(c), 3e-5) << c;
    deepest = std::max(deepest, settled.depth(c));
  }
  EXPECT_GT(deepest, 0.003);
}

TEST(WaterAtRest, StaysAtRest) {
  WetGround ground(rough_ground(60, 5));
  ground.rain(0.004);
  ground.settle();
  WetGround later = ground;
  later.flow(20);
  for (std::size_t c = 0; c < ground.size(); ++c) ASSERT_NEAR(later.depth(c), ground.depth(c), 1e-9) << c;
  later = ground;
  later.settle();
  for (std::size_t c = 0; c < ground.size(); ++c) ASSERT_NEAR(later.depth(c), ground.depth(c), 1e-12) << c;
}

}  // namespace
}  // namespace meniscus
