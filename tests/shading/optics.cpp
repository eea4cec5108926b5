// The radiance that shade() gives where it is known in closed form. Each effect has a test here that its absence, a
// flipped normal or an absorption off by a tenth fails.
#include <gtest/gtest.h>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>

#include "fixtures.h"

namespace meniscus {
namespace {

using namespace tests;

constexpr float kPi = std::numbers::pi_v<float>;

/// Direction that comes down onto a level surface at this angle of incidence.
vec3 downwards(float angle) { return {std::sin(angle), -std::cos(angle), 0.0f}; }

vec3 one_sample(const View& view, const SurfaceBuffers& buffers, const Scene& scene, const Material& material) {
  const Image<vec3> picture = shade(view, {}, buffers, scene, material);
  return picture(view.width / 2, view.height / 2);
}

TEST(Shade, IsAWhiteFurnaceForWaterWithoutLosses) {
  const Scene scene = without_ground(uniform_environment());
  std::mt19937 random(7);
  std::uniform_real_distribution<float> any(-1.0f, 1.0f);
  const View view = perspective_view({0, 2, 5}, {0, 0, 0}, {0, 1, 0}, 0.7f, 40, 30);
  SurfaceBuffers buffers = even(40, 30, 4.0f, {0, 1, 0}, 0.3f);
  for (vec3& normal : buffers.normal) normal = glm::normalize(vec3{any(random), any(random), any(random)} + 1e-3f);
  for (float& thickness : buffers.thickness) thickness = 1.0f + any(random);
  for (const float roughness : {0.0f, 0.3f, 1.0f}) {
    Material material = clear();
    material.roughness = roughness;
    for (const vec3& radiance : shade(view, {}, buffers, scene, material))
      EXPECT_LT(glm::length(radiance - vec3{1.0f}), 1e-5f);
    buffers.eye_in_water = true;
    for (const vec3& radiance : shade(view, {}, buffers, scene, material))
      EXPECT_LT(glm::length(radiance - vec3{1.0f}), 1e-5f);
    buffers.eye_in_water = false;
  }
}

TEST(Shade, AbsorbsAlongTheRefractedPathThroughASlab) {
  // One slab under uniform light: R + (1 - R) exp(-sigma t cos_i / cos_t), t along the straight ray.
  const Scene scene = without_ground(uniform_environment());
  Material material = clear();
  material.extinction = {0.2f, 1.0f, 3.0f};
  for (const float angle : {0.0f, 0.3f, 0.8f, 1.2f}) {
    const float thickness = 0.7f;
    const vec3 seen = one_sample(looking(downwards(angle)), even(8, 6, 5.0f, {0, 1, 0}, thickness), scene, material);
    const double r = reflectance(angle, 1.333), cos_t = std::sqrt(1 - std::pow(std::sin(angle) / 1.333, 2));
    for (int k = 0; k < 3; ++k) {
      const double path = thickness * std::cos(angle) / cos_t;
      EXPECT_NEAR(seen[k], r + (1 - r) * std::exp(-static_cast<double>(material.extinction[k]) * path), 2e-5)
          << angle << " " << k;
    }
  }
}

TEST(Shade, ShowsTheGroundUnderALevelPoolThroughItsDepth) {
  // The ray bends down to the ground: its path is the depth over cos_t, at every angle.
  Ground ground;
  ground.albedo = vec3{0.6f};
  ground.height = -0.5f;
  const Scene scene(uniform_environment(), ground);
  Material material = clear();
  material.extinction = {0.5f, 1.0f, 2.0f};
  for (const float angle : {0.0f, 0.5f, 1.0f}) {
    const vec3 seen =
        one_sample(looking(downwards(angle)), even(8, 6, 5.0f, {0, 1, 0}, 0.5f / std::cos(angle)), scene, material);
    const double r = reflectance(angle, 1.333), cos_t = std::sqrt(1 - std::pow(std::sin(angle) / 1.333, 2));
    const double path = 0.5 / cos_t;
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(seen[k], r + (1 - r) * 0.6 * std::exp(-static_cast<double>(material.extinction[k]) * path), 1e-4);
  }
}

TEST(Shade, EndsTheWaterAtTheGround) {
  Ground ground;
  ground.albedo = vec3{1.0f};
  ground.height = -0.1f;
  const Scene scene(uniform_environment(), ground);
  Material material = clear();
  material.extinction = vec3{2.0f};
  material.specular = 0;
  const vec3 seen = one_sample(looking({0, -1, 0}), even(8, 6, 5.0f, {0, 1, 0}, 50.0f), scene, material);
  EXPECT_NEAR(seen.y, std::exp(-0.2f), 1e-4f);
}

TEST(Shade, ReflectsTheSkyAndNotTheDepthsInALevelMirror) {
  // The sky is white, everything below is black: only the mirror image is seen, and its strength is Fresnel's.
  const Scene scene = without_ground(half_lit_environment());
  for (const float angle : {0.2f, 0.7f, 1.1f, 1.45f}) {
    const vec3 seen = one_sample(looking(downwards(angle)), even(8, 6, 5.0f, {0, 1, 0}, 1.0f), scene, clear());
    EXPECT_NEAR(seen.y, reflectance(angle, 1.333), 1e-4) << angle;
  }
}

TEST(Shade, BecomesAMirrorAtGrazingIncidence) {
  const Scene scene = without_ground(half_lit_environment());
  Material ink = clear();
  ink.extinction = vec3{1e4f};
  const vec3 grazing = one_sample(looking(downwards(1.55f)), even(8, 6, 5.0f, {0, 1, 0}, 1.0f), scene, ink);
  const vec3 steep = one_sample(looking(downwards(0.1f)), even(8, 6, 5.0f, {0, 1, 0}, 1.0f), scene, ink);
  EXPECT_NEAR(grazing.y, reflectance(1.55, 1.333), 0.02);
  EXPECT_NEAR(steep.y, 0.0204f, 5e-4f);
}

TEST(Shade, BendsTheRayTowardsTheNormal) {
  // Through a wall one looks less steeply down than along the ray: the ray meets the ground further away.
  Ground ground;
  ground.square = 0.4f;
  ground.albedo = {1, 0, 0};
  ground.second_albedo = {0, 0, 1};
  ground.height = -1.0f;
  const Scene scene(uniform_environment(), ground);
  Material material = clear();
  material.specular = 0;
  const vec3 direction = glm::normalize(vec3{1, -1, 0.013f});
  const View view = looking(direction);
  const vec3 seen = one_sample(view, even(8, 6, 5.0f, {-1, 0, 0}, 1e3f), scene, material);
  // Snell on the wall: sin_t = sin_i / 1.333 in the plane of incidence.
  const Ray ray = view.ray({4.5f, 3.5f});
  const vec3 tangential{0.0f, ray.direction.y / 1.333f, ray.direction.z / 1.333f};
  const vec3 inside{std::sqrt(1.0f - glm::dot(tangential, tangential)), tangential.y, tangential.z};
  const vec3 entry = ray.origin + 5.0f * ray.direction;
  const vec3 expected = scene.radiance({entry, inside}, 1e-3f);
  const vec3 straight = scene.radiance({entry, ray.direction}, 1e-3f);
  EXPECT_LT(glm::length(seen - expected), 0.05f);
  EXPECT_GT(glm::length(straight - expected), 0.5f) << "the test must tell bent from straight";
}

TEST(Shade, ShowsTheBodyOfTurbidWater) {
  const Scene scene = without_ground(uniform_environment());
  Material milk = clear();
  milk.specular = 0;
  milk.scattering = vec3{50.0f};
  milk.body = {0.9f, 0.8f, 0.7f};
  const vec3 deep = one_sample(looking({0, -1, 0}), even(8, 6, 5.0f, {0, 1, 0}, 5.0f), scene, milk);
  EXPECT_LT(glm::length(deep - milk.body), 1e-4f) << "a white sky of radiance one shows the body's colour";
  // Half of what comes from behind, half body, where exp(-sigma t) = 1/2.
  const vec3 thin = one_sample(looking({0, -1, 0}), even(8, 6, 5.0f, {0, 1, 0}, std::log(2.0f) / 50.0f), scene, milk);
  EXPECT_LT(glm::length(thin - 0.5f * (milk.body + 1.0f)), 1e-4f);
}

TEST(Shade, LightsOpaqueBodiesByLambertsLaw) {
  Material clay = material_preset("clay", 1.0f);
  const vec3 uniform =
      one_sample(looking({0, -1, 0}), even(8, 6, 5.0f, {0, 1, 0}, 1.0f), without_ground(uniform_environment()), clay);
  EXPECT_LT(glm::length(uniform - clay.body), 1e-4f);
  const Environment sky{EnvironmentOptions{}};
  const vec3 normal = glm::normalize(vec3{-0.4f, 0.9f, 0.2f});
  const vec3 seen = one_sample(looking({0, -1, 0}), even(8, 6, 5.0f, normal, 1.0f), without_ground(sky), clay);
  const vec3 expected =
      clay.body * (sky.irradiance(normal) + glm::dot(normal, sky.sun_direction()) * sky.sun_irradiance()) / kPi;
  EXPECT_LT(glm::length(seen - expected), 1e-4f);
}

TEST(Shade, GivesPlasticItsGlossWithoutMakingLight) {
  Material plastic = material_preset("plastic", 1.0f);
  plastic.body = vec3{1.0f};
  const vec3 seen = one_sample(looking(downwards(1.0f)), even(8, 6, 5.0f, {0, 1, 0}, 1.0f),
                               without_ground(uniform_environment()), plastic);
  EXPECT_LT(glm::length(seen - vec3{1.0f}), 1e-4f);
  plastic.body = vec3{0.0f};
  const vec3 gloss = one_sample(looking(downwards(1.0f)), even(8, 6, 5.0f, {0, 1, 0}, 1.0f),
                                without_ground(uniform_environment()), plastic);
  EXPECT_NEAR(gloss.y, reflectance(1.0, 1.5), 1e-4);
}

TEST(Shade, GlintsWhereTheMirrorShowsTheSunAndOnlyThere) {
  const Environment sky{EnvironmentOptions{}};
  const Scene scene = without_ground(sky);
  const vec3 down = glm::normalize(vec3{0.2f, -0.9f, -0.1f});
  const vec3 half_way = glm::normalize(sky.sun_direction() - down);
  const vec3 beside = glm::normalize(half_way + vec3{0.2f, 0, 0});
  Material ink = clear();
  ink.extinction = vec3{1e4f};
  EXPECT_GT(one_sample(looking(down), even(8, 6, 5.0f, half_way, 1.0f), scene, ink).y, 0.3f);
  EXPECT_LT(one_sample(looking(down), even(8, 6, 5.0f, beside, 1.0f), scene, ink).y, 0.05f);
}

TEST(Shade, DimsGlintsWhereNormalsVaryBetweenPixels) {
  const Environment sky{EnvironmentOptions{}};
  const Scene scene = without_ground(sky);
  const vec3 down = glm::normalize(vec3{0.2f, -0.9f, -0.1f});
  const vec3 half_way = glm::normalize(sky.sun_direction() - down);
  SurfaceBuffers buffers = even(8, 6, 5.0f, half_way, 1.0f);
  const float even_glint = one_sample(looking(down), buffers, scene, clear()).y;
  for (int y = 0; y < 6; y += 2)
    for (int x = 0; x < 8; ++x) buffers.normal(x, y) = glm::normalize(half_way + vec3{0.15f, 0, 0});
  EXPECT_LT(one_sample(looking(down), buffers, scene, clear()).y, 0.7f * even_glint);
}

TEST(ShadeUnderWater, ShowsTheSkyOnlyWithinSnellsWindow) {
  // White sky above, black below; the critical angle of water is 48.6 degrees.
  const Scene scene = without_ground(half_lit_environment());
  for (const float angle : {0.1f, 0.5f, 0.75f, 0.95f, 1.3f}) {
    SurfaceBuffers buffers = even(8, 6, 5.0f, {0, 1, 0}, 5.0f);
    buffers.eye_in_water = true;
    const vec3 seen = one_sample(looking({std::sin(angle), std::cos(angle), 0}), buffers, scene, clear());
    const bool inside = std::sin(angle) * 1.333f < 1.0f;
    const double expected = inside ? 1.0 - reflectance(angle, 1.0 / 1.333) : 0.0;
    EXPECT_NEAR(seen.y, expected, 2e-3) << angle;
  }
}

TEST(ShadeUnderWater, AbsorbsOverTheDistanceToTheSurface) {
  const Scene scene = without_ground(half_lit_environment());
  SurfaceBuffers buffers = even(8, 6, 5.0f, {0, 1, 0}, 0.0f);
  buffers.eye_in_water = true;
  Material material = clear();
  material.extinction = {0.1f, 0.2f, 0.4f};
  const vec3 seen = one_sample(looking({0, 1, 0}), buffers, scene, material);
  for (int k = 0; k < 3; ++k)
    EXPECT_NEAR(seen[k], (1 - reflectance(0, 1 / 1.333)) * std::exp(-5.0 * static_cast<double>(material.extinction[k])),
                1e-4);
}

TEST(ShadeUnderWater, FadesToTheColourOfTheDeepWhereThereIsNoSurface) {
  const Scene scene = without_ground(Environment{EnvironmentOptions{}});
  SurfaceBuffers buffers = even(8, 6, std::numeric_limits<float>::infinity(), vec3{0.0f}, 0.0f);
  buffers.coverage = Image<float>(8, 6, 0.0f);
  buffers.eye_in_water = true;
  const Material water = material_preset("water", 1.0f);
  const vec3 ahead = one_sample(looking({1, 0.1f, 0}), buffers, scene, water);
  const vec3 below = one_sample(looking({1, -0.7f, 0}), buffers, scene, water);
  EXPECT_LT(glm::length(ahead - below), 1e-5f);
  EXPECT_GT(ahead.z, 0.02f) << "not black";
  EXPECT_GT(ahead.z, 2.0f * ahead.x) << "blue";
}

}  // namespace
}  // namespace meniscus
