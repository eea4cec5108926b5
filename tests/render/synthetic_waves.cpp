#include "render/synthetic_waves.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

namespace meniscus {
namespace {

WavesOptions small_waves() {
  WavesOptions options;
  options.particles = 20000;
  options.size = {2.0f, 0.5f, 1.0f};
  options.height = 0.1f;
  return options;
}

TEST(SyntheticWaves, AreAboutAsManyParticlesAsAskedForInTheWholeTank) {
  const WavesOptions options = small_waves();
  const Particles water = synthetic_waves(options, 0);
  EXPECT_NEAR(static_cast<double>(water.size()), 20000, 1000);
  EXPECT_NEAR(static_cast<double>(water.size()) * std::pow(*water.spacing, 3.0), 1.0, 1e-4);
  EXPECT_EQ(water.up, Axis::y);
  EXPECT_EQ(water.time, 0.0);
}

TEST(SyntheticWaves, ObeyTheDispersionOfGravityWaves) {
  for (const StandingWave& w : standing_waves(small_waves())) {
    EXPECT_NEAR(w.omega * w.omega, 9.81 * w.k * std::tanh(w.k * 0.5), 1e-9);
    EXPECT_NEAR(w.k, std::hypot(w.kx, w.kz), 1e-12);
  }
}

TEST(SyntheticWaves, AreReflectedByTheWalls) {
  // Sines vanish at the walls: whole half waves fit into the tank.
  for (const StandingWave& w : standing_waves(small_waves())) {
    EXPECT_NEAR(std::sin(w.kx * 2.0), 0, 1e-9);
    EXPECT_NEAR(std::sin(w.kz * 1.0), 0, 1e-9);
    EXPECT_GT(w.k, 0);
  }
  for (const double time : {0.0, 0.37, 12.0}) {
    const Bounds bounds = synthetic_waves(small_waves(), time).bounds();
    EXPECT_GT(bounds.low.x, 0);
    EXPECT_LT(bounds.high.x, 2);
    EXPECT_GT(bounds.low.z, 0);
    EXPECT_LT(bounds.high.z, 1);
    EXPECT_GT(bounds.low.y, 0);
  }
}

TEST(SyntheticWaves, AreNeverHigherThanTheirHeight) {
  const auto waves = standing_waves(small_waves());
  double highest = 0;
  for (int i = 0; i < 20000; ++i)
    highest = std::max(highest, std::abs(waves_height(waves, i % 41 * 0.05, i % 21 * 0.05, i * 0.013)));
  EXPECT_LE(highest, 0.1);
  EXPECT_GT(highest, 0.03);
}

TEST(SyntheticWaves, HaveTheirTopParticlesAtTheClosedFormOfTheSurface) {
  // The highest layer lies half a layer below the surface, which moves as the surface does: its height over where it
  // is at rest is that of the waves there, less by what half a layer of depth takes (k d / 2 of each wave).
  const WavesOptions options = small_waves();
  const auto waves = standing_waves(options);
  WavesOptions still = options;
  still.height = 0;
  const Particles rest = synthetic_waves(still, 0);
  for (const double time : {0.0, 0.4, 3.3}) {
    const Particles water = synthetic_waves(options, time);
    std::size_t on_top = 0;
    double error2 = 0, height2 = 0;
    for (std::size_t i = 0; i < water.size(); ++i) {
      if (rest.y[i] < 0.5f - *water.spacing) continue;
      ++on_top;
      double expected = 0;
      for (const StandingWave& w : waves)
        expected += w.amplitude * std::sinh(w.k * rest.y[i]) / std::sinh(w.k * 0.5) * std::cos(w.kx * water.x[i]) *
                    std::cos(w.kz * water.z[i]) * std::cos(w.omega * time + w.phase);
      EXPECT_NEAR(water.y[i] - rest.y[i], expected, 1e-5);
      const double surface = waves_height(waves, water.x[i], water.z[i], time);
      error2 += std::pow(water.y[i] - rest.y[i] - surface, 2);
      height2 += surface * surface;
    }
    EXPECT_GT(on_top, 500u);
    EXPECT_LT(error2, 0.1 * height2);
  }
}

TEST(SyntheticWaves, KeepTheWatersVolume) {
  // The surface's mean over the tank stays at the still level, and no part of the water is squeezed: the determinant
  // of what eight neighbours of the lattice span is that at rest, within 1 % in the mean.
  const WavesOptions options = small_waves();
  const auto waves = standing_waves(options);
  WavesOptions still = options;
  still.height = 0;
  const Particles rest = synthetic_waves(still, 0);
  const double spacing = std::cbrt(1.0 / 20000);  // of the number asked for: a lattice of whole rows
  const auto nx = static_cast<std::size_t>(std::lround(2 / spacing));
  const auto nz = static_cast<std::size_t>(std::lround(1 / spacing));
  const auto ny = rest.size() / (nx * nz);
  ASSERT_EQ(nx * ny * nz, rest.size());
  const auto volume = [&](const Particles& p, std::size_t i) {
    const vec3 at = p.position(i);
    return glm::dot(glm::cross(p.position(i + nx * nz) - at, p.position(i + nx) - at), p.position(i + 1) - at);
  };
  for (const double time : {0.2, 1.7}) {
    double mean = 0;
    const int steps = 200;
    for (int j = 0; j < steps; ++j)
      for (int i = 0; i < steps; ++i) mean += waves_height(waves, (i + 0.5) * 2 / steps, (j + 0.5) / steps, time);
    EXPECT_LT(std::abs(mean / (steps * steps)), 0.01 * 0.5 * 0.01);

    const Particles water = synthetic_waves(options, time);
    double sum = 0, sum_rest = 0, squeezed2 = 0;
    std::size_t cells = 0;
    for (std::size_t y = 0; y + 1 < ny; ++y)
      for (std::size_t z = 0; z + 1 < nz; ++z)
        for (std::size_t x = 0; x + 1 < nx; ++x) {
          const std::size_t i = x + nx * (z + nz * y);
          const double now = volume(water, i), before = volume(rest, i);
          sum += now;
          sum_rest += before;
          squeezed2 += std::pow(now / before - 1, 2);
          ++cells;
        }
    EXPECT_NEAR(sum / sum_rest, 1, 0.01);
    EXPECT_LT(std::sqrt(squeezed2 / static_cast<double>(cells)), 0.05);
  }
}

TEST(SyntheticWaves, AreTheSameForTheSameArgumentsAndAnyThreads) {
  const Particles a = synthetic_waves(small_waves(), 1.5);
  const ThreadLimit one(1);
  const Particles b = synthetic_waves(small_waves(), 1.5);
  EXPECT_EQ(a.x, b.x);
  EXPECT_EQ(a.y, b.y);
  EXPECT_EQ(a.z, b.z);
  EXPECT_NE(a.y, synthetic_waves(small_waves(), 1.6).y);
}

TEST(SyntheticWaves, MoveEachParticleByItsVelocity) {
  const double step = 1e-3;
  const Particles before = synthetic_waves(small_waves(), 2 - step), now = synthetic_waves(small_waves(), 2),
                  after = synthetic_waves(small_waves(), 2 + step);
  const Attribute* velocity = now.find("velocity");
  ASSERT_TRUE(velocity);
  ASSERT_EQ(velocity->values.size(), 3 * now.size());
  float fastest = 0, worst = 0;
  for (std::size_t i = 0; i < now.size(); ++i) {
    const vec3 v(velocity->values[3 * i], velocity->values[3 * i + 1], velocity->values[3 * i + 2]);
    const vec3 moved = (after.position(i) - before.position(i)) / static_cast<float>(2 * step);
    fastest = std::max(fastest, glm::length(v));
    worst = std::max(worst, glm::length(v - moved));
  }
  EXPECT_GT(fastest, 0.05f);
  EXPECT_LT(worst, 2e-3f * fastest + 4e-4f);  // rounding of positions: 1e-7 m over 2e-3 s
}

TEST(SyntheticWaves, LieStillWithoutHeight) {
  WavesOptions options = small_waves();
  options.height = 0;
  EXPECT_EQ(synthetic_waves(options, 0).y, synthetic_waves(options, 5).y);
}

TEST(SyntheticWaves, RefuseWhatCannotBe) {
  const auto refused = [](auto change) {
    WavesOptions options = small_waves();
    change(options);
    try {
      synthetic_waves(options, 0);
    } catch (const Error& error) {
      return error.code() == ErrorCode::invalid_argument;
    }
    return false;
  };
  EXPECT_TRUE(refused([](WavesOptions& o) { o.particles = 0; }));
  EXPECT_TRUE(refused([](WavesOptions& o) { o.size.x = 0; }));
  EXPECT_TRUE(refused([](WavesOptions& o) { o.size.y = std::numeric_limits<float>::quiet_NaN(); }));
  EXPECT_TRUE(refused([](WavesOptions& o) { o.height = -0.1f; }));
  EXPECT_TRUE(refused([](WavesOptions& o) { o.height = 0.45f; }));                     // the floor would show
  EXPECT_TRUE(refused([](WavesOptions& o) { o.height = 0.3f, o.shortest = 0.01f; }));  // they would break
  EXPECT_TRUE(refused([](WavesOptions& o) { o.shortest = 1e-9f; }));
  EXPECT_FALSE(refused([](WavesOptions& o) { o.particles = 1; }));
  EXPECT_FALSE(refused([](WavesOptions& o) { o.shortest = 100; }));
}

}  // namespace
}  // namespace meniscus
