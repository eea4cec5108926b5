#include "particles/surroundings.h"

#include <gtest/gtest.h>

#include "clouds.h"

namespace meniscus {
namespace {

Moments moments_of(const Particles& particles) {
  Moments moments;
  for (std::size_t i = 0; i < particles.size(); ++i) moments.add(glm::dvec3(particles.position(i)));
  return moments;
}

TEST(Surroundings, OfAnyNumberOfParticlesInARowAreExact) {
  for (const int n : {2, 3, 5, 20, 64})
    EXPECT_NEAR(surroundings_of(moments_of(clouds::cubic(n, 1, 1))).spacing, 1, 1e-6) << n;
}

TEST(Surroundings, OfARowDoNotDependOnItsDirection) {
  const glm::dvec3 u = glm::normalize(glm::dvec3(1, -2, 3));
  const Particles row = clouds::moved(clouds::cubic(9, 1, 1), [&](glm::dvec3 p) { return p.x * u; });
  EXPECT_NEAR(surroundings_of(moments_of(row)).spacing, 1, 1e-5);
}

TEST(Surroundings, OfBoxesAreWithinThreeInAHundred) {
  for (const int layers : {1, 2, 3, 4, 6}) {
    EXPECT_NEAR(surroundings_of(moments_of(clouds::cubic(6, 6, layers))).spacing, 1, 0.03) << layers;
  }
}

TEST(Surroundings, OfHalfABallAreThoseOfAWholeOne) {
  Particles whole, half;
  clouds::add_drop(whole, {}, 3);
  for (std::size_t i = 0; i < whole.size(); ++i) {
    if (whole.y[i] <= 0) clouds::add(half, glm::dvec3(whole.position(i)));
  }
  EXPECT_NEAR(surroundings_of(moments_of(half)).spacing / surroundings_of(moments_of(whole)).spacing, 1, 0.03);
  EXPECT_NEAR(surroundings_of(moments_of(half)).dimension, 3, 0.1);
}

TEST(Surroundings, OfOneParticleOrOnePlaceAreUnknown) {
  EXPECT_EQ(surroundings_of(Moments{}).spacing, 0);
  EXPECT_EQ(surroundings_of(moments_of(clouds::cubic(1, 1, 1))).spacing, 0);
  EXPECT_EQ(surroundings_of(moments_of(clouds::spray(50, {}, {}))).spacing, 0);
}

TEST(Surroundings, EndAtAGap) {
  // A drop of 33 and, six away, another: 64 neighbours would be of both.
  Particles drops;
  clouds::add_drop(drops, {}, 2);
  std::vector<Neighbour> one, both;
  for (std::size_t i = 0; i < drops.size(); ++i) {
    const glm::dvec3 p(drops.position(i));
    both.push_back({p, glm::dot(p, p)});
    const glm::dvec3 q = p + glm::dvec3(12, 0, 0);
    both.push_back({q, glm::dot(q, q)});
  }
  std::sort(both.begin(), both.end(), [](const Neighbour& a, const Neighbour& b) { return a.distance2 < b.distance2; });
  one.assign(both.begin(), both.begin() + 33);
  EXPECT_EQ(surroundings_of(both).spacing, surroundings_of(one).spacing);
  EXPECT_NEAR(surroundings_of(both).spacing, 1, 0.05);
}

}  // namespace
}  // namespace meniscus
