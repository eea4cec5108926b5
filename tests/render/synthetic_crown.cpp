#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <map>
#include <tuple>

#include "meniscus/render.h"

namespace meniscus {
namespace {

/// What crown_view() sees of a crown of so many particles.
SurfaceBuffers seen(std::size_t count, int size) {
  const Particles crown = synthetic_crown(count);
  RaycastOptions options;
  options.spacing = *crown.spacing;
  options.want_thickness = false;
  return make_raycast_surface(crown, options)->see(crown_view(size, size));
}

TEST(SyntheticCrown, HasExactlyTheParticlesThatAreAskedFor) {
  for (const std::size_t count : {1000u, 1001u, 1013u, 1999u, 4096u, 12345u, 99999u, 100000u, 300007u}) {
    const Particles crown = synthetic_crown(count);
    EXPECT_EQ(crown.size(), count);
    EXPECT_EQ(crown.y.size(), count);
    EXPECT_EQ(crown.z.size(), count);
    // None is left at the place that memory is filled with.
    EXPECT_EQ(std::count(crown.y.begin(), crown.y.end(), 0.0f), 0) << count;
  }
  EXPECT_THROW(synthetic_crown(999), Error);
  EXPECT_THROW(synthetic_crown(0), Error);
}

TEST(SyntheticCrown, IsTheSameForTheSameSeedAndAnyNumberOfThreads) {
  const Particles a = synthetic_crown(20000, 3), c = synthetic_crown(20000, 4);
  EXPECT_NE(a.y, c.y);
  for (const int threads : {1, 2, 5}) {
    const ThreadLimit limit(threads);
    const Particles b = synthetic_crown(20000, 3);
    EXPECT_EQ(a.x, b.x);
    EXPECT_EQ(a.y, b.y);
    EXPECT_EQ(a.z, b.z);
  }
}

TEST(SyntheticCrown, TellsItsSpacingRight) {
  for (const std::size_t count : {20000u, 200000u}) {
    Particles crown = synthetic_crown(count);
    const float spacing = *crown.spacing;
    crown.spacing.reset();
    EXPECT_NEAR(estimate_spacing(crown).spacing, spacing, 0.1f * spacing);
  }
}

// Where pool, sheet, rim and drops meet, no water is put twice: a cell of three spacings holds 27 particles, and as
// many more as a displaced lattice, or a sheet of three layers that lies well in it, can bring.
TEST(SyntheticCrown, IsNowhereMuchDenserThanItsLattice) {
  const Particles crown = synthetic_crown(200000);
  const float cell = 3 * *crown.spacing;
  std::map<std::tuple<int, int, int>, int> cells;
  const auto index = [&](float at) { return static_cast<int>(std::floor(at / cell)); };
  for (std::size_t i = 0; i < crown.size(); ++i) ++cells[{index(crown.x[i]), index(crown.y[i]), index(crown.z[i])}];
  int most = 0;
  for (const auto& [place, particles] : cells) most = std::max(most, particles);
  EXPECT_LE(most, 36);
}

TEST(SyntheticCrown, HasTheSameShapeAtEveryCount) {
  const Particles coarse = synthetic_crown(30000), fine = synthetic_crown(500000);
  const Bounds a = coarse.bounds(), b = fine.bounds();
  const float tolerance = *coarse.spacing;
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(a.low[axis], b.low[axis], tolerance);
    EXPECT_NEAR(a.high[axis], b.high[axis], tolerance);
  }
  // Of the particles the same share stands above the pool, but for a sheet that must be three spacings thick.
  const auto volume = [](const Particles& crown) {
    return static_cast<double>(crown.size()) * std::pow(static_cast<double>(*crown.spacing), 3.0);
  };
  EXPECT_NEAR(volume(fine), 1.22, 0.03);
  EXPECT_NEAR(volume(coarse), 1.22, 0.22);
}

TEST(SyntheticCrown, IsSeenTheSameAtTwoCounts) {
  constexpr int kSize = 128;
  const SurfaceBuffers coarse = seen(150000, kSize), fine = seen(600000, kSize);
  int covered = 0, differently = 0;
  std::vector<float> errors;
  for (std::size_t i = 0; i < coarse.depth.size(); ++i) {
    const bool a = std::isfinite(coarse.depth[i]), b = std::isfinite(fine.depth[i]);
    covered += b;
    differently += a != b;
    if (a && b) errors.push_back(std::abs(coarse.depth[i] - fine.depth[i]));
  }
  // The sheet is three spacings thick in both, and so are what ends it and the smallest drops.
  EXPECT_LT(differently, 0.05 * kSize * kSize);
  // The pool, half of the picture, is seen where it is; the sheet within what it is thicker.
  const float coarser = std::cbrt(1.25f / 150000);
  std::sort(errors.begin(), errors.end());
  EXPECT_LT(errors[errors.size() / 2], 0.4f * coarser);
  EXPECT_LT(errors[errors.size() * 3 / 4], coarser);
  EXPECT_GT(covered, 0.56 * kSize * kSize);
  EXPECT_LT(covered, 0.62 * kSize * kSize);
}

TEST(CrownView, HasAllOfThePoolTheJetsAndTheDropsInSight) {
  const Particles crown = synthetic_crown(500000);
  constexpr int kSize = 1000;
  const View view = crown_view(kSize, kSize);
  vec3 low(kSize), high(0.0f);
  for (std::size_t i = 0; i < crown.size(); ++i) {
    const vec3 at = view.project({crown.x[i], crown.y[i], crown.z[i]});
    low = glm::min(low, at);
    high = glm::max(high, at);
  }
  EXPECT_GT(low.z, 0);
  for (int axis = 0; axis < 2; ++axis) {
    EXPECT_GT(low[axis], 0);
    EXPECT_LT(high[axis], kSize);
  }
  EXPECT_GT(high.x - low.x, 0.97f * kSize);  // and no smaller than need be
}

}  // namespace
}  // namespace meniscus
