/// Sheet flow over the ground.                                                                    [Bates2010]
#include <gtest/gtest.h>

#include <algorithm>

#include "ground_scenes.h"
#include "sim/ground_constants.h"

namespace meniscus {
namespace {

using namespace test;

GroundOptions bowl() {
  return ground_from(24, 24, [](int i, int j) {
    const double x = i - 11.5, y = j - 12.5;
    return 1.5e-4 * (x * x + y * y);
  });
}

/// Levels of the cells that hold more than a film: lowest and highest.
std::pair<double, double> levels(const WetGround& ground) {
  std::pair<double, double> range{1e9, -1e9};
  for (std::size_t c = 0; c < ground.size(); ++c) {
    if (ground.depth(c) <= kHeldFilm + 1e-6) continue;
    range.first = std::min(range.first, level_of(ground, c));
    range.second = std::max(range.second, level_of(ground, c));
  }
  return range;
}

TEST(SheetFlow, FillsABowlLevel) {
  WetGround ground(bowl());
  const std::size_t middle = 11 + 24 * 12;
  for (int k = 0; k < 400; ++k) {
    ground.add(middle, 100e-9);
    ground.flow(0.05);
  }
  ground.flow(600);
  const auto [low, high] = levels(ground);
  EXPECT_GT(ground.depth(middle), 0.005);
  EXPECT_LT(high - low, 1e-6);
  EXPECT_EQ(ground.budget().drained, 0);
  EXPECT_LT(missing_part(ground), 1e-12);
}

TEST(SheetFlow, DrainsASlopeButForItsFilm) {
  WetGround ground(ground_from(40, 20, [](int i, int) { return 0.0004 * i; }));
  ground.rain(0.002);
  ground.flow(900);
  for (std::size_t c = 0; c < ground.size(); ++c) {
    ASSERT_GE(ground.depth(c), kHeldFilm - 1e-12) << c;
    ASSERT_LE(ground.depth(c), 1.02 * kHeldFilm) << c;
  }
  const WaterBudget budget = ground.budget();
  EXPECT_NEAR(budget.drained / budget.fallen, 0.9, 0.002);
  EXPECT_LT(missing_part(ground), 1e-12);
}

TEST(SheetFlow, IsAsDeepOnASlopeAsItsFrictionTells) {
  // A channel between walls, fed at its upper end with q; on its way, before it falls over the border, gravity and
  // friction are equal:
  //   g S = K nu v / (8 h^2) + f v^2 / (8 h),  q = (h - film) v.
  for (const double q : {1e-5, 2e-4}) {
    const double slope = 0.01;
    WetGround ground(ground_from(60, 3, [&](int i, int j) { return j == 1 && i > 0 ? slope * 0.01 * (59 - i) : 1.0; }));
    for (int k = 0; k < 6'000; ++k) {
      ground.add(61, q * 0.01 * 0.01);
      ground.flow(0.01);
    }
    const GroundTraits& steel = traits_of(GroundMaterial::steel);
    double low = kHeldFilm, high = 0.1;
    for (int k = 0; k < 100; ++k) {
      const double h = 0.5 * (low + high), v = q / (h - kHeldFilm);
      const double drag = steel.resistance * 1e-6 * v / (8 * h * h) + steel.friction * v * v / (8 * h);
      (drag > 9.81 * slope ? low : high) = h;
    }
    for (std::size_t i = 10; i < 35; ++i) EXPECT_NEAR(ground.depth(60 + i) / low, 1, 0.01) << q << " " << i;
  }
}

TEST(SheetFlow, GoesOnAsFastAsShallowWaterWaves) {
  // A trough of water 20 mm deep, its left half raised by 0.4 mm: a front of half of that goes right at sqrt(g h).
  WetGround ground(ground_from(200, 3, [](int i, int j) { return j == 1 && i > 0 && i < 199 ? 0.0 : 1.0; }));
  for (std::size_t i = 1; i < 199; ++i) ground.add(200 + i, 0.02 * area_of(ground));
  ground.settle();
  for (std::size_t i = 1; i < 100; ++i) ground.add(200 + i, 0.0004 * area_of(ground));
  ground.flow(0.8);
  std::size_t front = 100;
  while (front < 200 && ground.depth(200 + front) > 0.0201) ++front;
  EXPECT_NEAR((static_cast<double>(front) - 100) * 0.01 / 0.8, std::sqrt(9.81 * 0.02), 0.03);
}

TEST(SheetFlow, DoesNotKnowOfTiles) {
  // Water let go on level ground spreads alike wherever that is.
  const GroundOptions plain = ground_from(160, 160, [](int, int) { return 0.0; });
  const auto spread = [&](std::size_t at_i, std::size_t at_j) {
    WetGround ground(plain);
    ground.flow(0.01);  // all is asleep
    for (int k = 0; k < 20; ++k) ground.add(at_i + 160 * at_j, 0.001 * area_of(ground));
    ground.flow(0.3);
    ground.add(at_i + 1 + 160 * at_j, 0.003 * area_of(ground));
    ground.flow(0.7);
    return ground;
  };
  const WetGround a = spread(80, 80), b = spread(95, 64), c = spread(63, 96);
  int wet = 0;
  for (std::size_t j = 40; j < 120; ++j)
    for (std::size_t i = 40; i < 120; ++i) {
      ASSERT_EQ(a.depth(i + 160 * j), b.depth(i + 15 + 160 * (j - 16))) << i << " " << j;
      ASSERT_EQ(a.depth(i + 160 * j), c.depth(i - 17 + 160 * (j + 16))) << i << " " << j;
      wet += a.depth(i + 160 * j) > 0;
    }
  EXPECT_GT(wet, 50);
}

TEST(SheetFlow, HasTheSameBitsOnAnyNumberOfThreads) {
  const auto rained = [](int threads) {
    const ThreadLimit limit(threads);
    WetGround ground(rough_ground(150));
    std::mt19937 random(9);
    std::uniform_int_distribution<std::size_t> cell(0, ground.size() - 1);
    for (int frame = 0; frame < 10; ++frame) {
      for (int k = 0; k < 2'000; ++k) ground.add(cell(random), 3e-8);
      ground.rain(1e-4);
      ground.flow(0.04);
      if (frame == 5) ground.settle();
    }
    return ground;
  };
  const WetGround one = rained(1);
  for (int threads : {2, 5}) {
    const WetGround more = rained(threads);
    for (std::size_t c = 0; c < one.size(); ++c) {
      ASSERT_EQ(one.bed(c), more.bed(c));
      ASSERT_EQ(one.depth(c), more.depth(c));
      ASSERT_EQ(one.soaked(c), more.soaked(c));
    }
    EXPECT_EQ(one.budget().drained, more.budget().drained);
  }
}

TEST(SheetFlow, EndsForAnyLengthOfTimeAndAnyDepth) {
  WetGround ground(bowl());
  ground.add(11 + 24 * 12, 5e-6);
  ground.flow(1e300);
  const auto [low, high] = levels(ground);
  EXPECT_LT(high - low, 1e-6);
  WetGround deep(rough_ground(30));
  deep.rain(900);
  deep.flow(0.05);
  for (std::size_t c = 0; c < deep.size(); ++c) {
    ASSERT_GE(deep.depth(c), 0);
    ASSERT_LE(deep.depth(c), 1800);
  }
  EXPECT_LT(missing_part(deep), 1e-9);
}

TEST(SheetFlow, SoaksIntoDryGroundThatItComesTo) {
  // A heap of steel in the middle of concrete.
  GroundOptions options = ground_from(9, 9, [](int i, int j) { return i == 4 && j == 4 ? 0.01 : 0.0; });
  options.materials = Image<GroundMaterial>(9, 9, GroundMaterial::concrete);
  options.materials(4, 4) = GroundMaterial::steel;
  WetGround ground(options);
  for (int k = 0; k < 40; ++k) {
    ground.add(40, 0.0001 * area_of(ground));
    ground.flow(1);
  }
  for (std::size_t c : {31, 39, 41, 49}) EXPECT_EQ(ground.soaked(c), ground.capacity(c)) << c;
  EXPECT_EQ(ground.depth(0), 0);
  EXPECT_LT(missing_part(ground), 1e-12);
}

}  // namespace
}  // namespace meniscus
