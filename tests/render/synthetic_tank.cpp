#include <gtest/gtest.h>

#include <cmath>

#include "meniscus/render.h"

namespace meniscus {
namespace {

TEST(SyntheticTank, HasExactlyTheParticlesThatAreAskedFor) {
  for (const std::size_t count : {1u, 2u, 3u, 10u, 99u, 1000u, 12345u, 100000u}) {
    const Particles tank = synthetic_tank(count);
    EXPECT_EQ(tank.size(), count);
    EXPECT_EQ(tank.y.size(), count);
    EXPECT_EQ(tank.z.size(), count);
  }
  EXPECT_THROW(synthetic_tank(0), Error);
}

TEST(SyntheticTank, IsTheSameForTheSameSeedOnly) {
  const Particles a = synthetic_tank(5000, 3), b = synthetic_tank(5000, 3), c = synthetic_tank(5000, 4);
  EXPECT_EQ(a.x, b.x);
  EXPECT_EQ(a.y, b.y);
  EXPECT_NE(a.y, c.y);
}

TEST(SyntheticTank, IsAboutTwoByOneByTwoMetresOfWaterWithDropsAbove) {
  const Particles tank = synthetic_tank(50000);
  std::size_t in_water = 0, above = 0;
  for (const float y : tank.y) ++(y < 1.12f + *tank.spacing ? in_water : above);
  EXPECT_GT(above, 1000u);
  // The water's volume: what one particle stands for, times their number.
  EXPECT_NEAR(static_cast<double>(in_water) * std::pow(*tank.spacing, 3.0), 4.0, 0.05);
  const Bounds bounds = tank.bounds();
  EXPECT_NEAR(bounds.extent().x, 2, 0.2f);
  EXPECT_NEAR(bounds.extent().z, 2, 0.2f);
  EXPECT_LT(bounds.high.y, 2.2f);
}

TEST(SyntheticTank, TellsItsSpacingRight) {
  const Particles tank = synthetic_tank(50000);
  Particles nameless = tank;
  nameless.spacing.reset();
  EXPECT_NEAR(estimate_spacing(nameless).spacing, *tank.spacing, 0.1f * *tank.spacing);
}

}  // namespace
}  // namespace meniscus
