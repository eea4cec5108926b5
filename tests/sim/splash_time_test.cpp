#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>

#include "sim/splash_cases.h"
#include "sim/splash_shapes.h"
#include "sim/splash_view.h"

namespace meniscus {
namespace {

using Kind = WaterPiece::Kind;

/// How large a piece is drawn: half a diagonal of its base or its radius, by its opacity.
float size_of(const WaterPiece& piece) {
  return piece.opacity * (piece.kind == Kind::pyramid ? glm::length(piece.across) : piece.radius);
}

/// One of each kind that the droplet shows at this age.
using Shown = std::array<std::optional<WaterPiece>, 4>;
Shown shown(const Splash& splash, std::span<const Droplet> droplets, float age) {
  Shown shown;
  SplashShapes(splash, SplashOptions{}, age, [&](auto&& make) {
    const WaterPiece piece = make();
    auto& slot = shown[static_cast<std::size_t>(piece.kind)];
    if (!slot || size_of(piece) > size_of(*slot)) slot = piece;
  }).show(droplets);
  return shown;
}

/// Follows what one droplet (or one pile of a crown, with the cone) shows over the splash's life and beyond.
void expect_steady(const Splash& splash, std::span<const Droplet> droplets) {
  constexpr float kStep = 2.5e-4f;
  // Tips go as fast as their orbits, and back in a longer time; sizes change within 5 ms.
  const float fastest = 1.5f * splash.fastest + 1.5f * SplashOptions{}.growth_length / kSinkTime;
  float size = std::max(splash.width, kConeWidth * splash.impact.diameter);
  if (splash.kind == SplashKind::disk) size = splash.circle;
  const float swells = 1.5f * size / kSwell, far = fastest * kStep * 1.01f + 1e-6f,
              grown = swells * kStep * 1.01f + 1e-7f;
  Shown before = shown(splash, droplets, 0);
  for (const auto& piece : before) ASSERT_FALSE(piece);
  for (float age = kStep; age < splash.ends + 2 * kStep; age += kStep) {
    const Shown now = shown(splash, droplets, age);
    for (std::size_t k = 0; k < now.size(); ++k) {
      if (!now[k] && !before[k]) continue;
      if (!now[k] || !before[k]) {  // it comes or goes as nothing
        ASSERT_LE(size_of(now[k] ? *now[k] : *before[k]), grown) << "kind " << k << " age " << age;
        continue;
      }
      const WaterPiece &a = *before[k], &b = *now[k];
      ASSERT_LE(std::abs(size_of(b) - size_of(a)), grown) << "kind " << k << " age " << age;
      if (std::min(size_of(a), size_of(b)) <= grown) continue;  // a crown's pile gives way to the cone
      ASSERT_LE(glm::distance(a.from, b.from), far) << "kind " << k << " age " << age;
      if (b.kind == Kind::pyramid) {
        ASSERT_LE(glm::distance(a.to, b.to), far) << "age " << age;
        ASSERT_LE(glm::distance(a.across, b.across), grown) << "age " << age;
      }
      if (b.kind == Kind::disk) {
        ASSERT_EQ(a.across, b.across);
      }
      ASSERT_LE(std::abs(a.opacity - b.opacity), 1.5f * kStep / kSwell);
    }
    before = now;
  }
  for (const auto& piece : before) ASSERT_FALSE(piece);
}

TEST(SplashShapes, NeverPop) {
  int kinds[4] = {};
  for (const Impact& given : all_kinds_of_impacts(60, 1)) {
    Impact impact = given;
    impact.normal = glm::normalize(impact.normal);
    const MadeSplash m = made(impact);
    if (m.splash.kind == SplashKind::none) continue;
    ++kinds[static_cast<int>(m.splash.kind)];
    if (m.splash.kind == SplashKind::scattering)
      for (const Droplet& droplet : m.droplets) expect_steady(m.splash, {&droplet, 1});
    if (m.splash.kind == SplashKind::disk) expect_steady(m.splash, {});
    if (m.splash.kind == SplashKind::crown_cone)
      for (std::size_t i = 1; i < m.droplets.size(); i += 5)
        expect_steady(m.splash, std::array{m.droplets.front(), m.droplets[i]});
    if (HasFatalFailure()) FAIL() << "impact " << impact.id;
  }
  EXPECT_GT(kinds[1], 5);
  EXPECT_GT(kinds[2], 2);
  EXPECT_GT(kinds[3], 0);
}

TEST(SplashShapes, StayWithinTheReachAndTheSpeedThatTheSplashStates) {
  for (const Impact& given : all_kinds_of_impacts(300, 1)) {
    Impact impact = given;
    impact.normal = glm::normalize(impact.normal);
    const MadeSplash m = made(impact);
    const Splash& s = m.splash;
    for (float part = 0.01f; part < 1; part += 0.03f) {
      const float age = part * s.ends;
      const float most =
          std::min(s.reach, s.circle + std::max(s.width, kConeWidth * impact.diameter) + s.fastest * age);
      SplashShapes(s, SplashOptions{}, age, [&](auto&& make) {
        const WaterPiece p = make();
        const float r = p.radius;
        EXPECT_LE(glm::distance(p.from, impact.point) + r, s.reach * 1.0001f);
        if (p.kind == Kind::pyramid) {
          EXPECT_LE(glm::distance(p.to, impact.point), std::min(most, s.reach) * 1.0001f);
          EXPECT_LE(glm::distance(p.from + p.across, impact.point), s.reach * 1.0001f);
        }
      }).show(m.droplets);
    }
  }
}

TEST(SplashShapes, HaveTipsOnTheOrbitsOfTheirDropletsUntilThoseLeave) {
  const MadeSplash m = made(impact_on(GroundMaterial::asphalt, Wetness::puddle_5mm, 3));
  for (const Droplet& droplet : m.droplets) {
    const auto offset = [&](float t) {
      return droplet.start +
             formulas::orbit_offset(droplet.velocity, vec3(0.0f), SplashOptions{}.gravity, droplet.drag, t);
    };
    const float half = 0.6f * droplet.leaves;
    const Shown grows = shown(m.splash, {&droplet, 1}, half),
                flies = shown(m.splash, {&droplet, 1}, 0.5f * (droplet.leaves + droplet.lands));
    ASSERT_TRUE(grows[0] && grows[1]);
    EXPECT_EQ(grows[0]->from, droplet.start);
    EXPECT_LT(glm::distance(grows[0]->to, offset(half)), 1e-7f);
    EXPECT_LT(glm::distance(grows[1]->from, grows[0]->to), 1e-7f);  // the droplet swells on the tip
    EXPECT_LT(grows[1]->radius, droplet.radius);
    EXPECT_NEAR(glm::dot(grows[0]->across, grows[0]->to - grows[0]->from), 0, 1e-8f);
    if (droplet.lands < 0.02f) continue;
    ASSERT_TRUE(flies[1]);
    EXPECT_LT(glm::distance(flies[1]->from, offset(0.5f * (droplet.leaves + droplet.lands))), 1e-7f);
    EXPECT_NEAR(flies[1]->radius, droplet.radius, 1e-9f);
    if (flies[0]) {
      EXPECT_LT(glm::distance(flies[0]->to, droplet.start), glm::distance(offset(droplet.leaves), droplet.start));
    }
  }
}

TEST(SplashShapes, ShowTheCrownThenTheConeThenTheDrop) {
  const MadeSplash m = made(impact_on(GroundMaterial::asphalt, Wetness::puddle_10mm, 3));
  const Splash& s = m.splash;
  const Droplet& drop = m.droplets.front();
  const auto at = [&](float age) {
    std::vector<WaterPiece> pieces;
    SplashShapes(s, SplashOptions{}, age, [&](auto&& make) { pieces.push_back(make()); }).show(m.droplets);
    return pieces;
  };
  const auto crown = at(0.3f * s.cone_starts);
  EXPECT_EQ(crown.size(), m.droplets.size() - 1);
  for (const WaterPiece& p : crown) EXPECT_NEAR(glm::length(p.from), s.circle, 1e-7f);
  const auto rising = at(s.cone_starts + 0.3f * (drop.leaves - s.cone_starts));
  ASSERT_EQ(rising.size(), 1u);
  EXPECT_EQ(rising[0].from, vec3(0.0f));
  const auto top = at(drop.leaves);
  ASSERT_EQ(top.size(), 2u);
  EXPECT_EQ(top[0].to, top[1].from);
  EXPECT_GT(top[0].to.y, rising[0].to.y);
  EXPECT_NEAR(top[1].radius, drop.radius, 1e-9f);
  const auto falling = at(drop.leaves + 0.5f * (drop.lands - drop.leaves));
  ASSERT_EQ(falling.size(), 2u);
  EXPECT_LT(falling[0].to.y, falling[1].from.y - falling[1].radius);  // they have parted
  const auto last = at(drop.leaves + 0.9f * (drop.lands - drop.leaves));
  ASSERT_EQ(last.size(), 1u);
  EXPECT_EQ(last[0].kind, Kind::sphere);
}

TEST(SplashShapes, ShowADiskOnDrySteelThatStaysAndFades) {
  const MadeSplash m = made(impact_on(GroundMaterial::steel, Wetness::dry));
  EXPECT_EQ(m.droplets.size(), 0u);
  float last = 1;
  for (const float age : {0.02f, 0.5f, 1.2f, 1.6f, 1.99f}) {
    const auto disk = shown(m.splash, {}, age)[static_cast<std::size_t>(Kind::disk)];
    ASSERT_TRUE(disk);
    EXPECT_EQ(disk->radius, m.splash.circle);
    EXPECT_EQ(disk->across, vec3(0, 1, 0));
    EXPECT_LE(disk->opacity, last);
    last = disk->opacity;
  }
  EXPECT_LT(last, 0.01f);
}

}  // namespace
}  // namespace meniscus
