#include <gtest/gtest.h>

#include "clouds.h"
#include "meniscus/particles.h"

namespace meniscus {
namespace {

using namespace clouds;

/// The particles with what was y along `axis`.
Particles with_up(const Particles& particles, Axis axis) {
  return moved(particles, [&](glm::dvec3 p) {
    return axis == Axis::x ? glm::dvec3(p.y, p.z, p.x) : axis == Axis::z ? glm::dvec3(p.z, p.x, p.y) : p;
  });
}

constexpr Axis kAxes[] = {Axis::x, Axis::y, Axis::z};

TEST(Up, IsWhatTheFileSays) {
  Particles particles = cubic(20, 4, 20);
  particles.up = Axis::x;
  EXPECT_EQ(estimate_up(particles).axis, Axis::x);
  EXPECT_NE(estimate_up(particles).reasoning.find("file"), std::string::npos);
}

TEST(Up, OfAPoolIsItsThinSide) {
  for (const Axis axis : kAxes) EXPECT_EQ(estimate_up(with_up(cubic(30, 8, 25, 0.3), axis)).axis, axis);
}

TEST(Up, OfAPoolWithASplashHigherThanItIsLongIsAcrossItsFloor) {
  const Particles tall =
      joined(cubic(30, 4, 30, 0.2), moved(cubic(4, 36, 4, 0.2), [](glm::dvec3 p) { return p + glm::dvec3(0, 18, 0); }));
  for (const Axis axis : kAxes) EXPECT_EQ(estimate_up(with_up(tall, axis)).axis, axis);
}

TEST(Up, OfABreakingDamIsNotTheWayThatItRuns) {
  // A wedge against the wall x = 0: both x and y have a sharp lower end and an upper end that is not.
  Particles wedge;
  for (int x = 0; x < 50; ++x) {
    for (int y = 0; y < 20 - 2 * x / 5; ++y) {
      for (int z = 0; z < 25; ++z) add(wedge, glm::dvec3(x, y, z));
    }
  }
  for (const Axis axis : kAxes) EXPECT_EQ(estimate_up(with_up(wedge, axis)).axis, axis);
}

TEST(Up, DoesNotMindAFewParticlesThatFlewAway) {
  const Particles cloud = joined(cubic(30, 8, 30, 0.3), spray(10, {0, 100, 0}, {1, 300, 1}));
  for (const Axis axis : kAxes) EXPECT_EQ(estimate_up(with_up(cloud, axis)).axis, axis);
}

TEST(Up, OfAPlaneOfParticlesLiesInIt) {
  // A simulation in two dimensions: a column beside shallow water.
  const Particles plane =
      joined(cubic(60, 6, 1), moved(cubic(10, 20, 1), [](glm::dvec3 p) { return p + glm::dvec3(-25, 13, 0); }));
  EXPECT_EQ(estimate_up(plane).axis, Axis::y);                                                                 // x, y
  EXPECT_EQ(estimate_up(moved(plane, [](glm::dvec3 p) { return glm::dvec3(p.x, p.z, p.y); })).axis, Axis::z);  // x, z
}

TEST(Up, IsYWhereNothingSaysOtherwise) {
  Particles drop;
  add_drop(drop, {}, 8);
  for (const Particles& cloud :
       {Particles{}, cubic(1, 1, 1), cubic(2, 1, 1), cubic(10, 10, 10), drop, flip_seeds(10, 10, 10)}) {
    EXPECT_EQ(estimate_up(cloud).axis, Axis::y) << cloud.size();
    EXPECT_NE(estimate_up(cloud).reasoning.find("nothing"), std::string::npos);
  }
}

}  // namespace
}  // namespace meniscus
