#include <gtest/gtest.h>

#include "clouds.h"
#include "meniscus/particles.h"

namespace meniscus {
namespace {

using namespace clouds;

/// Indices of the particles to be kept, by looking at all pairs.
std::vector<std::size_t> brute_force(const Particles& particles, float radius, int neighbours) {
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    int count = 0;
    for (std::size_t j = 0; j < particles.size(); ++j) {
      const glm::dvec3 d = glm::dvec3(particles.position(i)) - glm::dvec3(particles.position(j));
      count += i != j && glm::dot(d, d) <= double{radius} * radius;
    }
    if (count >= neighbours) kept.push_back(i);
  }
  return kept;
}

/// Gives every particle its index as an attribute, to be found again.
Particles numbered(Particles particles) {
  Attribute index{"index", 1, {}}, pair{"pair", 2, {}};
  for (std::size_t i = 0; i < particles.size(); ++i) {
    index.values.push_back(static_cast<float>(i));
    pair.values.push_back(static_cast<float>(i) + 0.25f);
    pair.values.push_back(static_cast<float>(i) + 0.5f);
  }
  particles.attributes = {index, pair};
  return particles;
}

void expect_brute_force(const Particles& cloud, float radius, int neighbours) {
  const Particles particles = numbered(cloud);
  const std::vector<std::size_t> expected = brute_force(particles, radius, neighbours);
  const Particles found = without_isolated(particles, radius, neighbours);
  ASSERT_EQ(found.size(), expected.size()) << radius << " m, " << neighbours;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const auto index = static_cast<float>(expected[i]);
    ASSERT_EQ(found.position(i), particles.position(expected[i]));
    ASSERT_EQ(found.attributes[0].values[i], index);
    ASSERT_EQ(found.attributes[1].values[2 * i], index + 0.25f);
    ASSERT_EQ(found.attributes[1].values[2 * i + 1], index + 0.5f);
  }
}

TEST(WithoutIsolated, KeepsWhatBruteForceKeeps) {
  const Particles cloud = shuffled(joined(flip_seeds(5, 5, 5), spray(1000, {-10, -10, -10}, {20, 20, 20})), 1);
  for (const float radius : {0.3f, 1.0f, 2.5f}) {
    for (const int neighbours : {1, 2, 5, 30}) expect_brute_force(cloud, radius, neighbours);
  }
}

TEST(WithoutIsolated, CountsNeighboursAtExactlyTheRadius) {
  EXPECT_EQ(without_isolated(cubic(5, 5, 5), 1.0f, 6).size(), 27u);
  EXPECT_EQ(without_isolated(cubic(5, 5, 5), 1.0f, 3).size(), 125u);
  EXPECT_EQ(without_isolated(cubic(5, 5, 5), 1.0f, 7).size(), 0u);
}

TEST(WithoutIsolated, CountsParticlesInTheSamePlaceAsNeighbours) {
  const Particles twice = joined(cubic(4, 4, 4), cubic(4, 4, 4));
  EXPECT_EQ(without_isolated(twice, 0.0f, 1).size(), twice.size());
  EXPECT_EQ(without_isolated(twice, 0.0f, 2).size(), 0u);
}

TEST(WithoutIsolated, ManagesDomainsMuchWiderThanTheRadius) {
  // Dense cells of the radius would be 10^11 over the first and 10^30 over the second.
  expect_brute_force(joined(spray(500, {0, 0, 0}, {200, 200, 200}), spray(500, {100, 100, 100}, {100.2, 100.2, 100.2})),
                     0.025f, 3);
  expect_brute_force(joined(cubic(8, 8, 8), spray(3, {1e10, 1e10, 1e10}, {1e11, 1e11, 1e11})), 1.0f, 3);
}

TEST(WithoutIsolated, KeepsAllForNoNeighboursAndNoneForTooMany) {
  const Particles cloud = cubic(4, 4, 4);
  EXPECT_EQ(without_isolated(cloud, 1.0f, 0).size(), 64u);
  EXPECT_EQ(without_isolated(cloud, 100.0f, 63).size(), 64u);
  EXPECT_EQ(without_isolated(cloud, 100.0f, 64).size(), 0u);
  EXPECT_TRUE(without_isolated({}, 1.0f, 1).empty());
}

TEST(WithoutIsolated, KeepsWhatTheFileTold) {
  Particles cloud = cubic(4, 4, 4);
  cloud.time = 1.5;
  cloud.up = Axis::z;
  cloud.spacing = 0.5f;
  cloud.format = "xyz";
  cloud.dropped_non_finite = 7;
  cloud.notes = {"a note"};
  const Particles found = without_isolated(cloud, 1.0f, 6);
  EXPECT_EQ(found.time, cloud.time);
  EXPECT_EQ(found.up, cloud.up);
  EXPECT_EQ(found.spacing, cloud.spacing);
  EXPECT_EQ(found.format, cloud.format);
  EXPECT_EQ(found.dropped_non_finite, cloud.dropped_non_finite);
  EXPECT_EQ(found.notes, cloud.notes);
}

TEST(WithoutIsolated, RefusesARadiusThatIsNone) {
  for (const float radius : {-1.0f, std::nanf(""), std::numeric_limits<float>::infinity()}) {
    try {
      without_isolated(cubic(2, 2, 2), radius, 1);
      FAIL() << radius;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
    }
  }
}

}  // namespace
}  // namespace meniscus
