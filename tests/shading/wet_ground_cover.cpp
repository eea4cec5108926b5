#include <gtest/gtest.h>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "base/random.h"
#include "meniscus/formulas.h"
#include "meniscus/shading.h"
#include "meniscus/sim.h"

namespace meniscus {
namespace {

constexpr float kWide = 10;       ///< m: a beam that sees no grain
constexpr float kFine = 0.0002f;  ///< m: one that sees all of it

WetGround ground_of(GroundMaterial material, double water = 0, float size = 1) {
  GroundOptions options;
  options.low = vec2{-size};
  options.high = vec2{size};
  options.material = material;
  options.roughness = 0;
  WetGround ground(options);
  if (water > 0) ground.rain(water);
  return ground;
}

/// What saturates it, and a film of this thickness.
WetGround filmed(GroundMaterial material, double film) {
  return ground_of(material, ground_of(material).capacity(0) + film);
}

SolidHit covered(const GroundCover& cover, vec3 point, float width = kWide, vec3 direction = {0, -1, 0},
                 vec3 normal = {0, 1, 0}) {
  SolidHit hit;
  hit.distance = 1;
  hit.normal = hit.face_normal = normal;
  hit.covered = true;
  cover.cover({&point, 1}, {&direction, 1}, {&width, 1}, {&hit, 1});
  return hit;
}

const GroundMaterial kStones[] = {GroundMaterial::concrete, GroundMaterial::asphalt};

TEST(WetGroundCover, ShowsTheDryAlbedoOnAverageAndToWideBeams) {
  const WetLook look;
  for (const GroundMaterial material : kStones) {
    const WetGround ground = ground_of(material);
    const auto cover = wet_ground_cover(ground, look);
    const vec3 expected = look.albedo[static_cast<std::size_t>(material)];
    EXPECT_LT(glm::length(covered(*cover, {0.1f, 0, 0.2f}).albedo - expected), 1e-3f) << name_of(material);
    Draws draws(3);
    vec3 sum{0.0f};
    constexpr int kPoints = 60000;
    for (int i = 0; i < kPoints; ++i)
      sum += covered(*cover,
                     {static_cast<float>(draws.between(-40, 40)), 0, static_cast<float>(draws.between(-40, 40))}, kFine)
                 .albedo;
    EXPECT_LT(glm::length(sum / static_cast<float>(kPoints) - expected), 0.05f * glm::length(expected))
        << name_of(material);
  }
}

TEST(WetGroundCover, DarkensWhatIsSoakedAsLeknerAndDorfSay) {
  const WetLook look;
  for (const GroundMaterial material : {GroundMaterial::concrete, GroundMaterial::asphalt}) {
    const double capacity = ground_of(material).capacity(0);
    float before = 2;
    for (const double part : {0.0, 0.25, 0.5, 0.75, 1.0}) {
      const WetGround ground = ground_of(material, part * capacity);
      const float albedo = covered(*wet_ground_cover(ground, look), {0.3f, 0, 0}).albedo.y;
      EXPECT_LT(albedo, before);
      before = albedo;
    }
    const float dry = look.albedo[static_cast<std::size_t>(material)].y;
    EXPECT_NEAR(before, formulas::wet_albedo(dry, 1.333f), 1e-4f);
  }
}

TEST(WetGroundCover, ShowsTheFirstDropsAsDarkSpots) {
  // A tenth of what it can soak up.
  WetLook look;
  look.albedo[0] = vec3{0.4f};
  const auto cover = wet_ground_cover(
      ground_of(GroundMaterial::concrete, 0.1 * ground_of(GroundMaterial::concrete).capacity(0)), look);
  const auto dry = wet_ground_cover(ground_of(GroundMaterial::concrete), look);
  const float wet = formulas::wet_albedo(0.4f, 1.333f) / 0.4f;
  Draws draws(6);
  double sum = 0;
  int at_ends = 0;
  constexpr int kPlaces = 20000;
  for (int i = 0; i < kPlaces; ++i) {
    const vec3 place{static_cast<float>(draws.between(-0.9, 0.9)), 0, static_cast<float>(draws.between(-0.9, 0.9))};
    const float ratio = covered(*cover, place, kFine).albedo.y / covered(*dry, place, kFine).albedo.y;
    sum += static_cast<double>(ratio) / kPlaces;
    at_ends += ratio > 0.97f || ratio < wet + 0.06f;
  }
  EXPECT_NEAR(sum, static_cast<double>(covered(*cover, {0, 0, 0}).albedo.y / 0.4f), 0.03) << "as from afar";
  EXPECT_GT(at_ends, kPlaces * 6 / 10) << "dark or dry, seldom between";
}

TEST(WetGroundCover, ShinesMoreTheThickerItsFilm) {
  for (const GroundMaterial material : {GroundMaterial::concrete, GroundMaterial::asphalt}) {
    EXPECT_EQ(covered(*wet_ground_cover(ground_of(material)), {0, 0, 0}).roughness, 1.0f) << "dry";
    WetLook smooth;
    smooth.bumpiness = 0;
    float before = 1.0f;
    for (const double film : {0.0, 1e-4, 2e-4, 3e-4, 4e-4, 5e-4}) {
      const SolidHit hit = covered(*wet_ground_cover(filmed(material, film), smooth), {0.2f, 0, 0.1f});
      EXPECT_LT(hit.roughness, before) << film;
      EXPECT_FLOAT_EQ(hit.ior, 1.333f);
      before = hit.roughness;
    }
    EXPECT_GE(before, 0.05f);
    EXPECT_LE(before, 0.1f);
    // Bumps that a wide beam does not see blur the mirror image instead.
    EXPECT_GT(covered(*wet_ground_cover(filmed(material, 5e-4)), {0.2f, 0, 0.1f}).roughness, before);
  }
}

TEST(WetGroundCover, LeavesTheMirrorImageOfPuddlesToTheirOwnSurface) {
  const WetLook look;
  const SolidHit hit = covered(*wet_ground_cover(filmed(GroundMaterial::asphalt, 3e-3), look), {0.2f, 0, 0.1f});
  EXPECT_EQ(hit.roughness, 1.0f);
  EXPECT_NEAR(hit.albedo.y, formulas::wet_albedo(look.albedo[1].y, 1.333f), 1e-4f);
}

TEST(WetGroundCover, MirrorsSteelDryAndWet) {
  const SolidHit dry = covered(*wet_ground_cover(ground_of(GroundMaterial::steel)), {0, 0, 0});
  EXPECT_GE(dry.roughness, 0.35f);
  EXPECT_LE(dry.roughness, 0.55f);
  EXPECT_NEAR(formulas::fresnel_reflectance(1, dry.ior), 0.25f, 1e-3f);
  const float mirrored = 0.25f * (1 - dry.roughness), all = mirrored + (1 - mirrored) * dry.albedo.y;
  EXPECT_NEAR(all, WetLook().albedo[2].y, 0.03f) << "mirror image and body together";
  EXPECT_LT(covered(*wet_ground_cover(filmed(GroundMaterial::steel, 5e-4)), {0, 0, 0}).roughness, dry.roughness);
}

/// A cone of asphalt, one in twenty, upside down; filled to about half.
constexpr float kRise = 0.05f;
WetGround bowl() {
  GroundOptions options;
  options.low = vec2{-1};
  options.high = vec2{1};
  options.roughness = 0;
  options.heights = Image<float>(100, 100);
  for (int y = 0; y < 100; ++y)
    for (int x = 0; x < 100; ++x) {
      const vec2 at = (vec2(x, y) - 49.5f) / 50.0f;
      options.heights(x, y) = kRise * std::min(glm::length(at), 1.0f);
    }
  WetGround ground(options);
  ground.rain(0.004);
  ground.settle();
  return ground;
}

TEST(WetGroundCover, IsAtAShoreAsSmoothAndLevelAsThePuddle) {
  const WetGround ground = bowl();
  const std::size_t middle = *ground.cell_at({0.001f, 0, 0.001f});
  const float level = ground.bed(middle) + static_cast<float>(ground.depth(middle));
  ASSERT_GT(level, 0.01f);
  ASSERT_LT(level, 0.04f);
  const auto cover = wet_ground_cover(ground);
  for (const float angle : {0.3f, 1.2f, 2.5f, 4.0f}) {
    const vec3 out{std::cos(angle), 0, std::sin(angle)};
    const vec3 normal = glm::normalize(vec3{0, 1, 0} - kRise * out);
    const auto at = [&](float above, float width = kFine) {
      const float height = level + above;
      return covered(*cover, vec3{0, height, 0} + height / kRise * out, width, {0, -1, 0}, normal);
    };
    const SolidHit dry_side = at(0.00004f), wet_side = at(-0.0001f), higher = at(0.004f);
    EXPECT_LT(dry_side.roughness, 0.03f) << "a mirror as the water is";
    EXPECT_GT(dry_side.normal.y, 0.99995f);
    EXPECT_FLOAT_EQ(dry_side.ior, 1.333f);
    EXPECT_EQ(wet_side.roughness, 1.0f) << "the water mirrors here";
    EXPECT_GT(higher.roughness, 0.1f) << "a film on stones";
    // No step on the way there, but from stone to stone.
    constexpr float kStones = 0.02f;
    float before = at(0.00004f, kStones).roughness;
    EXPECT_LT(before, 0.03f);
    for (float above = 0.00004f; above < 0.004f; above += 0.00002f) {
      const float roughness = at(above, kStones).roughness;
      EXPECT_LT(std::abs(roughness - before), 0.03f) << above;
      before = roughness;
    }
  }
}

TEST(WetGroundCover, KeepsMaterialsApartAtAStraightLine) {
  GroundOptions options;
  options.low = vec2{-1};
  options.high = vec2{1};
  options.roughness = 0;
  options.materials = Image<GroundMaterial>(2, 1, GroundMaterial::asphalt);
  options.materials(1, 0) = GroundMaterial::concrete;
  const auto cover = wet_ground_cover(WetGround(options));
  const auto mean = [&](float a, float width) {
    float sum = 0;
    for (int i = 0; i < 400; ++i)
      sum += covered(*cover, {a, 0, -0.9f + 0.0045f * static_cast<float>(i)}, width).albedo.y;
    return sum / 400;
  };
  const WetLook look;
  // Less than a third of a cell from the line.
  EXPECT_NEAR(mean(-0.006f, 0.008f), look.albedo[1].y, 0.02f);
  EXPECT_NEAR(mean(0.006f, 0.008f), look.albedo[0].y, 0.02f);
  EXPECT_NEAR(mean(0, 0.5f), 0.5f * (look.albedo[0].y + look.albedo[1].y), 0.02f) << "wide beams mix both";
}

/// Ground of all kinds, some of it wet.
WetGround patchwork() {
  GroundOptions options;
  options.low = {-1, -0.5f};
  options.high = {1, 0.5f};
  options.roughness = 0;
  options.materials = Image<GroundMaterial>(4, 1, GroundMaterial::asphalt);
  options.materials(2, 0) = GroundMaterial::concrete;
  options.materials(3, 0) = GroundMaterial::steel;
  WetGround ground(options);
  Draws draws(4);
  for (int i = 0; i < 3000; ++i)
    ground.add(static_cast<std::size_t>(draws.uniform() * static_cast<double>(ground.size())), 2e-7);
  return ground;
}

TEST(WetGroundCover, GoesOnAsItsMirrorImage) {
  WetLook plain;
  plain.seed = 5;
  const WetGround ground = patchwork();
  const auto cover = wet_ground_cover(ground, plain);
  for (float a = -0.95f; a < 1.0f; a += 0.13f)
    for (float b = -0.45f; b < 0.5f; b += 0.11f) {
      const SolidHit here = covered(*cover, {a, 0, b});
      for (const vec3 there : {vec3{2 - a, 0, b}, vec3{a, 0, -1 - b}, vec3{a + 4, 0, b}, vec3{a, 0, b - 2}}) {
        const SolidHit other = covered(*cover, there);
        EXPECT_LT(glm::length(here.albedo - other.albedo), 2e-3f);
        EXPECT_NEAR(here.roughness, other.roughness, 2e-3f);
      }
    }
}

TEST(WetGroundCover, HasNoEdgesAtCells) {
  const WetGround ground = patchwork();
  const auto cover = wet_ground_cover(ground);
  // Steps of a hundredth of a cell, too wide a beam for the grain.
  constexpr float kStep = 0.0002f, kBeam = 0.02f;
  SolidHit before = covered(*cover, {-0.9f, 0, 0.013f}, kBeam);
  for (float a = -0.9f + kStep; a < 0.9f; a += kStep) {
    const SolidHit hit = covered(*cover, {a, 0, 0.013f}, kBeam);
    // Between materials the line is some mm wide.
    const bool between = std::abs(a) < 0.01f || std::abs(a - 0.5f) < 0.01f;
    EXPECT_LT(std::abs(hit.albedo.y - before.albedo.y), between ? 0.03f : 0.015f) << a;
    EXPECT_LT(std::abs(hit.roughness - before.roughness), 0.06f) << a;
    before = hit;
  }
}

TEST(WetGroundCover, KeepsNormalsUnitAndInSight) {
  const auto cover = wet_ground_cover(patchwork());
  Draws draws(8);
  for (int i = 0; i < 5000; ++i) {
    const auto d = [&] { return static_cast<float>(draws.between(-1, 1)); };
    const vec3 direction = glm::normalize(vec3{d(), -0.02f - 0.3f * std::abs(d()), d()});
    const SolidHit hit = covered(*cover, {d(), 0, d()}, kFine, direction);
    EXPECT_NEAR(glm::length(hit.normal), 1.0f, 1e-4f);
    EXPECT_LT(glm::dot(hit.normal, direction), 0.0f);
    EXPECT_GE(hit.roughness, 0.0f);
    EXPECT_LE(hit.roughness, 1.0f);
    for (int c = 0; c < 3; ++c) {
      EXPECT_GE(hit.albedo[c], 0.0f);
      EXPECT_LE(hit.albedo[c], 1.0f);
    }
  }
}

TEST(WetGroundCover, RunsOffWhatIsSteep) {
  const auto cover = wet_ground_cover(filmed(GroundMaterial::concrete, 4e-4));
  const SolidHit flat = covered(*cover, {0, 0, 0}), steep = covered(*cover, {0, 0, 0}, kWide, {1, 0, 0}, {-1, 0, 0});
  EXPECT_LT(flat.roughness, 0.4f);
  EXPECT_GT(steep.roughness, 0.8f);
  EXPECT_NEAR(flat.albedo.y, steep.albedo.y, 1e-4f) << "soaked all the same";
}

TEST(WetGroundCover, SurvivesPlacesThatAreNone) {
  const auto cover = wet_ground_cover(patchwork());
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  for (const float bad : {nan, inf, -inf, 3e38f, 1e12f})
    for (const float width : {kFine, kWide, nan, inf}) {
      const SolidHit hit = covered(*cover, {bad, 0, bad}, width);
      EXPECT_TRUE(hit.albedo.y >= 0 && hit.albedo.y <= 1) << bad << ", " << width;
      EXPECT_TRUE(hit.roughness >= 0 && hit.roughness <= 1) << bad << ", " << width;
    }
}

TEST(WetGroundCover, RefusesLooksThatAreNone) {
  const WetGround ground = ground_of(GroundMaterial::asphalt);
  WetLook look;
  look.film_full = 0;
  EXPECT_THROW(wet_ground_cover(ground, look), Error);
  look = {};
  look.bumpiness = -1;
  EXPECT_THROW(wet_ground_cover(ground, look), Error);
  look = {};
  look.albedo[1].y = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(wet_ground_cover(ground, look), Error);
}

}  // namespace
}  // namespace meniscus
