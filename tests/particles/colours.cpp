#include <gtest/gtest.h>

#include <cmath>

#include "meniscus/particles.h"

namespace meniscus {
namespace {

constexpr Colormap kMaps[] = {Colormap::viridis, Colormap::magma, Colormap::turbo, Colormap::coolwarm, Colormap::grey};

float srgb(float linear) {
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
}

void expect_srgb(Colormap map, float t, vec3 expected) {
  const vec3 linear = colormap_at(map, t);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(srgb(linear[c]), expected[c], 0.02) << t << " channel " << c;
}

// Colours of the published tables of 256 (33 for coolwarm) that are not among the control points.
TEST(Colormap, IsThePublishedOne) {
  expect_srgb(Colormap::viridis, 0.0f, {0.267004f, 0.004874f, 0.329415f});
  expect_srgb(Colormap::viridis, 64 / 255.0f, {0.229739f, 0.322361f, 0.545706f});
  expect_srgb(Colormap::viridis, 0.5f, {0.128148f, 0.565107f, 0.550892f});
  expect_srgb(Colormap::viridis, 204 / 255.0f, {0.477504f, 0.821444f, 0.318195f});
  expect_srgb(Colormap::viridis, 1.0f, {0.993248f, 0.906157f, 0.143936f});
  expect_srgb(Colormap::magma, 51 / 255.0f, {0.232077f, 0.059889f, 0.437695f});
  expect_srgb(Colormap::magma, 102 / 255.0f, {0.550287f, 0.161158f, 0.505719f});
  expect_srgb(Colormap::magma, 128 / 255.0f, {0.716387f, 0.214982f, 0.475290f});
  expect_srgb(Colormap::magma, 153 / 255.0f, {0.868793f, 0.287728f, 0.409303f});
  expect_srgb(Colormap::magma, 204 / 255.0f, {0.994738f, 0.624350f, 0.427397f});
  expect_srgb(Colormap::turbo, 16 / 255.0f, {0.25107f, 0.25237f, 0.63374f});
  expect_srgb(Colormap::turbo, 64 / 255.0f, {0.15844f, 0.73551f, 0.92305f});
  expect_srgb(Colormap::turbo, 128 / 255.0f, {0.64362f, 0.98999f, 0.23356f});
  expect_srgb(Colormap::turbo, 192 / 255.0f, {0.98360f, 0.49291f, 0.12849f});
  expect_srgb(Colormap::turbo, 224 / 255.0f, {0.81608f, 0.18462f, 0.01809f});
  expect_srgb(Colormap::coolwarm, 1 / 32.0f, {0.266234f, 0.353095f, 0.801467f});
  expect_srgb(Colormap::coolwarm, 5 / 32.0f, {0.424370f, 0.558148f, 0.945620f});
  expect_srgb(Colormap::coolwarm, 0.5f, {0.865395f, 0.865410f, 0.865396f});
  expect_srgb(Colormap::coolwarm, 1.0f, {0.705673f, 0.015556f, 0.150233f});
  expect_srgb(Colormap::grey, 0.25f, {0.25f, 0.25f, 0.25f});
}

TEST(Colormap, IsContinuousAndWithinTheColoursThatCanBeShown) {
  for (const Colormap map : kMaps) {
    vec3 last = colormap_at(map, 0);
    for (int i = 1; i <= 1000; ++i) {
      const vec3 now = colormap_at(map, static_cast<float>(i) / 1000);
      for (int c = 0; c < 3; ++c) {
        EXPECT_GE(now[c], 0);
        EXPECT_LE(now[c], 1);
        EXPECT_NEAR(now[c], last[c], 0.01);
      }
      last = now;
    }
  }
}

TEST(Colormap, OfOrderedValuesGrowsBrighter) {
  const auto luminance = [](vec3 c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; };
  for (const Colormap map : {Colormap::viridis, Colormap::magma, Colormap::grey}) {
    for (int i = 1; i <= 100; ++i) {
      EXPECT_GT(luminance(colormap_at(map, static_cast<float>(i) / 100)),
                luminance(colormap_at(map, static_cast<float>(i - 1) / 100)));
    }
  }
}

TEST(Colormap, ClampsItsArgument) {
  for (const Colormap map : kMaps) {
    EXPECT_EQ(colormap_at(map, -3), colormap_at(map, 0));
    EXPECT_EQ(colormap_at(map, std::nanf("")), colormap_at(map, 0));
    EXPECT_EQ(colormap_at(map, 7), colormap_at(map, 1));
  }
}

TEST(Colormap, IsKnownByItsName) {
  EXPECT_EQ(colormap_of("viridis"), Colormap::viridis);
  EXPECT_EQ(colormap_of("magma"), Colormap::magma);
  EXPECT_EQ(colormap_of("turbo"), Colormap::turbo);
  EXPECT_EQ(colormap_of("coolwarm"), Colormap::coolwarm);
  EXPECT_EQ(colormap_of("grey"), Colormap::grey);
  EXPECT_EQ(colormap_of("gray"), Colormap::grey);
  try {
    colormap_of("jet");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
    for (const char* name : {"jet", "viridis", "magma", "turbo", "coolwarm", "grey"}) {
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << name;
    }
  }
}

Particles three_particles() {
  Particles particles;
  particles.x = particles.y = particles.z = {0, 1, 2};
  particles.attributes = {{"density", 1, {1000, 1010, 1005}},
                          {"velocity", 3, {3, 4, 0, 0, 0, 0, 0, 0, 10}},
                          {"Cd", 3, {0.1f, 0.2f, 0.3f, 2.0f, 0.0f, 0.5f, -1.0f, 0.5f, 1.0f}}};
  return particles;
}

void expect_colour(vec3 found, vec3 expected) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], 2e-3);
}

TEST(ParticleColours, MapValuesOverTheirOwnRange) {
  std::pair<float, float> range;
  const auto colours = particle_colours(three_particles(), {"density", Colormap::magma, {}}, range);
  EXPECT_EQ(range, std::pair(1000.0f, 1010.0f));
  ASSERT_EQ(colours.size(), 3u);
  expect_colour(colours[0], colormap_at(Colormap::magma, 0));
  expect_colour(colours[1], colormap_at(Colormap::magma, 1));
  expect_colour(colours[2], colormap_at(Colormap::magma, 0.5f));
}

TEST(ParticleColours, TakeTheMagnitudeOfAVectorAndAGivenRange) {
  std::pair<float, float> range;
  const auto colours = particle_colours(three_particles(), {"velocity", Colormap::viridis, {{0.0f, 8.0f}}}, range);
  EXPECT_EQ(range, std::pair(0.0f, 8.0f));
  expect_colour(colours[0], colormap_at(Colormap::viridis, 5 / 8.0f));
  expect_colour(colours[1], colormap_at(Colormap::viridis, 0));
  expect_colour(colours[2], colormap_at(Colormap::viridis, 1));
}

TEST(ParticleColours, TakeColoursAsTheyAre) {
  std::pair<float, float> range;
  const auto colours = particle_colours(three_particles(), {"Cd", Colormap::viridis, {}}, range);
  EXPECT_EQ(colours[0], vec3(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(colours[1], vec3(2.0f, 0.0f, 0.5f));
  EXPECT_EQ(colours[2], vec3(0.0f, 0.5f, 1.0f));  // no negative light
}

TEST(ParticleColours, OfOneValueForAllAreTheMiddleOfTheMap) {
  Particles particles = three_particles();
  particles.attributes[0].values = {5, 5, 5};
  std::pair<float, float> range;
  for (const vec3 colour : particle_colours(particles, {"density", Colormap::viridis, {}}, range)) {
    expect_colour(colour, colormap_at(Colormap::viridis, 0.5f));
  }
}

TEST(ParticleColours, DoNotMindValuesThatAreNoNumbers) {
  Particles particles = three_particles();
  particles.attributes[0].values = {std::nanf(""), 1, std::numeric_limits<float>::infinity()};
  std::pair<float, float> range;
  const auto colours = particle_colours(particles, {"density", Colormap::viridis, {{0.0f, 2.0f}}}, range);
  expect_colour(colours[0], colormap_at(Colormap::viridis, 0));
  expect_colour(colours[1], colormap_at(Colormap::viridis, 0.5f));
  expect_colour(colours[2], colormap_at(Colormap::viridis, 1));
  particle_colours(particles, {"density", Colormap::viridis, {}}, range);
  EXPECT_EQ(range, std::pair(1.0f, 1.0f));
}

TEST(ParticleColours, NameTheAttributesThatThereAre) {
  std::pair<float, float> range;
  try {
    particle_colours(three_particles(), {"vorticity", Colormap::viridis, {}}, range);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::not_found);
    for (const char* name : {"vorticity", "density", "velocity", "Cd"}) {
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << name;
    }
  }
}

TEST(ParticleColours, RefuseAnAttributeOfTheWrongLength) {
  Particles particles = three_particles();
  particles.attributes[0].values.pop_back();
  std::pair<float, float> range;
  EXPECT_THROW(particle_colours(particles, {"density", Colormap::viridis, {}}, range), Error);
}

}  // namespace
}  // namespace meniscus
