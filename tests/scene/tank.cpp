#include <gtest/gtest.h>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>

#include "scene/scene_of.h"
#include "scene/tiles.h"

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

Tank tank_of(TankStyle style, vec3 low = {-1, 0, -2}, vec3 high = {1, 1, 2}) {
  Tank tank;
  tank.style = style;
  tank.inside.add(low);
  tank.inside.add(high);
  tank.thickness = 0.1f;
  return tank;
}

Scene with_tank(const Tank& tank) {
  Scene scene(test_sky(), Ground{});
  scene.set_tank(tank);
  return scene;
}

TEST(Tiles, JointsAreMeansOfManyPoints) {
  for (const float width : {0.02f, 0.1f, 0.45f, 1.3f, 6.0f})
    for (float x = -1.4f; x < 1.5f; x += 0.083f) {
      double sum = 0, weights = 0;
      for (int i = 0; i < 4000; ++i) {
        const double u = (i + 0.5) / 2000 - 1, at = x + width * u;
        weights += 1 - std::abs(u);
        if (at - std::floor(at) < 0.07) sum += 1 - std::abs(u);
      }
      EXPECT_NEAR(pulse_mean(x, width, 0.07f), sum / weights, 4e-3) << x << " " << width;
    }
  EXPECT_NEAR(joint_fraction({0.5f, 0.5f}, {0, 0}, 0.05f), 0.0f, 1e-3f);
  EXPECT_NEAR(joint_fraction({0.5f, 1.0f}, {0, 0}, 0.05f), 1.0f, 1e-3f);
  EXPECT_NEAR(joint_fraction({0.3f, 0.1f}, {90, 90}, 0.05f), 1 - 0.95f * 0.95f, 1e-4f);
}

TEST(TiledTank, IsSeenFromInsideAndNotFromOutside) {
  const Scene scene = with_tank(tank_of(TankStyle::tiled));
  // From inside: each wall and the floor.
  const vec3 middle{0.1f, 0.4f, 0.2f};
  EXPECT_NEAR(scene.distance({middle, {1, 0, 0}}), 0.9f, 1e-5f);
  EXPECT_NEAR(scene.distance({middle, {-1, 0, 0}}), 1.1f, 1e-5f);
  EXPECT_NEAR(scene.distance({middle, {0, 0, 1}}), 1.8f, 1e-5f);
  EXPECT_NEAR(scene.distance({middle, {0, 0, -1}}), 2.2f, 1e-5f);
  EXPECT_NEAR(scene.distance({middle, {0, -1, 0}}), 0.4f, 1e-5f);
  EXPECT_EQ(scene.distance({middle, {0, 1, 0}}), kInfinity);
  EXPECT_EQ(scene.hit({middle, {1, 0, 0}}).normal, (vec3{-1, 0, 0}));
  // From outside through the near wall to the far one.
  const SolidHit hit = scene.hit({{5, 0.4f, 0}, {-1, 0, 0}});
  EXPECT_NEAR(hit.distance, 6.0f, 1e-5f);
  EXPECT_EQ(hit.normal, (vec3{1, 0, 0}));
  EXPECT_EQ(scene.distance({{5, 1.4f, 0}, {-1, 0, 0}}), kInfinity) << "over it";
}

TEST(TiledTank, LetsLightInOverItsRimOnly) {
  const Tank tank = tank_of(TankStyle::tiled);
  const Scene scene = with_tank(tank);
  const vec3 up{0, 1, 0}, sun = test_sky().sun_direction();
  const vec3 sky = test_sky().irradiance(up), open = sky + test_sky().sun_irradiance() * sun.y;
  // Points of the floor, from which the way to the sun leaves the tank through its top or through a wall.
  int lit = 0, dark = 0;
  for (float x = tank.inside.low.x + 0.05f; x < tank.inside.high.x; x += 0.1f)
    for (float z = tank.inside.low.z + 0.05f; z < tank.inside.high.z; z += 0.1f) {
      const vec3 point{x, tank.inside.low.y, z};
      const vec3 rim = point + sun * ((tank.inside.high.y - point.y) / sun.y);
      const bool passes = rim.x > tank.inside.low.x && rim.x < tank.inside.high.x && rim.z > tank.inside.low.z &&
                          rim.z < tank.inside.high.z;
      ++(passes ? lit : dark);
      EXPECT_EQ(scene.shadowed(point + 0.01f * up, sun), !passes) << x << " " << z;
      EXPECT_LT(glm::length(scene.irradiance(point, up, up) - (passes ? open : sky)), 1e-4f) << x << " " << z;
    }
  EXPECT_GT(lit, 10);
  EXPECT_GT(dark, 10);
  EXPECT_TRUE(scene.blocked({0, 0.5f, 0}, {4, 0.5f, 0}));
  EXPECT_TRUE(scene.blocked({4, 0.5f, 0}, {0, 0.5f, 0}));
}

TEST(TiledTank, KeepsLightFromWaterThatBulgesThroughAWall) {
  const Tank tank = tank_of(TankStyle::tiled);
  const Scene scene = with_tank(tank);
  const float beyond = tank.inside.high.x + 0.01f, height = 0.5f * (tank.inside.low.y + tank.inside.high.y);
  EXPECT_TRUE(scene.shadowed({beyond, height, 0}, glm::normalize(vec3{1, 1, 0})));
  EXPECT_FALSE(scene.shadowed({beyond + 1, height, 0}, glm::normalize(vec3{1, 1, 0}))) << "outside";
}

TEST(TiledTank, FloorCoversTheGroundThatItLiesOn) {
  Tank tank = tank_of(TankStyle::tiled);
  tank.albedo = tank.joint_albedo = {0.1f, 0.2f, 0.3f};
  const Scene scene = with_tank(tank);
  for (float x = -0.95f; x < 1; x += 0.19f) {
    const vec3 eye{3, 40, 5};
    EXPECT_EQ(scene.hit({eye, glm::normalize(vec3{x, 0, 0.1f} - eye)}).albedo, tank.albedo);
  }
  EXPECT_EQ(scene.hit({{1.5f, 3, 0}, {0, -1, 0}}).albedo, Ground{}.albedo);
}

TEST(TiledTank, SunkIntoTheGroundIsAPool) {
  const Scene scene = with_tank(tank_of(TankStyle::tiled, {-1, -2, -1}, {1, 0, 1}));
  EXPECT_NEAR(scene.distance({{0.3f, 1, 0}, {0, -1, 0}}), 3.0f, 1e-5f) << "its floor";
  EXPECT_NEAR(scene.distance({{1.5f, 1, 0}, {0, -1, 0}}), 1.0f, 1e-5f) << "the ground beside it";
  EXPECT_NEAR(scene.distance({{0, -1, 0}, glm::normalize(vec3{1, -0.1f, 0})}), std::sqrt(1.01f), 1e-5f)
      << "its wall, seen from under the ground's plane";
}

TEST(TiledTank, HasNoGapsInItsCorners) {
  for (const int up : {0, 1, 2}) {
    vec3 low{-1.1f, -0.7f, -1.3f}, high{0.9f, 1.3f, 0.8f};
    Tank tank = tank_of(TankStyle::tiled, low, high);
    tank.up = vec3{0.0f};
    tank.up[up] = 1;
    Ground none;
    none.visible = false;
    Scene scene(test_sky(), none);
    scene.set_tank(tank);
    const vec3 eye{0.123f, 0.217f, -0.331f};
    // Towards every point of every lower and upright edge.
    for (int axis = 0; axis < 3; ++axis)
      for (int k = 0; k < 4; ++k)
        for (int i = 1; i < 200; ++i) {
          const int s = (axis + 1) % 3, t = (axis + 2) % 3;
          vec3 point;
          point[axis] = low[axis] + (high[axis] - low[axis]) * static_cast<float>(i) / 200.0f;
          point[s] = k & 1 ? high[s] : low[s];
          point[t] = k & 2 ? high[t] : low[t];
          if ((s == up || t == up) && point[up] == high[up]) continue;
          const float length = glm::length(point - eye);
          ASSERT_NEAR(scene.distance({eye, (point - eye) / length}), length, 1e-4f) << up << axis << k << i;
        }
  }
}

TEST(TiledTank, TilesFadeIntoTheirMean) {
  const Tank tank = tank_of(TankStyle::tiled);
  const Scene scene = with_tank(tank);
  const float joints = 1 - 0.95f * 0.95f;
  const vec3 mean = (1 - joints) * tank.albedo + joints * tank.joint_albedo;
  for (float x = -0.9f; x < 1; x += 0.13f)
    EXPECT_LT(glm::length(scene.hit({{x, 3, 0.2f}, {0, -1, 0}}, {0, 1.0f}).albedo - mean), 5e-3f);
}

TEST(GlassTank, ShowsItsEdgesAndLetsTheRestThrough) {
  const Scene scene = with_tank(tank_of(TankStyle::glass));
  EXPECT_EQ(scene.distance({{5, 0.5f, 0.3f}, {-1, 0, 0}}), kInfinity);
  const SolidHit upper = scene.hit({{5, 0.95f, 0.3f}, {-1, 0, 0}});
  EXPECT_NEAR(upper.distance, 3.9f, 1e-5f);
  EXPECT_EQ(upper.normal, (vec3{1, 0, 0}));
  EXPECT_NEAR(scene.distance({{5, 0.5f, 2.05f}, {-1, 0, 0}}), 3.9f, 1e-5f) << "an upright edge";
  EXPECT_NEAR(scene.distance({{5, 0.05f, 0.3f}, {-1, 0, 0}}), 3.9f, 1e-5f) << "a lower edge";
  EXPECT_NEAR(scene.distance({{0, 3, 0}, {0, -1, 0}}), 3.0f, 1e-5f) << "its floor is the ground";
  EXPECT_NEAR(scene.hit({{5, 0.95f, 0.3f}, {-1, 0, 0}}, {}, 4.5f).distance, 6.0f, 1e-5f) << "the far one after that";
}

TEST(GlassTank, PanesReflectAndTintByFresnelAndTheWayThroughThem) {
  Tank tank = tank_of(TankStyle::glass);
  tank.glass_tint = {0.9f, 0.8f, 0.7f};
  const Scene scene = with_tank(tank);
  const Ray ray{{5, 0.5f, 0.3f}, {-1, 0, 0}};
  EXPECT_EQ(scene.glass(ray, 3.5f).transmittance, vec3{1.0f}) << "before the first pane";
  EXPECT_EQ(scene.glass(ray, 3.5f).added, vec3{0.0f});
  // Straight on: R = 0.04 a face, both faces 2 R / (1 + R).
  const float pass = 1 - 0.08f / 1.04f;
  const GlassPane one = scene.glass(ray, 5), two = scene.glass(ray, 50);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(one.transmittance[c], pass * tank.glass_tint[c], 1e-5f);
    EXPECT_NEAR(two.transmittance[c], pass * pass * tank.glass_tint[c] * tank.glass_tint[c], 1e-5f);
    const float mirror = scene.radiance({{1.2f, 0.5f, 0.3f}, {1, 0, 0}}, 0.0f)[c];
    EXPECT_NEAR(one.added[c], 0.08f / 1.04f * mirror, 1e-4f);
    EXPECT_GT(two.added[c], one.added[c]);
  }
  tank.glass_tint = vec3{1.0f};
  const Scene clear = with_tank(tank);
  const GlassPane slanted = clear.glass({{5, 0.5f, 0.3f}, glm::normalize(vec3{-1, 0.02f, 0.35f})}, 5);
  EXPECT_GT(slanted.transmittance.x, 0.5f);
  EXPECT_LT(slanted.transmittance.x, pass + 1e-4f);
}

TEST(GlassTank, TintsTheSunAndTheLampsAndBlocksNeither) {
  Tank tank = tank_of(TankStyle::glass, {-2, 0, -2}, {2, 2, 2});
  tank.glass_tint = vec3{0.5f};
  Scene scene = with_tank(tank);
  const vec3 up{0, 1, 0}, sun = test_sky().sun_direction();
  const vec3 sky = test_sky().irradiance(up), full = sky + test_sky().sun_irradiance() * sun.y;
  // The sun stands at (0.40, 0.80, 0.45) / 1: from the middle it shines over the walls, from the lee of one through it.
  EXPECT_LT(glm::length(scene.irradiance({-1, 0, -1}, up, up) - full), 1e-4f);
  const vec3 through = scene.irradiance({1.8f, 0, 0}, up, up) - sky;
  EXPECT_LT(through.y, 0.5f * (full - sky).y);
  EXPECT_GT(through.y, 0.2f * (full - sky).y);
  EXPECT_FALSE(scene.shadowed({1.8f, 0, 0}, sun));
}

TEST(Tank, RefusesWhatIsNone) {
  Scene scene(test_sky(), Ground{});
  Tank tank = tank_of(TankStyle::tiled);
  tank.up = {0, 0.7f, 0.7f};
  EXPECT_THROW(scene.set_tank(tank), Error);
  EXPECT_THROW(scene.set_tank(tank_of(TankStyle::glass, {0, 0, 0}, {1, 0, 1})), Error);
  tank = tank_of(TankStyle::tiled);
  tank.tile = -1;
  EXPECT_THROW(scene.set_tank(tank), Error);
  tank = tank_of(TankStyle::glass);
  tank.glass_tint = vec3{1.5f};
  EXPECT_THROW(scene.set_tank(tank), Error);
  EXPECT_NO_THROW(scene.set_tank(Tank{})) << "no tank at all";
  EXPECT_TRUE(scene.solid_bounds().empty());
  EXPECT_EQ(tank_style_of("glass"), TankStyle::glass);
  EXPECT_THROW(tank_style_of("brick"), Error);
}

}  // namespace
}  // namespace meniscus
