#include <gtest/gtest.h>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "scene/scene_of.h"

namespace meniscus {
namespace {

const glm::mat4 kHere(1.0f);

/// A ground in the light with these solids on it.
Scene on_ground(std::vector<PlacedSolid> solids) {
  Scene scene(test_sky(), Ground{});
  scene.set_solids(std::move(solids));
  return scene;
}

vec3 sky_light(vec3 normal) { return test_sky().irradiance(normal); }
vec3 sun_light(vec3 normal) {
  return test_sky().sun_irradiance() * std::max(0.0f, glm::dot(normal, test_sky().sun_direction()));
}

void expect_near(vec3 a, vec3 b, float relative = 1e-4f) {
  EXPECT_LT(glm::length(a - b), relative * glm::length(b)) << a.x << " " << b.x;
}

TEST(SolidLight, IsSunAndSkyWhereNothingStandsBefore) {
  const Scene scene = on_ground({{make_solid(box_mesh({-0.5f, 0, -0.5f}, {0.5f, 1, 0.5f})), kHere, {}}});
  const vec3 up{0, 1, 0};
  expect_near(scene.irradiance({0.1f, 1, 0.1f}, up, up), sky_light(up) + sun_light(up));
  expect_near(scene.irradiance({3, 0, 3}, up, up), sky_light(up) + sun_light(up));
}

TEST(SolidLight, OfTheSunIsGoneInAShadowThatEndsWhereGeometrySays) {
  const Scene scene = on_ground({{make_solid(box_mesh({-0.5f, 0, -0.5f}, {0.5f, 1, 0.5f})), kHere, {}}});
  const vec3 up{0, 1, 0}, sun = test_sky().sun_direction();
  // The corner (-0.5, 1, -0.5) throws its shadow the farthest.
  const vec3 tip = vec3{-0.5f, 1, -0.5f} - sun / sun.y;
  const vec3 outwards = glm::normalize(vec3{-sun.x, 0, -sun.z});
  const vec3 full = sky_light(up) + sun_light(up);
  expect_near(scene.irradiance(tip - 0.02f * outwards, up, up), sky_light(up));
  expect_near(scene.irradiance(tip + 0.02f * outwards, up, up), full);
  // The penumbra of a disc of half a degree, 1.3 m away: no wider than 2 cm, from one to the other without going back.
  float last = scene.irradiance(tip - 0.02f * outwards, up, up).y;
  bool between = false;
  for (float x = -0.02f; x < 0.02f; x += 0.0005f) {
    const float now = scene.irradiance(tip + x * outwards, up, up).y;
    EXPECT_GE(now, last * 0.9999f);
    between = between || (now > 1.1f * sky_light(up).y && now < 0.9f * full.y);
    last = now;
  }
  EXPECT_TRUE(between) << "the edge is soft";
}

TEST(SolidLight, HasNoAcneOnItsOwnSurface) {
  // Far from the origin, seen from far away, at low light.
  for (const float scale : {0.01f, 1.0f, 100.0f}) {
    const vec3 centre = scale * vec3{20, 3, -10};
    Ground none;
    none.visible = false;
    Scene scene(test_sky(), none);
    scene.set_solids({{make_solid(sphere_mesh(centre, scale, 200)), kHere, {}}});
    const vec3 eye = centre + scale * vec3{5, 6, 9};
    const View view = perspective_view(eye, centre, {0, 1, 0}, 0.25f, 60, 60);
    const SceneBuffers seen = scene.see(view);
    int lit = 0;
    for (std::size_t i = 0; i < seen.depth.size(); ++i) {
      const vec3 n = seen.normal[i];
      if (glm::dot(n, n) == 0 || glm::dot(n, test_sky().sun_direction()) < 0.05f) continue;
      const vec3 expected = 0.6f / std::numbers::pi_v<float> * (sky_light(n) + sun_light(n));
      EXPECT_LT(glm::length(seen.radiance[i] - expected), 0.02f * glm::length(expected)) << scale << " " << i;
      ++lit;
    }
    EXPECT_GT(lit, 1000);
  }
}

TEST(SolidLight, DoesNotLeakThroughToTheFarSide) {
  // A coarse ball: interpolated normals see the sun where the flat faces do not.
  const Scene scene = scene_of({{make_solid(sphere_mesh({0, 0, 0}, 1, 12)), kHere, {}}});
  const vec3 sun = test_sky().sun_direction();
  for (int i = 0; i < 400; ++i) {
    const float z = 1 - (static_cast<float>(i) + 0.5f) / 200, phi = 2.4f * static_cast<float>(i);
    const vec3 d = {std::sqrt(1 - z * z) * std::cos(phi), z, std::sqrt(1 - z * z) * std::sin(phi)};
    const Ray ray{3.0f * d, -d};
    const SolidHit hit = scene.hit(ray);
    ASSERT_TRUE(hit.found());
    const vec3 extra = scene.irradiance(ray.origin + hit.distance * ray.direction, hit.normal, hit.face_normal) -
                       sky_light(hit.normal);
    if (glm::dot(hit.face_normal, sun) <= 0) {
      EXPECT_LT(glm::length(extra), 1e-5f);
    } else if (glm::dot(hit.face_normal, sun) > 0.4f) {
      EXPECT_GT(extra.y, 0.7f * sun_light(hit.normal).y);
      EXPECT_LT(extra.y, 1.0001f * sun_light(hit.normal).y);
    }
  }
}

TEST(SolidLight, FadesOutBeforeItsFaceTurnsAway) {
  // The interpolated normal leans towards a lamp that goes down behind the flat face: nothing of the cosine is left
  // when the face itself turns away, and on the way there it does not jump.
  const vec3 face{0, 1, 0}, normal = glm::normalize(vec3{0.5f, 1, 0});
  const auto lamp_light = [&](float elevation) {
    Ground none;
    none.visible = false;
    Scene scene(test_sky(), none);
    const float dark = scene.irradiance({0, 0, 0}, normal, face).y;
    scene.set_lamps({{vec3{std::cos(elevation), std::sin(elevation), 0}, vec3{1.0f}}});
    return scene.irradiance({0, 0, 0}, normal, face).y - dark;
  };
  const vec3 high{std::cos(1.4f), std::sin(1.4f), 0};
  EXPECT_NEAR(lamp_light(1.4f), glm::dot(normal, high), 0.01f);
  EXPECT_NEAR(lamp_light(-0.01f), 0.0f, 1e-6f);
  for (float elevation = -0.1f; elevation < 1.0f; elevation += 0.01f)
    EXPECT_LT(std::abs(lamp_light(elevation + 0.01f) - lamp_light(elevation)), 0.05f) << elevation;
}

TEST(SolidLight, OfALampFallsWithTheSquareOfTheDistanceAndTheCosine) {
  Scene scene = on_ground({{make_solid(sphere_mesh({5, 1, 0}, 0.2f)), kHere, {}}});
  const vec3 up{0, 1, 0};
  const vec3 lamp{2, 3, 0}, intensity{7, 8, 9};
  const Scene dark = scene;
  scene.set_lamps({{lamp, intensity}, {{0, -4, 0}, vec3{100.0f}}});  // the second one stands behind the surface
  for (const vec3 point : {vec3{2, 0, 0}, vec3{0, 0, 1}, vec3{-3, 0, -2}}) {
    const vec3 way = lamp - point;
    const float squared = glm::dot(way, way);
    expect_near(scene.irradiance(point, up, up) - dark.irradiance(point, up, up),
                intensity * (way.y / std::sqrt(squared) / squared), 1e-3f);
  }
  // Behind the ball: from the lamp at (2, 3, 0) through (5, 1, 0) to the ground at (6.5, 0, 0).
  EXPECT_EQ(scene.irradiance({6.5f, 0, 0}, up, up), dark.irradiance({6.5f, 0, 0}, up, up));
  EXPECT_TRUE(scene.blocked(lamp, {6.5f, 0, 0}));
  EXPECT_FALSE(scene.blocked(lamp, {7.5f, 0, 0}));
  EXPECT_TRUE(scene.blocked(lamp, {7.5f, -0.1f, 0})) << "the ground stands between";
}

TEST(SolidLight, RefusesLampsThatTakeLightAway) {
  Scene scene(test_sky(), Ground{});
  EXPECT_THROW(scene.set_lamps({{{0, 1, 0}, {1, -1, 1}}}), Error);
  EXPECT_THROW(scene.set_lamps({{{std::nanf(""), 1, 0}, vec3{1.0f}}}), Error);
}

class Underwater : public WaterLight {
  Light at(vec3 point, vec3 normal) const override {
    Light light;
    light.sun = {0.5f, 0.25f, 0.125f};
    light.sky = {0.75f, 0.5f, 0.25f};
    light.lamps = vec3{0.1f};
    light.refracted = {point.x, 2.0f, normal.y};
    return light;
  }
};

TEST(SolidLight, IsWhatTheWaterLeavesAndBrings) {
  const auto box = make_solid(box_mesh({-0.5f, 0, -0.5f}, {0.5f, 1, 0.5f}));
  Scene scene = on_ground({{box, kHere, {}}});
  scene.set_lamps({{{0, 3, 0}, vec3{4.0f}}});
  scene.set_water_light(std::make_shared<Underwater>());
  const vec3 up{0, 1, 0};
  expect_near(scene.irradiance({0.25f, 1, 0}, up, up),
              sky_light(up) * vec3{0.75f, 0.5f, 0.25f} + sun_light(up) * vec3{0.5f, 0.25f, 0.125f} +
                  vec3{0.25f, 2.0f, 1.0f} + vec3{0.1f * 4.0f * 2.0f / std::pow(4.0f + 0.0625f, 1.5f)});
  // In the box's shadow from both, bent light and sky's light stay.
  const vec3 shade = {-0.55f, 0, -0.55f};
  expect_near(scene.irradiance(shade, up, up), sky_light(up) * vec3{0.75f, 0.5f, 0.25f} + vec3{-0.55f, 2.0f, 1.0f});
}

TEST(Coat, MirrorsTheSkyByFresnelsShare) {
  const SolidMaterial mirror{vec3{0.0f}, {}, 0.0f, 1.5f};
  const Scene scene = scene_of({{make_solid(box_mesh({-5, -1, -5}, {5, 0, 5})), kHere, mirror}});
  for (const vec3 direction : {vec3{0, -1, 0}, glm::normalize(vec3{1, -1, 0}), glm::normalize(vec3{-1, -0.2f, 0})}) {
    const Ray ray{-direction, direction};
    const double c = -direction.y, t = std::sqrt(1 - (1 - c * c) / 2.25);
    const double s_part = (c - 1.5 * t) / (c + 1.5 * t), p_part = (1.5 * c - t) / (1.5 * c + t);
    const auto reflectance = static_cast<float>(0.5 * (s_part * s_part + p_part * p_part));
    expect_near(scene.radiance(ray, 1e-4f), reflectance * test_sky().radiance({direction.x, -direction.y, 0}), 2e-3f);
  }
}

TEST(Coat, ShowsTheSunWhereItMirrorsItAndOnlyInTheLight) {
  const SolidMaterial gloss{vec3{0.0f}, {}, 0.2f, 1.5f};
  const auto floor = make_solid(box_mesh({-5, -1, -5}, {5, 0, 5}));
  const vec3 sun = test_sky().sun_direction(), down{sun.x, -sun.y, sun.z};
  const Ray ray{-2.0f * down, down};
  const float bright = scene_of({{floor, kHere, gloss}}).radiance(ray, 1e-4f).y;
  // A plate far above between the point and the sun.
  const vec3 above = 4.0f * sun;
  const auto plate = make_solid(box_mesh(above - vec3{0.4f, 0.01f, 0.4f}, above + vec3{0.4f, 0.01f, 0.4f}));
  const float shaded = scene_of({{floor, kHere, gloss}, {plate, kHere, {}}}).radiance(ray, 1e-4f).y;
  EXPECT_GT(bright, 5.0f * shaded);
}

TEST(Coat, OfRoughnessOneIsNone) {
  const auto floor = make_solid(box_mesh({-5, -1, -5}, {5, 0, 5}));
  const Ray ray{{0, 1, 0}, glm::normalize(vec3{1, -0.3f, 0})};
  const vec3 up{0, 1, 0};
  expect_near(scene_of({{floor, kHere, {}}}).radiance(ray, 1e-4f),
              0.6f / std::numbers::pi_v<float> * (sky_light(up) + sun_light(up)));
}

}  // namespace
}  // namespace meniscus
