#include <gtest/gtest.h>

#include "meniscus/base.h"

namespace meniscus {
namespace {

TEST(Particles, FindAttributesByTheirWholeName) {
  Particles particles;
  particles.attributes = {{"density", 1, {1000.0f}}, {"velocity", 3, {1, 2, 3}}};
  ASSERT_NE(particles.find("velocity"), nullptr);
  EXPECT_EQ(particles.find("velocity")->components, 3);
  EXPECT_EQ(particles.find("velo"), nullptr);
  EXPECT_EQ(particles.find(""), nullptr);
}

TEST(Particles, BoundsHoldEveryParticleAndNothingMore) {
  Particles particles;
  EXPECT_TRUE(particles.empty());
  EXPECT_TRUE(particles.bounds().empty());
  particles.x = {1, -1, 0};
  particles.y = {5, 6, 7};
  particles.z = {0, 0, 2};
  EXPECT_EQ(particles.size(), 3u);
  EXPECT_EQ(particles.position(1), vec3(-1, 6, 0));
  EXPECT_EQ(particles.bounds().low, vec3(-1, 5, 0));
  EXPECT_EQ(particles.bounds().high, vec3(1, 7, 2));
}

}  // namespace
}  // namespace meniscus
