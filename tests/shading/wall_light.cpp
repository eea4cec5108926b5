#include "shading/wall_light.h"

#include <gtest/gtest.h>
#include <glm/common.hpp>

#include "caustics_fields.h"

namespace meniscus {
namespace {

using tests::at_angle;
using tests::crossing;
using tests::field_of;
using tests::still;
using tests::Wave;

constexpr double kEta = static_cast<double>(1.333f);

WallLight walls_of(const HeightField& field, vec3 sun, float top, int size = 128) {
  const auto level = std::make_shared<const WaterLevel>(field);
  const EnteringLight light = entering_light(level->frame(), sun, vec3{1.0f}, tests::clear());
  return WallLight(field, level, light, {}, {}, top, size);
}

TEST(WallLight, IsThePatchOfAFlatMirror) {
  // The sun stands over +x: the beams go to the wall at low x, as high as the water is long there.
  const double angle = 0.9;
  const WallLight walls = walls_of(field_of(still(0.4), {0, 0}, {1, 0.8f}, 101), at_angle(angle), 2.0f);
  const double highest = 0.4 + 1.0 / std::tan(angle);
  const double expected = tests::reflectance(angle, kEta) * std::sin(angle);
  const vec3 inwards{1, 0, 0};
  for (double height = 0.43; height < highest - 0.03; height += 0.037)
    for (const float z : {0.05f, 0.4f, 0.75f})
      ASSERT_NEAR(static_cast<double>(walls.irradiance({0, static_cast<float>(height), z}, inwards).x) / expected, 1.0,
                  0.01)
          << height;
  EXPECT_EQ(walls.irradiance({0, static_cast<float>(highest) + 0.03f, 0.4f}, inwards), vec3{0.0f});
  EXPECT_EQ(walls.irradiance({0, 0.3f, 0.4f}, inwards), vec3{0.0f}) << "under water";
  EXPECT_EQ(walls.irradiance({1, 0.6f, 0.4f}, -inwards), vec3{0.0f}) << "the wall behind the beams";
  EXPECT_EQ(walls.irradiance({0.5f, 0.6f, 0.8f}, {0, 0, -1}), vec3{0.0f}) << "a wall along the beams";
}

TEST(WallLight, LightsABodyInItsWay) {
  const double angle = 0.9;
  const vec3 sun = at_angle(angle);
  const WallLight walls = walls_of(field_of(still(0.4), {0, 0}, {1, 0.8f}, 101), sun, 2.0f);
  const double reflectance = tests::reflectance(angle, kEta);
  // A surface that faces the beam, in the middle of the water.
  const vec3 against{sun.x, -sun.y, 0};
  EXPECT_NEAR(static_cast<double>(walls.irradiance({0.5f, 0.5f, 0.4f}, against).x), reflectance, 0.01 * reflectance);
  // Higher than the beams of the water's far end go there.
  EXPECT_EQ(walls.irradiance({0.5f, 0.4f + 0.55f / static_cast<float>(std::tan(angle)), 0.4f}, against), vec3{0.0f});
  EXPECT_EQ(walls.irradiance({0.5f, 0.5f, 0.4f}, -against), vec3{0.0f}) << "from behind";
}

TEST(WallLight, GetsAllThatWavesMirror) {
  const auto waves = crossing(0.5, 0.006);
  const double angle = 1.0;
  const glm::dvec3 sun(at_angle(angle));
  const HeightField field = field_of(waves, {-1, -0.7f}, {1, 0.7f}, 201);
  const WallLight walls = walls_of(field, vec3(sun), 4.5f, 150);
  double found = 0;
  int lit = 0;
  for (int k = 0; k < 4; ++k) {
    const WallLight::Wall& wall = walls.walls()[k];
    double sum = 0;
    for (const float value : wall.value) sum += static_cast<double>(value);
    lit += sum > 0;
    found += sum * static_cast<double>(wall.texel) * static_cast<double>(wall.texel);
  }
  EXPECT_GE(lit, 3) << "beams that waves turn end on the walls beside, too";
  double expected = 0;
  constexpr int kCells = 400;
  for (int j = 0; j < kCells; ++j)
    for (int i = 0; i < kCells; ++i) {
      const Wave wave = waves(-1 + 2 * (i + 0.5) / kCells, -0.7 + 1.4 * (j + 0.5) / kCells);
      const glm::dvec3 upright{-wave.da, 1, -wave.db};
      const double across = glm::dot(upright, sun);
      if (across > 0) expected += across * tests::reflectance(std::acos(across / glm::length(upright)), kEta);
    }
  expected *= 2.0 * 1.4 / (kCells * kCells);
  EXPECT_NEAR(found / expected, 1.0, 0.02);
}

TEST(WallLight, GivesTheSameBitsWithAnyNumberOfThreads) {
  const HeightField field = field_of(crossing(0.5, 0.01), {0, 0}, {2, 1}, 120);
  const auto with = [&](int threads) {
    const ThreadLimit limit(threads);
    return walls_of(field, at_angle(0.8), 1.5f, 100);
  };
  const WallLight one = with(1), five = with(5);
  for (int k = 0; k < 4; ++k) {
    ASSERT_EQ(one.walls()[k].value.size(), five.walls()[k].value.size());
    for (std::size_t i = 0; i < one.walls()[k].value.size(); ++i)
      ASSERT_EQ(one.walls()[k].value[i], five.walls()[k].value[i]);
  }
}

TEST(WallLight, IsNoneWithoutWater) {
  HeightField field = field_of(still(0.5), {0, 0}, {1, 1}, 16);
  for (float& height : field.height) height = -std::numeric_limits<float>::infinity();
  EXPECT_EQ(walls_of(field, at_angle(0.5), 2.0f).irradiance({0, 0.7f, 0.5f}, {1, 0, 0}), vec3{0.0f});
}

}  // namespace
}  // namespace meniscus
