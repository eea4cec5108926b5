#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "sim/splash_cases.h"

namespace meniscus {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180;

double below(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }  // of the standard normal distribution
double bell(double x) { return std::exp(-0.5 * x * x) / std::sqrt(2 * kPi); }

/// Mean and variance of a normal distribution within [low, high].
std::array<double, 2> truncated(double mean, double sigma, double low, double high) {
  const double a = (low - mean) / sigma, b = (high - mean) / sigma, all = below(b) - below(a);
  const double shift = (bell(a) - bell(b)) / all;
  return {mean + sigma * shift, sigma * sigma * (1 + (a * bell(a) - b * bell(b)) / all - shift * shift)};
}

/// The same of whole numbers that are the nearest to such a one.
std::array<double, 2> truncated_numbers(double mean, double sigma, int fewest, int most) {
  double all = 0, first = 0, second = 0;
  for (int n = fewest; n <= most; ++n) {
    const double p = below((n + 0.5 - mean) / sigma) - below((n - 0.5 - mean) / sigma);
    all += p, first += p * n, second += p * n * n;
  }
  first /= all;
  return {first, second / all - first * first};
}

struct Sample {
  double count = 0, sum = 0, squares = 0, least = 1e30, most = -1e30;
  void add(double v) {
    ++count, sum += v, squares += v * v;
    least = std::min(least, v), most = std::max(most, v);
  }
  double mean() const { return sum / count; }
  double variance() const { return squares / count - mean() * mean(); }
};

/// Mean within five standard errors, variance within 3 %.
void expect_drawn_from(const Sample& sample, std::array<double, 2> expected, const std::string& what) {
  EXPECT_NEAR(sample.mean(), expected[0], 5 * std::sqrt(expected[1] / sample.count)) << what;
  EXPECT_NEAR(sample.variance(), expected[1], 0.03 * expected[1]) << what;
}

TEST(SplashKind, IsThatOfSection2AndTable1) {
  using enum SplashKind;
  const SplashKind expected[3][5] = {
      {none, none, scattering, scattering, crown_cone},        // concrete: dry, wet, 3, 5, 10 mm
      {none, scattering, scattering, scattering, crown_cone},  // asphalt
      {disk, scattering, scattering, scattering, crown_cone},  // steel
  };
  for (int m = 0; m < 3; ++m)
    for (int w = 0; w < 5; ++w) EXPECT_EQ(splash_kind(kMaterials[m], kWetnesses[w]), expected[m][w]) << m << " " << w;
  EXPECT_EQ(name_of(crown_cone), "crown_cone");
}

TEST(SplashRanges, AreThoseOfTable1OnAsphalt) {
  const auto expect = [](Wetness wetness, int fewest, int most, float low, float high, float slow, float fast) {
    for (const DropSize size : {DropSize::small, DropSize::medium, DropSize::large}) {
      const SplashRanges r = splash_ranges(GroundMaterial::asphalt, wetness, size);
      EXPECT_EQ(r.fewest, fewest);
      EXPECT_EQ(r.most, most);
      EXPECT_EQ(r.lowest_deg, low);
      EXPECT_EQ(r.highest_deg, high);
      EXPECT_EQ(r.slowest, slow);
      EXPECT_EQ(r.fastest, fast);
    }
  };
  expect(Wetness::wet, 1, 5, 1, 30, 0.1f, 1.0f);
  expect(Wetness::puddle_3mm, 4, 14, 1, 60, 0.15f, 1.5f);
  expect(Wetness::puddle_5mm, 12, 22, 1, 90, 0.2f, 2.0f);
  expect(Wetness::puddle_10mm, 1, 1, 90, 90, 0.1f, 2.0f);
}

TEST(SplashRanges, GrowWithSizeAndWithRoughnessWithinTheTable) {
  for (const Wetness wetness : {Wetness::puddle_3mm, Wetness::puddle_5mm}) {
    float last = 0;
    for (const DropSize size : {DropSize::small, DropSize::medium, DropSize::large}) {
      const SplashRanges asphalt = splash_ranges(GroundMaterial::asphalt, wetness, size);
      const SplashRanges concrete = splash_ranges(GroundMaterial::concrete, wetness, size);
      EXPECT_GT(asphalt.number_mean, concrete.number_mean);
      EXPECT_GT(asphalt.angle_mean_deg, concrete.angle_mean_deg);
      EXPECT_GT(asphalt.speed_mean, concrete.speed_mean);
      EXPECT_EQ(asphalt.most, concrete.most);
      EXPECT_GT(concrete.speed_mean, concrete.slowest);
      EXPECT_GT(asphalt.speed_mean, last);
      last = asphalt.speed_mean;
    }
  }
  EXPECT_THROW(splash_ranges(GroundMaterial::concrete, Wetness::wet, DropSize::small), Error);
  EXPECT_THROW(splash_ranges(GroundMaterial::steel, Wetness::dry, DropSize::small), Error);
  EXPECT_EQ(drop_size_of(0.0014f), DropSize::small);
  EXPECT_EQ(drop_size_of(0.0016f), DropSize::medium);
  EXPECT_EQ(drop_size_of(0.0031f), DropSize::large);
}

/// What 100,000 drops of three sizes do on one state of a cell.
struct CellSamples {
  struct BySize {
    Sample number, angle, speed;
  } sizes[3];
  bool kinds_agree = true;
};

CellSamples draw(GroundMaterial material, Wetness wetness) {
  CellSamples samples;
  std::vector<Droplet> droplets;
  for (std::uint64_t id = 0; id < 100'000; ++id) {
    auto& by = samples.sizes[id % 3];
    droplets.clear();
    const Splash splash = make_splash(impact_on(material, wetness, id, kDiameters[id % 3]), {}, droplets);
    samples.kinds_agree = samples.kinds_agree && splash.kind == splash_kind(material, wetness);
    std::size_t flying = 0;
    for (const Droplet& droplet : droplets) {
      if (!(droplet.radius > 0)) continue;  // of a crown
      ++flying;
      const double speed = glm::length(glm::dvec3(droplet.velocity));
      by.speed.add(speed);
      by.angle.add(std::asin(std::min(droplet.velocity.y / speed, 1.0)) / kDegree);
    }
    by.number.add(static_cast<double>(flying));
  }
  return samples;
}

TEST(Splashes, DrawNumberAngleAndSpeedFromNormalDistributionsWithinTable1) {
  std::array<CellSamples, 15> cells;
  // "Regardless of the material": see the next test.
  const auto is_crown_elsewhere = [](std::size_t i) {
    return kWetnesses[i % 5] == Wetness::puddle_10mm && kMaterials[i / 5] != GroundMaterial::asphalt;
  };
  parallel_for(cells.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (!is_crown_elsewhere(i)) cells[i] = draw(kMaterials[i / 5], kWetnesses[i % 5]);
  });
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (is_crown_elsewhere(i)) continue;
    const GroundMaterial material = kMaterials[i / 5];
    const Wetness wetness = kWetnesses[i % 5];
    const SplashKind kind = splash_kind(material, wetness);
    EXPECT_TRUE(cells[i].kinds_agree);
    for (int s = 0; s < 3; ++s) {
      const auto& by = cells[i].sizes[s];
      const std::string what = "cell " + std::to_string(i) + " size " + std::to_string(s);
      if (kind == SplashKind::none || kind == SplashKind::disk) {
        EXPECT_EQ(by.number.sum, 0) << what;
        continue;
      }
      const SplashRanges r = splash_ranges(material, wetness, static_cast<DropSize>(s));
      EXPECT_GE(by.number.least, r.fewest) << what;
      EXPECT_LE(by.number.most, r.most) << what;
      EXPECT_GE(by.angle.least, r.lowest_deg - (kind == SplashKind::crown_cone ? 0.05 : 1e-4)) << what;
      EXPECT_LE(by.angle.most, r.highest_deg + 1e-4) << what;
      EXPECT_GE(by.speed.least, r.slowest * (1 - 1e-6)) << what;
      EXPECT_LE(by.speed.most, r.fastest * (1 + 1e-6)) << what;
      expect_drawn_from(by.speed, truncated(r.speed_mean, r.speed_sigma, r.slowest, r.fastest), what + " speed");
      if (kind == SplashKind::crown_cone) continue;  // one drop, upright
      expect_drawn_from(by.number, truncated_numbers(r.number_mean, r.number_sigma, r.fewest, r.most),
                        what + " number");
      expect_drawn_from(by.angle, truncated(r.angle_mean_deg, r.angle_sigma_deg, r.lowest_deg, r.highest_deg),
                        what + " angle");
    }
  }
}

TEST(CrownCone, IsTheSameOnAllMaterials) {
  for (std::uint64_t id = 0; id < 1000; ++id) {
    const MadeSplash asphalt = made(impact_on(GroundMaterial::asphalt, Wetness::puddle_10mm, id, kDiameters[id % 3]));
    for (const GroundMaterial material : {GroundMaterial::concrete, GroundMaterial::steel}) {
      const MadeSplash other = made(impact_on(material, Wetness::puddle_10mm, id, kDiameters[id % 3]));
      EXPECT_EQ(other.splash.kind, SplashKind::crown_cone);
      ASSERT_EQ(other.droplets.size(), asphalt.droplets.size());
      for (std::size_t i = 0; i < other.droplets.size(); ++i)
        EXPECT_EQ(other.droplets[i].velocity, asphalt.droplets[i].velocity);
    }
  }
}

}  // namespace
}  // namespace meniscus
