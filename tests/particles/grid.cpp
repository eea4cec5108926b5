#include "particles/grid.h"

#include <gtest/gtest.h>
#include <cmath>
#include <random>

namespace meniscus {
namespace {

class Cloud {
 public:
  explicit Cloud(unsigned seed) : random_(seed) {}
  float between(float low, float high) {
    return low + (high - low) * static_cast<float>(static_cast<double>(random_()) * 0x1p-32);
  }
  void add(float x, float y, float z) {
    particles.x.push_back(x);
    particles.y.push_back(y);
    particles.z.push_back(z);
  }
  Cloud& uniform(int count, float low, float high) {
    for (int i = 0; i < count; ++i) {
      const float x = between(low, high), y = between(low, high), z = between(low, high);
      add(x, y, z);
    }
    return *this;
  }
  Particles particles;

 private:
  std::mt19937 random_;
};

/// Given indices of the particles nearer than `radius`, ascending.
std::vector<std::uint32_t> neighbours(const ParticleGrid& grid, vec3 at, float radius) {
  std::vector<std::uint32_t> found;
  grid.for_each_run(at - radius, at + radius, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const glm::dvec3 off = glm::dvec3(grid.position(i)) - glm::dvec3(at);
      if (off.x * off.x + off.y * off.y + off.z * off.z < static_cast<double>(radius) * radius)
        found.push_back(grid.given_index(i));
    }
  });
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<std::uint32_t> brute_force(const Particles& particles, vec3 at, float radius) {
  std::vector<std::uint32_t> found;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const glm::dvec3 off = glm::dvec3(particles.position(i)) - glm::dvec3(at);
    if (off.x * off.x + off.y * off.y + off.z * off.z < static_cast<double>(radius) * radius)
      found.push_back(static_cast<std::uint32_t>(i));
  }
  return found;
}

/// Searches around particles, around random points in and near the cloud, and far away.
void expect_brute_force(const Particles& particles, float cell, std::initializer_list<float> radii) {
  const ParticleGrid grid(particles, cell);
  ASSERT_EQ(grid.size(), particles.size());
  const Bounds box = particles.bounds().grown(1.5f * cell);
  Cloud random(99);
  std::size_t met = 0;
  for (const float radius : radii) {
    for (int i = 0; i < 60; ++i) {
      vec3 at{random.between(box.low.x, box.high.x), random.between(box.low.y, box.high.y),
              random.between(box.low.z, box.high.z)};
      if (i % 2 == 0) at = particles.position(static_cast<std::size_t>(i) * 7919 % particles.size());
      const auto expected = brute_force(particles, at, radius);
      met += expected.size();
      ASSERT_EQ(neighbours(grid, at, radius), expected) << at.x << " " << at.y << " " << at.z << ", radius " << radius;
    }
    EXPECT_TRUE(neighbours(grid, box.high + 100.0f * (vec3{cell} + box.extent()), radius).empty());
    EXPECT_TRUE(neighbours(grid, box.low - 100.0f * (vec3{cell} + box.extent()), radius).empty());
  }
  EXPECT_GT(met, 0u);  // else nothing was compared
}

/// Sorted by cell, and by given index within a cell; every particle once.
void expect_sorted(const Particles& particles, float cell) {
  const ParticleGrid grid(particles, cell);
  std::vector<bool> seen(particles.size(), false);
  std::size_t before = 0;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const std::uint32_t from = grid.given_index(i);
    ASSERT_LT(from, particles.size());
    ASSERT_FALSE(seen[from]);
    seen[from] = true;
    ASSERT_EQ(grid.position(i), particles.position(from));
    const auto box = grid.cells(grid.position(i), grid.position(i));
    ASSERT_EQ(box.x0, box.x1);
    const std::size_t key = grid.cell_index(box.x0, box.y0, box.z0);
    if (i > 0) {
      ASSERT_LE(before, key);
      if (before == key) {
        ASSERT_LT(grid.given_index(i - 1), from);
      }
    }
    before = key;
  }
}

TEST(ParticleGrid, FindsTheNeighboursThatBruteForceFinds) {
  expect_brute_force(Cloud(1).uniform(3000, 0, 1).particles, 0.1f, {0.05f, 0.1f, 0.15f, 0.31f});
}

TEST(ParticleGrid, FindsThemAmongNegativeCoordinates) {
  expect_brute_force(Cloud(2).uniform(2000, -7, 3).particles, 0.9f, {0.5f, 0.9f, 2.0f});
  expect_brute_force(Cloud(3).uniform(2000, -7, -6).particles, 0.09f, {0.09f, 0.2f});
}

TEST(ParticleGrid, FindsThemInClusters) {
  Cloud cloud(4);
  for (int cluster = 0; cluster < 30; ++cluster) {
    const vec3 at{cloud.between(0, 5), cloud.between(0, 5), cloud.between(0, 5)};
    for (int i = 0; i < 100; ++i)
      cloud.add(at.x + cloud.between(-0.02f, 0.02f), at.y + cloud.between(-0.02f, 0.02f),
                at.z + cloud.between(-0.02f, 0.02f));
  }
  expect_brute_force(cloud.particles, 0.1f, {0.01f, 0.1f, 0.3f});
}

TEST(ParticleGrid, FindsThemOnTheBordersOfCells) {
  Cloud cloud(5);
  for (int z = 0; z < 12; ++z)
    for (int y = 0; y < 12; ++y)
      for (int x = 0; x < 12; ++x)
        cloud.add(0.25f * static_cast<float>(x), 0.25f * static_cast<float>(y), 0.25f * static_cast<float>(z));
  expect_brute_force(cloud.particles, 0.25f, {0.2f, 0.25f, 0.2501f, 0.5f});
  expect_brute_force(cloud.particles, 0.5f, {0.25f, 0.5f, 0.51f});
  expect_brute_force(cloud.particles, 0.1f, {0.1f, 0.25f, 0.26f});
}

TEST(ParticleGrid, FindsThemInOneCell) {
  expect_brute_force(Cloud(6).uniform(500, 0, 1).particles, 4.0f, {0.2f, 4.0f});
}

TEST(ParticleGrid, FindsThemInAFlatSheetAndALine) {
  Cloud sheet(7), line(8);
  for (int i = 0; i < 1000; ++i) sheet.add(sheet.between(0, 1), 0.5f, sheet.between(0, 1));
  for (int i = 0; i < 300; ++i) line.add(0.1f, 0.2f, line.between(-1, 1));
  expect_brute_force(sheet.particles, 0.05f, {0.05f, 0.1f});
  expect_brute_force(line.particles, 0.05f, {0.05f, 0.1f});
}

TEST(ParticleGrid, HoldsOneParticle) {
  Cloud cloud(9);
  cloud.add(1, 2, 3);
  expect_brute_force(cloud.particles, 0.1f, {0.1f, 1.0f});
}

TEST(ParticleGrid, HoldsNone) {
  const ParticleGrid grid(Particles{}, 0.1f);
  EXPECT_EQ(grid.size(), 0u);
  EXPECT_TRUE(grid.bounds().empty());
  EXPECT_TRUE(neighbours(grid, vec3{0}, 1.0f).empty());
  EXPECT_GT(grid.x()[0], 1e15f);  // the padding may be read
}

TEST(ParticleGrid, KeepsManyParticlesInOnePoint) {
  Cloud cloud(10);
  for (int i = 0; i < 1000; ++i) cloud.add(0.3f, 0.3f, 0.3f);
  const ParticleGrid grid(cloud.particles, 0.1f);
  EXPECT_EQ(neighbours(grid, vec3{0.3f}, 0.1f).size(), 1000u);
  expect_sorted(cloud.particles, 0.1f);
}

TEST(ParticleGrid, FindsThemInASparseCloud) {
  const Particles particles = Cloud(11).uniform(4000, 0, 200).particles;
  const ParticleGrid grid(particles, 0.025f);
  EXPECT_FALSE(grid.dense());
  EXPECT_GT(grid.cell_count(), std::size_t{1} << 38);  // a table over all cells would take terabytes
  expect_brute_force(particles, 0.025f, {0.025f, 0.05f});
  Cloud pairs(12);
  pairs.uniform(300, 0, 200);
  for (std::size_t i = 0; i < 300; ++i)
    pairs.add(pairs.particles.x[i] + pairs.between(-0.02f, 0.02f), pairs.particles.y[i] + pairs.between(-0.02f, 0.02f),
              pairs.particles.z[i]);
  expect_brute_force(pairs.particles, 0.025f, {0.025f, 0.05f});
  expect_sorted(pairs.particles, 0.025f);
}

TEST(ParticleGrid, SortsByCellAndKeepsTheOrderWithin) {
  expect_sorted(Cloud(13).uniform(5000, -1, 1).particles, 0.2f);
  expect_sorted(Cloud(14).uniform(200'000, 0, 1).particles, 0.1f);  // several blocks
}

TEST(ParticleGrid, IsTheSameForAnyNumberOfThreads) {
  for (const float cell : {0.1f, 0.0001f}) {  // dense and sparse
    const Particles particles = Cloud(15).uniform(200'000, 0, 1).particles;
    std::vector<std::uint32_t> reference;
    for (const int threads : {1, 2, 5}) {
      const ThreadLimit limit(threads);
      const ParticleGrid grid(particles, cell);
      EXPECT_EQ(grid.dense(), cell > 0.01f);
      std::vector<std::uint32_t> order;
      for (std::size_t i = 0; i < grid.size(); ++i) order.push_back(grid.given_index(i));
      if (threads == 1)
        reference = order;
      else
        EXPECT_EQ(order, reference) << threads << " threads";
    }
  }
}

TEST(ParticleGrid, HasPaddingThatIsFarFromEverything) {
  const ParticleGrid grid(Cloud(16).uniform(37, -5, 5).particles, 0.5f);
  for (std::size_t i = grid.size(); i < grid.size() + ParticleGrid::kPadding; ++i) {
    const vec3 p = grid.position(i);
    const float distance2 = p.x * p.x + p.y * p.y + p.z * p.z;
    EXPECT_TRUE(std::isfinite(distance2));
    EXPECT_GT(distance2, 1e30f);
  }
}

TEST(ParticleGrid, RefusesCellsThatCannotSort) {
  const Particles particles = Cloud(17).uniform(10, 0, 1).particles;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const float cell : {0.0f, -1.0f, nan, 1e-39f, 1e-8f}) {
    try {
      const ParticleGrid grid(particles, cell);
      ADD_FAILURE() << "cells of " << cell << " m were accepted";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), cell == 1e-8f ? ErrorCode::limit_exceeded : ErrorCode::invalid_argument) << cell;
    }
  }
  EXPECT_NO_THROW(ParticleGrid(particles, 1e30f));
}

TEST(ParticleGrid, SaysHowWideAParticleThatFlewAwayMakesTheCloud) {
  Cloud cloud(18);
  cloud.uniform(10, 0, 1).add(1e30f, 0, 0);
  try {
    const ParticleGrid grid(cloud.particles, 0.1f);
    ADD_FAILURE() << "was accepted";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("1e+30 m"), std::string::npos) << error.what();
    EXPECT_FALSE(error.detail().advice.empty());
  }
}

}  // namespace
}  // namespace meniscus
