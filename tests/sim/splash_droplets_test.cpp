#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <span>

#include "meniscus/formulas/rain.h"
#include "sim/splash_cases.h"

namespace meniscus {
namespace {

struct Mean {
  glm::dvec3 velocity{0.0}, landing{0.0};
  double droplets = 0;
};

/// Over 100,000 splashes on wet asphalt.
Mean mean_of(vec3 velocity, vec3 wind, vec3 normal = vec3(0, 1, 0)) {
  Mean mean;
  std::vector<Droplet> droplets;
  for (std::uint64_t id = 0; id < 100'000; ++id) {
    Impact impact = impact_on(GroundMaterial::asphalt, Wetness::wet, id);
    impact.velocity = velocity;
    impact.wind = wind;
    impact.normal = normal;
    droplets.clear();
    make_splash(impact, {}, droplets);
    for (const Droplet& d : droplets) {
      mean.velocity += glm::dvec3(d.velocity);
      mean.landing += glm::dvec3(formulas::orbit_offset(d.velocity, wind, SplashOptions{}.gravity, d.drag, d.lands));
      ++mean.droplets;
    }
  }
  mean.velocity /= mean.droplets;
  mean.landing /= mean.droplets;
  return mean;
}

const Mean& upright() {
  static const Mean mean = mean_of({0, -6.5f, 0}, vec3(0.0f));
  return mean;
}

// 300,000 droplets of up to 1 m/s: a standard error below 0.001 m/s and, at 0.05 m of way, 0.0001 m.
TEST(Splashes, OfUprightDropsGoNowhereOnTheMean) {
  const Mean& mean = upright();
  EXPECT_NEAR(mean.velocity.x, 0, 0.003);
  EXPECT_NEAR(mean.velocity.z, 0, 0.003);
  EXPECT_NEAR(mean.landing.x, 0, 0.0005);
  EXPECT_NEAR(mean.landing.z, 0, 0.0005);
}

TEST(Splashes, TakeOverTheStatedPartOfTheDropsVelocityAlongTheGround) {
  const Mean mean = mean_of({3, -6.5f, -2}, vec3(0.0f));
  EXPECT_NEAR(mean.velocity.x, kCarried * 3, 0.003);
  EXPECT_NEAR(mean.velocity.z, kCarried * -2, 0.003);
  EXPECT_GT(mean.landing.x, 0.01);
  EXPECT_NEAR(mean.landing.z / mean.landing.x, -2.0 / 3, 0.03);
  EXPECT_NEAR(mean.velocity.y, upright().velocity.y, 1e-6);  // and nothing else
}

TEST(Splashes, AreBlownByTheWindOnlyOnceTheyFly) {
  const Mean still = upright(), blown = mean_of({0, -6.5f, 0}, {5, 0, 0});
  EXPECT_NEAR(blown.velocity.x, still.velocity.x, 1e-9);
  EXPECT_GT(blown.landing.x, 0.002);
  EXPECT_NEAR(blown.landing.z, 0, 0.0005);
}

TEST(Splashes, StandOnWhatIsHitWhateverItsSlope) {
  const vec3 slope = glm::normalize(vec3(0.5f, 1, 0.2f)), velocity(0.5f, -6, 0);
  const Mean mean = mean_of(velocity, vec3(0.0f), slope);
  const glm::dvec3 along = glm::dvec3(velocity - slope * glm::dot(velocity, slope)) * static_cast<double>(kCarried);
  const double away = glm::dot(mean.velocity, glm::dvec3(slope));
  EXPECT_NEAR(away, upright().velocity.y, 1e-5);
  EXPECT_NEAR(glm::distance(mean.velocity - glm::dvec3(slope) * away, along), 0, 0.004);
}

TEST(Splashes, LetNothingFlyIntoTheSurface) {
  for (Impact impact : all_kinds_of_impacts(3000, 1)) {
    if (impact.id % 3 == 0) impact.normal = {1, 0, 0.2f};   // walls
    if (impact.id % 3 == 1) impact.normal = {0.1f, -1, 0};  // from below
    impact.normal = glm::normalize(impact.normal);
    const MadeSplash m = made(impact);
    for (const Droplet& d : m.droplets) {
      EXPECT_GT(glm::dot(d.velocity, impact.normal), 0);
      EXPECT_NEAR(glm::dot(d.start - impact.point, impact.normal), 0, 1e-6f);
      // Until it lands, no sooner.
      for (int i = 1; i < 10 && d.radius > 0 && m.splash.kind == SplashKind::scattering; ++i) {
        const vec3 way = formulas::orbit_offset(d.velocity, impact.wind, SplashOptions{}.gravity, d.drag,
                                                0.1f * static_cast<float>(i) * d.lands);
        EXPECT_GT(glm::dot(way, impact.normal), 0);
      }
    }
  }
}

TEST(Splashes, StandPilesEvenlyOnTheInitialCircle) {
  for (std::uint64_t id = 0; id < 200; ++id) {
    const MadeSplash m = made(impact_on(GroundMaterial::concrete, Wetness::puddle_5mm, id));
    std::vector<double> angles;
    for (const Droplet& d : m.droplets) {
      EXPECT_NEAR(glm::length(d.start), m.splash.circle, 1e-7f);
      EXPECT_LE(2 * m.splash.width, 2 * 3.15f * m.splash.circle / static_cast<float>(m.droplets.size()));  // room
      angles.push_back(std::atan2(d.start.z, d.start.x));
    }
    std::sort(angles.begin(), angles.end());
    const double between = 2 * 3.14159265358979 / static_cast<double>(angles.size());
    for (std::size_t i = 1; i < angles.size(); ++i) EXPECT_NEAR(angles[i] - angles[i - 1], between, 1e-4);
  }
}

TEST(Splashes, HaveWiderCirclesForLargerDropsAndDeeperWater) {
  float last = 0;
  for (const Wetness wetness : {Wetness::wet, Wetness::puddle_3mm, Wetness::puddle_5mm, Wetness::puddle_10mm}) {
    const float circle = made(impact_on(GroundMaterial::asphalt, wetness)).splash.circle;
    EXPECT_GT(circle, last);
    EXPECT_GT(made(impact_on(GroundMaterial::asphalt, wetness, 1, 0.004f)).splash.circle, circle);
    last = circle;
  }
}

TEST(Splashes, FlyWithTheStatedShareOfTheDrop) {
  for (const Wetness wetness : {Wetness::wet, Wetness::puddle_3mm, Wetness::puddle_5mm, Wetness::puddle_10mm})
    for (const float diameter : kDiameters) {
      Splashes splashes({});
      const Impact impact = impact_on(GroundMaterial::asphalt, wetness, 5, diameter);
      const double drop = 3.14159265358979 / 6 * std::pow(static_cast<double>(diameter), 3);
      const double flying = splashes.add(impact);
      EXPECT_NEAR(flying / drop, flying_share(splash_kind(impact.material, wetness), wetness), 1e-6);
      EXPECT_GT(flying, 0);
      double sum = 0;
      for (const Droplet& d : made(impact).droplets) sum += volume_of(d);
      EXPECT_NEAR(sum / flying, 1, 1e-12);
    }
}

TEST(Splashes, LetPilesGoAfterAUnitTimeOrLength) {
  SplashOptions options;
  options.growth_time = 0.02f;
  options.growth_length = 0.01f;
  int by_time = 0, by_length = 0, by_landing = 0;
  for (std::uint64_t id = 0; id < 300; ++id)
    for (const Droplet& d : made(impact_on(GroundMaterial::asphalt, Wetness::wet, id), options).droplets) {
      const float gone = glm::length(formulas::orbit_offset(d.velocity, vec3(0.0f), options.gravity, d.drag, d.leaves));
      EXPECT_LE(gone, 0.010001f);
      EXPECT_LE(d.leaves, 0.02f);
      if (d.leaves == d.lands)
        ++by_landing;
      else if (d.leaves == 0.02f)
        ++by_time;
      else {
        ++by_length;
        EXPECT_NEAR(gone, 0.01f, 1e-6f);
      }
    }
  EXPECT_GT(by_time, 0);
  EXPECT_GT(by_length, 0);
  EXPECT_GT(by_landing, 0);
}

TEST(CrownCone, LetsOneDropGoAtTheTopThatMovesUprightOnly) {
  for (std::uint64_t id = 0; id < 200; ++id) {
    Impact impact = impact_on(GroundMaterial::steel, Wetness::puddle_10mm, id);
    impact.velocity = {3, -6, 1};
    impact.wind = {6, 0, -3};
    const MadeSplash m = made(impact);
    const Droplet& drop = m.droplets.front();
    EXPECT_GT(drop.radius, 0);
    EXPECT_EQ(drop.velocity.x, 0);
    EXPECT_EQ(drop.velocity.z, 0);
    const float top = drop.leaves - m.splash.cone_starts;
    EXPECT_NEAR(formulas::orbit_velocity(drop.velocity, vec3(0.0f), SplashOptions{}.gravity, drop.drag, top).y, 0,
                2e-5f);
    // The crown, of as many piles as scatter from 5 mm, falls back before.
    EXPECT_GE(m.droplets.size(), 13u);
    EXPECT_LE(m.droplets.size(), 23u);
    for (std::size_t i = 1; i < m.droplets.size(); ++i) {
      EXPECT_EQ(m.droplets[i].radius, 0);
      EXPECT_LE(m.droplets[i].lands, m.splash.cone_starts);
    }
  }
}

/// Mean height of what rises from a splash: of the crown's tips and of the cone's, m.
struct Rise {
  double crown = 0, cone = 0, widest = 0;
};
Rise rise_of(float diameter) {
  Rise rise;
  constexpr int kSplashes = 300;
  for (std::uint64_t id = 0; id < kSplashes; ++id) {
    Impact impact = impact_on(GroundMaterial::asphalt, Wetness::puddle_10mm, id, diameter);
    impact.velocity = {0, -fall_speed(diameter), 0};
    const MadeSplash m = made(impact);
    const auto top = [](const Droplet& d) { return 0.5 / 9.81 * d.velocity.y * d.velocity.y; };  // without air
    rise.cone += top(m.droplets.front()) / kSplashes;
    for (const Droplet& d : std::span(m.droplets).subspan(1)) {
      rise.crown += top(d) / kSplashes / static_cast<double>(m.droplets.size() - 1);
      const vec3 at_top = d.start + d.velocity * (d.velocity.y / 9.81f);
      rise.widest = std::max(rise.widest, double{std::hypot(at_top.x, at_top.z)});
    }
  }
  return rise;
}

TEST(CrownCone, RisesByMillimetresFromSmallDropsAndByCentimetresFromLargeOnes) {
  const Rise small = rise_of(0.001f), medium = rise_of(0.002f), large = rise_of(0.004f);
  EXPECT_NEAR(small.cone, 0.002, 0.001);
  EXPECT_NEAR(medium.cone, 0.013, 0.003);
  EXPECT_NEAR(large.cone, 0.046, 0.008);
  // Crowns stand about one and a half to four diameters high, and lean outwards by less than their height.
  EXPECT_NEAR(small.crown / 0.001, 2.3, 0.5);
  EXPECT_NEAR(medium.crown / 0.002, 3.1, 0.5);
  EXPECT_NEAR(large.crown / 0.004, 2.8, 0.5);
  for (const auto& [rise, diameter] : {std::pair(small, 0.001), std::pair(medium, 0.002), std::pair(large, 0.004)})
    EXPECT_LT(
        rise.widest - made(impact_on(GroundMaterial::asphalt, Wetness::puddle_10mm, 1, static_cast<float>(diameter)))
                          .splash.circle,
        1.2 * rise.crown);
}

TEST(CrownCone, LeansLessThanWhatScatters) {
  Impact impact = impact_on(GroundMaterial::asphalt, Wetness::puddle_10mm, 1);
  impact.velocity = {3, -6.5f, -2};
  vec3 sum{0.0f};
  int tips = 0;
  for (std::uint64_t id = 0; id < 2000; ++id) {
    impact.id = id;
    const MadeSplash m = made(impact);
    for (const Droplet& d : std::span(m.droplets).subspan(1)) sum += d.velocity, ++tips;
  }
  EXPECT_NEAR(sum.x / static_cast<float>(tips), kCarriedByCrown * 3, 0.003);
  EXPECT_NEAR(sum.z / static_cast<float>(tips), kCarriedByCrown * -2, 0.003);
  EXPECT_LT(kCarriedByCrown, kCarried);
}

}  // namespace
}  // namespace meniscus
