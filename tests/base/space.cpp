#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <limits>

#include "meniscus/base.h"

namespace meniscus {
namespace {

TEST(Axis, DirectionsAreTheUnitVectorsOfTheirNames) {
  EXPECT_EQ(direction_of(Axis::x), vec3(1, 0, 0));
  EXPECT_EQ(direction_of(Axis::y), vec3(0, 1, 0));
  EXPECT_EQ(direction_of(Axis::z), vec3(0, 0, 1));
  EXPECT_EQ(name_of(Axis::x), "x");
  EXPECT_EQ(name_of(Axis::y), "y");
  EXPECT_EQ(name_of(Axis::z), "z");
}

TEST(Bounds, AreEmptyUntilAPointIsAdded) {
  Bounds bounds;
  EXPECT_TRUE(bounds.empty());
  EXPECT_EQ(bounds.centre(), vec3(0));
  EXPECT_EQ(bounds.extent(), vec3(0));
  bounds.add(vec3{1, 2, 3});
  EXPECT_FALSE(bounds.empty());
  EXPECT_EQ(bounds.centre(), vec3(1, 2, 3));
  EXPECT_EQ(bounds.extent(), vec3(0));
}

TEST(Bounds, AreTheSmallestBoxOfTheirPoints) {
  Bounds bounds;
  bounds.add(vec3{1, -2, 5});
  bounds.add(vec3{-3, 4, 5});
  bounds.add(vec3{0, 0, 6});
  EXPECT_EQ(bounds.low, vec3(-3, -2, 5));
  EXPECT_EQ(bounds.high, vec3(1, 4, 6));
  EXPECT_EQ(bounds.centre(), vec3(-1, 1, 5.5f));
  EXPECT_EQ(bounds.extent(), vec3(4, 6, 1));
}

TEST(Bounds, OfABoxAndAnEmptyOneAreTheBox) {
  Bounds box;
  box.add(vec3{1, 2, 3});
  box.add(vec3{4, 5, 6});
  Bounds sum = box;
  sum.add(Bounds{});
  EXPECT_EQ(sum.low, box.low);
  EXPECT_EQ(sum.high, box.high);
  Bounds other;
  other.add(box);
  EXPECT_EQ(other.low, box.low);
  EXPECT_EQ(other.high, box.high);
}

TEST(Bounds, GrowOnEverySideButNotFromNothing) {
  Bounds box;
  box.add(vec3{0, 0, 0});
  box.add(vec3{2, 3, 4});
  EXPECT_EQ(box.grown(0.5f).low, vec3(-0.5f));
  EXPECT_EQ(box.grown(0.5f).high, vec3(2.5f, 3.5f, 4.5f));
  EXPECT_TRUE(Bounds{}.grown(10.0f).empty());
}

TEST(Bounds, OfHugeCoordinatesHaveAFiniteCentre) {
  const float huge = std::numeric_limits<float>::max();
  Bounds box;
  box.add(vec3{huge});
  box.add(vec3{0.5f * huge});
  EXPECT_FLOAT_EQ(box.centre().x, 0.75f * huge);
}

}  // namespace
}  // namespace meniscus
