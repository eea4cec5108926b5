#include "particles/nearest.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "clouds.h"
#include "particles/morton.h"

namespace meniscus {
namespace {

using namespace clouds;

/// Squared distances to the nearest `count`, by looking at all.
std::vector<double> brute_force(const Particles& particles, glm::dvec3 point, std::size_t count) {
  std::vector<double> all;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const glm::dvec3 offset = glm::dvec3(particles.position(i)) - point;
    all.push_back(glm::dot(offset, offset));
  }
  count = std::min(all.size(), count);
  std::partial_sort(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count), all.end());
  all.resize(count);
  return all;
}

void expect_nearest(const Particles& particles, const Bounds& frame, std::size_t count) {
  const NearestIndex index(particles, frame, particles.size());
  ASSERT_EQ(index.size(), particles.size());
  for (const std::uint32_t query : index.sample(100)) {
    const std::vector<Neighbour> nearest = index.nearest(query, count);
    const std::vector<double> expected = brute_force(particles, glm::dvec3(index.position(query)), count);
    ASSERT_EQ(nearest.size(), expected.size());
    const double unit2 = index.unit() * index.unit();
    for (std::size_t i = 0; i < nearest.size(); ++i) {
      ASSERT_NEAR(nearest[i].distance2 * unit2, expected[i], 1e-5 * expected.back()) << i;
      ASSERT_NEAR(nearest[i].distance2, glm::dot(nearest[i].offset, nearest[i].offset), 1e-5 * nearest[i].distance2);
    }
  }
}

TEST(NearestIndex, FindsWhatBruteForceFinds) {
  const Particles clouds[] = {cubic(12, 12, 12),
                              flip_seeds(8, 8, 8),
                              tilted_sheet(30, 1),
                              cubic(1, 500, 1, 0.3),
                              splash(),
                              spray(3000, {0, 0, 0}, {1e-3, 1, 1000}),
                              cubic(3, 3, 3),
                              cubic(1, 1, 1)};
  for (const Particles& cloud : clouds) expect_nearest(cloud, cloud.bounds(), 40);
}

TEST(NearestIndex, IsExactForParticlesOutsideItsFrame) {
  const Particles cloud = flip_seeds(8, 8, 8);
  expect_nearest(cloud, {vec3(4), vec3(12)}, 40);
}

TEST(NearestIndex, HasNoAnswerWhereItWouldCostTooMuch) {
  const Particles cloud = joined(spray(50000, {}, {}), cubic(2, 1, 1));
  const NearestIndex index(cloud, cloud.bounds(), cloud.size());
  std::size_t answers = 0;
  for (const std::uint32_t query : index.sample(100)) answers += !index.nearest(query, 64).empty();
  EXPECT_EQ(answers, 0u);
}

TEST(NearestIndex, OfSomeBlocksAnswersOnlyWhereTheyAreWhole) {
  const Particles cloud = cubic(50, 50, 50, 0.2);
  const NearestIndex index(cloud, cloud.bounds(), 60000);
  EXPECT_LE(index.size(), 60000u);
  EXPECT_GT(index.size(), 20000u);
  std::size_t answers = 0;
  const std::vector<std::uint32_t> queries = index.sample(100);
  for (const std::uint32_t query : queries) {
    const std::vector<Neighbour> nearest = index.nearest(query, 40);
    if (nearest.empty()) continue;
    ++answers;
    const std::vector<double> expected = brute_force(cloud, glm::dvec3(index.position(query)), 40);
    for (std::size_t i = 0; i < 40; ++i) {
      ASSERT_NEAR(nearest[i].distance2 * index.unit() * index.unit(), expected[i], 1e-4 * expected.back());
    }
  }
  EXPECT_GT(answers, queries.size() / 3);
}

TEST(Morton, KeysOfACubeAreOneRun) {
  // The cells of an aligned cube of edge 4 are 64 consecutive numbers.
  std::vector<std::uint64_t> keys;
  for (std::uint64_t x = 8; x < 12; ++x) {
    for (std::uint64_t y = 4; y < 8; ++y) {
      for (std::uint64_t z = 100; z < 104; ++z) keys.push_back(morton_key(x, y, z));
    }
  }
  std::sort(keys.begin(), keys.end());
  for (std::size_t i = 0; i < keys.size(); ++i) EXPECT_EQ(keys[i], keys[0] + i);
  EXPECT_EQ(morton_key((1 << 21) - 1, (1 << 21) - 1, (1 << 21) - 1), (std::uint64_t{1} << 63) - 1);
}

TEST(Morton, SortIsThatOfTheStandardLibrary) {
  clouds::Random random(1);
  std::vector<Keyed> items;
  // All magnitudes, many equal keys, and many that agree in their upper bits only.
  for (std::uint32_t i = 0; i < 5000; ++i) {
    const std::uint64_t bits = random.bits();
    items.push_back({(i % 3 == 0 ? bits >> 1 : i % 3 == 1 ? bits % 50 : (std::uint64_t{7} << 40) + bits % 100000), i});
  }
  std::vector<Keyed> expected = items;
  std::stable_sort(expected.begin(), expected.end(), [](const Keyed& a, const Keyed& b) { return a.key < b.key; });
  sort_by_key(items);
  for (std::size_t i = 0; i < items.size(); ++i) {
    ASSERT_EQ(items[i].key, expected[i].key);
    ASSERT_EQ(items[i].index, expected[i].index);
  }
}

}  // namespace
}  // namespace meniscus
