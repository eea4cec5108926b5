#include <gtest/gtest.h>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>

#include "analytic_water.h"
#include "fixtures.h"
#include "shading/caustics_map.h"
#include "shading/caustics_photons.h"

namespace meniscus {
namespace {

using tests::AnalyticWater;
using tests::flat_water;

const vec3 kUp{0, 1, 0};

Environment sun_from(vec3 direction) {
  EnvironmentOptions options;
  options.sun_direction = direction;
  return Environment(options);
}

Scene floor_under(const Environment& environment, float height = 0) {
  Ground ground;
  ground.height = height;
  return Scene(environment, ground);
}

Material sea(vec3 extinction = {0.4f, 0.1f, 0.05f}) {
  Material material = tests::clear();
  material.extinction = extinction;
  return material;
}

float clear_water_index() { return tests::clear().ior; }

/// Irradiance on a flat floor under flat water from a light at an angle from the vertical, per channel.
vec3 in_closed_form(vec3 facing, double angle, double depth, const Material& material) {
  const double eta = static_cast<double>(material.ior);
  const double bent = std::asin(std::sin(angle) / eta);
  const double transmitted = (1 - tests::reflectance(angle, eta)) * std::cos(angle);
  vec3 result;
  for (int c = 0; c < 3; ++c)
    result[c] = static_cast<float>(static_cast<double>(facing[c]) * transmitted *
                                   std::exp(-static_cast<double>(material.extinction[c]) * depth / std::cos(bent)));
  return result;
}

class FlatWater : public testing::TestWithParam<std::tuple<double, ScreenDirection, bool>> {};

TEST_P(FlatWater, LightsItsFloorAsInClosedForm) {
  const auto [angle, screen, exact] = GetParam();
  const Environment environment =
      sun_from({static_cast<float>(std::sin(angle)), static_cast<float>(std::cos(angle)), 0});
  const Scene scene = floor_under(environment);
  const AnalyticWater water = flat_water({1, 1}, 0.5f);
  CausticsOptions options;
  options.screen = screen;
  options.exact_hits = exact;
  options.screen_width = 128;
  options.map_size = 300;
  const auto light = caustics(water, scene, sea(), options);
  const vec3 expected = in_closed_form(environment.sun_irradiance(), angle, 0.5, sea());
  for (float x : {-0.5f, -0.21f, 0.0f, 0.13f, 0.4f})
    for (float z : {-0.6f, 0.03f, 0.5f}) {
      const WaterLight::Light at = light->at({x, 0, z}, kUp);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(at.refracted[c] / expected[c], 1.0f, 0.01f) << x << " " << z;
      // The test's water has no sides: farther out the sun comes in below it.
      if (x + 0.5 * std::tan(angle) < 0.98) {
        EXPECT_EQ(at.sun, vec3{0.0f});
      }
    }
}

INSTANTIATE_TEST_SUITE_P(Suns, FlatWater,
                         testing::Combine(testing::Values(0.0, 0.5, 1.0),
                                          testing::Values(ScreenDirection::light, ScreenDirection::up),
                                          testing::Bool()));

AnalyticWater wavy(float height, float amplitude) {
  return {{1, 1}, height - 2.2f * amplitude, height + 2.2f * amplitude, [=](double x, double z) {
            return static_cast<double>(height) +
                   static_cast<double>(amplitude) * (std::sin(9 * x + 2 * z) + 0.7 * std::sin(-5 * x + 11 * z + 1) +
                                                     0.4 * std::sin(15 * z + 7 * x + 2));
          }};
}

CausticsOptions small_screen(int width = 160, int map = 256) {
  CausticsOptions options;
  options.screen_width = width;
  options.map_size = map;
  options.exact_hits = true;
  return options;
}

LightCast cast_from(const AnalyticWater& water, const Scene& scene, const Material& material,
                    const CausticsOptions& options) {
  const Bounds box = casting_box(water, {});
  const auto lights = caustics_lights(scene, box, 4);
  return cast_light(water, lights.at(0), box, scene, material, options, nullptr, true);
}

double sum(vec3 v) { return static_cast<double>(v.x) + static_cast<double>(v.y) + static_cast<double>(v.z); }

TEST(Lamp, LightsTheFloorUnderFlatWaterAsInClosedForm) {
  Ground ground;
  EnvironmentOptions night;
  night.sun_radiance_scale = 0;
  Scene scene(Environment(night), ground);
  scene.set_lamps({{{0.1f, 1.7f, 0}, {3, 2, 1}}});
  const double height = 1.2, depth = 0.5, x = 0.1;
  const AnalyticWater water = flat_water({1, 1}, static_cast<float>(depth));
  for (const ScreenDirection screen : {ScreenDirection::light, ScreenDirection::up}) {
    CausticsOptions options = small_screen();
    options.screen = screen;
    const auto light = caustics(water, scene, sea(), options);
    for (const double angle : {0.0, 0.2, 0.45}) {
      // Light that leaves the lamp between two angles from the vertical lands in a ring: its power by the ring's area.
      const double n = static_cast<double>(clear_water_index()), eps = 1e-4;
      const auto radius = [&](double a) { return height * std::tan(a) + depth * std::tan(std::asin(std::sin(a) / n)); };
      const double low = std::max(0.0, angle - eps), high = angle + eps;
      const double solid_angle = 2 * std::numbers::pi * (std::cos(low) - std::cos(high));
      const double area = std::numbers::pi * (radius(high) * radius(high) - radius(low) * radius(low));
      const double bent = std::asin(std::sin(angle) / n);
      const WaterLight::Light at = light->at({static_cast<float>(x - radius(angle)), 0, 0}, kUp);
      for (int c = 0; c < 3; ++c) {
        const double expected = static_cast<double>(vec3(3, 2, 1)[c]) * solid_angle / area *
                                (1 - tests::reflectance(angle, n)) *
                                std::exp(-static_cast<double>(sea().extinction[c]) * depth / std::cos(bent));
        EXPECT_NEAR(static_cast<double>(at.refracted[c]) / expected, 1.0, 0.015) << angle;
      }
      EXPECT_EQ(at.lamps, vec3{0.0f});
      EXPECT_EQ(at.sun, vec3{1.0f});
    }
  }
}

TEST(WavyWater, BringsAllLightToTheFloorThatItDoesNotAbsorb) {
  const Scene scene = floor_under(sun_from({0.3f, 1, 0.2f}));
  const AnalyticWater water = wavy(0.5f, 0.02f);
  const LightCast cast = cast_from(water, scene, sea(), small_screen());
  const LightBalance& balance = cast.balance;
  EXPECT_NEAR((balance.drawn + balance.absorbed + balance.hidden + balance.grazing + balance.lost) / balance.entered,
              1.0, 1e-6);
  EXPECT_NEAR(sum(cast.maps.at(0).power()) / balance.drawn, 1.0, 0.005);
  EXPECT_LT(balance.hidden + balance.grazing + balance.lost, 0.002 * balance.entered);

  // What enters, by a sum over the surface that knows nothing of screens.
  double entered = 0;
  constexpr int kCells = 400;
  for (int j = 0; j < kCells; ++j)
    for (int i = 0; i < kCells; ++i) {
      const double x = -1 + 2 * (i + 0.5) / kCells, z = -1 + 2 * (j + 0.5) / kCells;
      const vec3 normal = water.normal(x, z);
      const double cosine = static_cast<double>(glm::dot(normal, cast.light.direction));
      entered += cosine / static_cast<double>(normal.y) * 4 / (kCells * kCells) *
                 (1 - tests::reflectance(std::acos(cosine), static_cast<double>(sea().ior)));
    }
  EXPECT_NEAR(balance.entered / (entered * sum(cast.light.strength)), 1.0, 0.01);
}

TEST(WavyWater, AbsorbsByTheWayInTheWater) {
  const Scene scene = floor_under(sun_from({0.3f, 1, 0.2f}));
  const AnalyticWater water = wavy(0.5f, 0.02f);
  const LightCast clear = cast_from(water, scene, sea(vec3{0.0f}), small_screen());
  const LightCast tinted = cast_from(water, scene, sea(vec3{1.0f}), small_screen());
  EXPECT_NEAR(tinted.balance.drawn / clear.balance.drawn, std::exp(-0.5 / std::cos(0.26)), 0.005);
}

TEST(WavyWater, GivesTheSameBitsForAnyNumberOfThreads) {
  const Scene scene = floor_under(sun_from({0.3f, 1, 0.2f}));
  const AnalyticWater water = wavy(0.5f, 0.03f);
  std::vector<std::vector<vec3>> results;
  for (const int threads : {1, 2, 5}) {
    const ThreadLimit limit(threads);
    const LightCast cast = cast_from(water, scene, sea(), small_screen(96, 128));
    results.emplace_back(cast.maps.at(0).texels().begin(), cast.maps.at(0).texels().end());
  }
  EXPECT_EQ(results[0], results[1]);
  EXPECT_EQ(results[0], results[2]);
}

TEST(WavyWater, IsMetInTheGeometryMapWhereRaysMeetIt) {
  const Scene scene = floor_under(sun_from({0.5f, 1, 0.2f}));
  const AnalyticWater water = wavy(0.5f, 0.02f);
  CausticsOptions options = small_screen(96, 128);
  const LightCast exact = cast_from(water, scene, sea(), options);
  options.exact_hits = false;
  const LightCast iterated = cast_from(water, scene, sea(), options);
  const float pixel = exact.maps.at(0).solids().view.pixel_size(0.0f);
  for (std::size_t i = 0; i < exact.landings.size(); ++i) {
    if (exact.landings[i].state != LandingState::landed) continue;
    EXPECT_LT(glm::length(exact.landings[i].point - iterated.landings[i].point), 0.6f * pixel);
  }
}

TEST(Ripple, FocusesWhereItsCurvatureSays) {
  // Height h(x) = 1 - x^2 / (2 R) near the crest; a sun from straight above meets at R n / (n - 1) below it.
  const double curvature = 0.15, n = static_cast<double>(clear_water_index()), focus = curvature * n / (n - 1);
  const AnalyticWater water({0.02f, 0.02f}, 0.99f, 1.0f, [&](double x, double) { return 1 - x * x / (2 * curvature); });
  double brightest = 0, at_depth = 0;
  for (double depth = 0.4; depth < 0.85; depth += 0.05) {
    const Scene scene = floor_under(sun_from({0, 1, 0}), static_cast<float>(1 - depth));
    const LightCast cast = cast_from(water, scene, sea(vec3{0.0f}), small_screen(64, 64));
    const double here = sum(cast.maps.at(0).irradiance({0, static_cast<float>(1 - depth), 0}, kUp));
    if (here > brightest) {
      brightest = here;
      at_depth = depth;
    }
  }
  EXPECT_NEAR(at_depth, focus, 0.051);
}

TEST(SolidInTheWater, IsLitOnTopAndThrowsAShadow) {
  Scene scene = floor_under(sun_from({0, 1, 0}));
  scene.set_solids({{make_solid(box_mesh({-0.3f, 0.2f, -0.3f}, {0.3f, 0.25f, 0.3f})), glm::mat4{1.0f}, {}}});
  const AnalyticWater water = flat_water({1, 1}, 0.5f);
  for (const bool exact : {false, true}) {
    CausticsOptions options = small_screen();
    options.exact_hits = exact;
    const auto light = caustics(water, scene, sea(vec3{0.0f}), options);
    const vec3 expected = in_closed_form(scene.environment().sun_irradiance(), 0, 0.5, sea(vec3{0.0f}));
    EXPECT_NEAR(light->at({0, 0.25f, 0}, kUp).refracted.x / expected.x, 1.0f, 0.01f);
    EXPECT_NEAR(light->at({0.7f, 0, 0}, kUp).refracted.x / expected.x, 1.0f, 0.01f);
    EXPECT_EQ(light->at({0.1f, 0, 0.1f}, kUp).refracted, vec3{0.0f});
    EXPECT_EQ(light->at({0.1f, 0.2f, 0.1f}, -kUp).refracted, vec3{0.0f});
  }
}

TEST(SolidAboveTheWater, KeepsTheLightOut) {
  Scene scene = floor_under(sun_from({0, 1, 0}));
  scene.set_solids({{make_solid(box_mesh({-0.3f, 0.8f, -0.3f}, {0.3f, 0.9f, 0.3f})), glm::mat4{1.0f}, {}}});
  const auto light = caustics(flat_water({1, 1}, 0.5f), scene, sea(), small_screen());
  EXPECT_EQ(light->at({0, 0, 0}, kUp).refracted, vec3{0.0f});
  EXPECT_GT(light->at({0.6f, 0, 0}, kUp).refracted.x, 0.0f);
}

TEST(Wall, IsLitThatTheRefractedLightHardlyReaches) {
  const double angle = 0.4;
  Scene scene = floor_under(sun_from({static_cast<float>(std::sin(angle)), static_cast<float>(std::cos(angle)), 0}));
  scene.set_solids({{make_solid(box_mesh({-1.2f, 0, -1}, {-0.5f, 1, 1})), glm::mat4{1.0f}, {}}});
  const AnalyticWater water = flat_water({1, 1}, 0.5f);
  const auto light = caustics(water, scene, sea(vec3{0.0f}), small_screen(256, 512));
  const double bent = std::asin(std::sin(angle) / static_cast<double>(sea().ior));
  const vec3 across = in_closed_form(scene.environment().sun_irradiance(), angle, 0.5, sea(vec3{0.0f}));
  // The same light on an upright plane: by the tangent of its angle.
  EXPECT_NEAR(static_cast<double>(light->at({-0.5f, 0.25f, 0.1f}, {1, 0, 0}).refracted.x),
              static_cast<double>(across.x) * std::tan(bent), 0.05 * static_cast<double>(across.x) * std::tan(bent));
}

TEST(WavyWater, CastsWhatPhotonsCast) {
  const Scene scene = floor_under(sun_from({0.3f, 1, 0.2f}));
  const AnalyticWater water = wavy(0.5f, 0.02f);
  const LightCast cast = cast_from(water, scene, sea(), small_screen(256, 128));
  const Image<vec3> photons = photon_map(water, cast, scene, sea(), 4);
  double error = 0, mean = 0;
  for (std::size_t i = 0; i < photons.size(); ++i) {
    const double difference = sum(photons[i]) - sum(cast.maps[0].texels()[i]);
    error += difference * difference;
    mean += sum(photons[i]);
  }
  const double count = static_cast<double>(photons.size());
  EXPECT_LT(std::sqrt(error / count), 0.08 * mean / count);
}

TEST(CausticIntensity, HasEveryFactorOfThePaper) {
  LightLanding landing;
  landing.cos_i = 0.8f;
  landing.transmittance = 0.9f;
  landing.path = 2;
  const vec3 got = caustic_intensity({1, 2, 3}, landing, {0, 0.5f, 1}, 1.5f, {0.5f, 0.25f, 1}, vec3{0.1f});
  EXPECT_NEAR(got.x, 1 * 0.8f * 0.9f * 1.5f * 0.5f + 0.1f, 1e-6f);
  EXPECT_NEAR(got.y, 2 * 0.8f * 0.9f * std::exp(-1.0f) * 1.5f * 0.25f + 0.1f, 1e-6f);
  EXPECT_NEAR(got.z, 3 * 0.8f * 0.9f * std::exp(-2.0f) * 1.5f + 0.1f, 1e-6f);
}

TEST(DrawPolygons, ConserveTheirFluxDownToSlivers) {
  std::vector<std::vector<LightPolygon>> lists(3);
  double flux = 0;
  std::uint32_t random = 1;
  const auto next = [&] { return static_cast<float>((random = random * 1664525u + 1013904223u) >> 8) / 16777216.0f; };
  for (int i = 0; i < 600; ++i) {
    LightPolygon polygon;
    const vec2 at{4 + 50 * next(), 4 + 50 * next()};
    const float size = std::pow(10.0f, -3 * next()) * 4;
    const float thin = i % 3 == 0 ? 1e-4f * next() : 1.0f;
    for (vec2& corner : polygon.corner) corner = at + size * vec2{next() - 0.5f, thin * (next() - 0.5f)};
    polygon.flux = vec3{1 + next()};
    flux += static_cast<double>(polygon.flux.x);
    lists[static_cast<std::size_t>(i % 3)].push_back(polygon);
  }
  Image<vec3> image(64, 64);
  draw_polygons(lists, image);
  double drawn = 0;
  for (const vec3& texel : image) drawn += static_cast<double>(texel.x);
  EXPECT_NEAR(drawn / flux, 1.0, 1e-4);
}

TEST(DrawPolygons, CoverTexelsByTheirExactArea) {
  LightPolygon polygon;
  polygon.corner[0] = {1.25f, 1.5f};
  polygon.corner[1] = {3.25f, 1.5f};
  polygon.corner[2] = {1.25f, 3.5f};
  polygon.flux = vec3{2.0f};  // area 2: texels become covered areas
  Image<vec3> image(5, 5);
  draw_polygons({{polygon}}, image);
  EXPECT_NEAR(image(1, 1).x, 0.375f, 1e-5f);
  EXPECT_NEAR(image(2, 1).x, 0.5f - 0.5f * 0.25f * 0.25f, 1e-5f);
  EXPECT_NEAR(image(1, 2).x, 0.75f - 0.5f * 0.25f * 0.25f, 1e-5f);
  EXPECT_EQ(image(4, 1).x, 0.0f);
  EXPECT_EQ(image(0, 1).x, 0.0f);
}

TEST(CausticsOptions, OutsideTheirRangeAreSaidToBe) {
  const Scene scene = floor_under(sun_from({0, 1, 0}));
  const AnalyticWater water = flat_water({1, 1}, 0.5f);
  for (const auto& spoil : std::vector<std::function<void(CausticsOptions&)>>{
           [](auto& o) { o.screen_width = -1; }, [](auto& o) { o.screen_height = 1 << 20; },
           [](auto& o) { o.iterations = 0; }, [](auto& o) { o.threshold = NAN; }, [](auto& o) { o.map_size = 3; },
           [](auto& o) { o.most_lights = -1; }}) {
    CausticsOptions options;
    spoil(options);
    EXPECT_THROW(caustics(water, scene, sea(), options), Error);
  }
}

}  // namespace
}  // namespace meniscus
