#include <gtest/gtest.h>

#include "clouds.h"
#include "meniscus/particles.h"

namespace meniscus {
namespace {

using namespace clouds;

void expect_same(const Bounds& a, const Bounds& b) {
  EXPECT_EQ(a.low, b.low);
  EXPECT_EQ(a.high, b.high);
}

TEST(RobustBounds, LeaveOutTheFewThatFlewFarAway) {
  const Particles body = cubic(20, 10, 20, 0.3);
  expect_same(robust_bounds(joined(body, spray(10, {50, 200, 50}, {90, 1e6, 90}))), body.bounds());
  expect_same(robust_bounds(joined(spray(4, {-1e30, 0, 0}, {-1e20, 0, 0}), body)), body.bounds());
}

TEST(RobustBounds, NeverCutACompactBody) {
  Particles drop;
  add_drop(drop, {}, 12);
  for (const Particles& body : {cubic(20, 20, 20), cubic(200, 3, 3), cubic(100, 1, 100), flip_seeds(9, 9, 9), drop,
                                splash(), cubic(1, 1, 1), cubic(2, 1, 1), spray(200, {0, 0, 0}, {1, 1, 100})}) {
    expect_same(robust_bounds(body), body.bounds());
  }
}

TEST(RobustBounds, KeepTheFewOfSmallClouds) {
  const Particles cloud = joined(cubic(3, 3, 3), spray(1, {100, 0, 0}, {101, 0, 0}));
  expect_same(robust_bounds(cloud), cloud.bounds());
}

TEST(RobustBounds, OfNothingAreEmptyAndOfOnePointAreThatPoint) {
  EXPECT_TRUE(robust_bounds({}).empty());
  const Bounds point = robust_bounds(spray(1000, {1, 2, 3}, {1, 2, 3}));
  EXPECT_EQ(point.low, vec3(1, 2, 3));
  EXPECT_EQ(point.high, vec3(1, 2, 3));
}

TEST(RobustBounds, OfNearlyAllInOnePointAreOfAll) {
  const Particles cloud = joined(spray(10000, {}, {}), spray(5, {1, 1, 1}, {2, 2, 2}));
  expect_same(robust_bounds(cloud), cloud.bounds());
}

}  // namespace
}  // namespace meniscus
