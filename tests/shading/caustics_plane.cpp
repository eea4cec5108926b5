// Simple caustics, light maps and both together, as light on what lies under and beside the water.
#include <gtest/gtest.h>
#include <glm/common.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "caustics_fields.h"
#include "shading/caustics_field.h"
#include "shading/simple_caustics.h"

namespace meniscus {
namespace {

using tests::at_angle;
using tests::crossing;
using tests::field_of;
using tests::FieldSurface;
using tests::still;

const vec3 kUp{0, 1, 0};
constexpr double kEta = static_cast<double>(1.333f);
constexpr CausticsMethod kMethods[] = {CausticsMethod::simple, CausticsMethod::light_map, CausticsMethod::combined};

CausticsOptions by(CausticsMethod method) {
  CausticsOptions options;
  options.method = method;
  return options;
}

Material sea() {
  Material material = tests::clear();
  material.extinction = {0.4f, 0.1f, 0.05f};
  return material;
}

Scene over_floor(vec3 sun) { return Scene(tests::sun_from(sun), Ground{}); }

TEST(PlaneCaustics, LightTheFloorUnderStillWaterAsInClosedForm) {
  for (const CausticsMethod method : kMethods)
    for (const double angle : {0.0, 0.5, 1.0}) {
      const Scene scene = over_floor(at_angle(angle));
      const FieldSurface water(field_of(still(0.5), {-1, -1}, {1, 1}, 129));
      const auto light = caustics(water, scene, sea(), by(method));
      const double bent = std::asin(std::sin(angle) / kEta);
      for (const float x : {-0.5f, -0.2f, 0.1f, 0.4f}) {
        const WaterLight::Light at = light->at({x, 0, 0.3f}, kUp);
        for (int c = 0; c < 3; ++c) {
          const double expected = static_cast<double>(scene.environment().sun_irradiance()[c]) * std::cos(angle) *
                                  (1 - tests::reflectance(angle, kEta)) *
                                  std::exp(-static_cast<double>(sea().extinction[c]) * 0.5 / std::cos(bent));
          EXPECT_NEAR(static_cast<double>(at.refracted[c]) / expected, 1.0, 0.01) << angle;
        }
        EXPECT_EQ(at.lamps, vec3{1.0f});
        if (x + 0.5 * std::tan(angle) < 0.98) {
          EXPECT_EQ(at.sun, vec3{0.0f});
        }
      }
      // Beside the water and over it the sun shines as ever.
      EXPECT_EQ(light->at({1.5f, 0, 0}, kUp).sun, vec3{1.0f});
      EXPECT_EQ(light->at({0, 0.6f, 0}, kUp).sun, vec3{1.0f});
      EXPECT_EQ(light->at({0, 0.6f, 0}, kUp).refracted, vec3{0.0f});
    }
}

TEST(PlaneCaustics, LightUprightWallsUnderStillWater) {
  const double angle = 0.7, bent = std::asin(std::sin(angle) / kEta);
  const Scene scene = over_floor(at_angle(angle));
  const FieldSurface water(field_of(still(0.5), {-1, -1}, {1, 1}, 129));
  for (const CausticsMethod method : kMethods) {
    const auto light = caustics(water, scene, tests::clear(), by(method));
    // The flux through the surface on what stands across its way: sin for cos.
    const double expected = std::cos(angle) * (1 - tests::reflectance(angle, kEta)) * std::tan(bent);
    const double found = static_cast<double>(light->at({-0.99f, 0.2f, 0}, {1, 0, 0}).refracted.x) /
                         static_cast<double>(scene.environment().sun_irradiance().x);
    EXPECT_NEAR(found / expected, 1.0, 0.01);
  }
}

TEST(PlaneCaustics, KeepTheMeanOfTheFloorUnderWaves) {
  const Scene scene = over_floor(at_angle(0.3));
  const double still_water =
      std::cos(0.3) * (1 - tests::reflectance(0.3, kEta)) * static_cast<double>(scene.environment().sun_irradiance().x);
  const FieldSurface water(field_of(crossing(0.5, 0.012), {-1, -1}, {1, 1}, 193));
  for (const CausticsMethod method : kMethods) {
    const auto light = caustics(water, scene, tests::clear(), by(method));
    double sum = 0, squares = 0;
    int count = 0;
    for (float x = -0.95f; x < 0.75f; x += 0.007f)
      for (float z = -0.9f; z < 0.9f; z += 0.007f, ++count) {
        const double value = static_cast<double>(light->at({x, 0, z}, kUp).refracted.x) / still_water;
        sum += value;
        squares += value * value;
      }
    const double mean = sum / count, deviation = std::sqrt(squares / count - mean * mean);
    EXPECT_NEAR(mean, 1.0, 0.04) << static_cast<int>(method);
    EXPECT_GT(deviation, 0.1) << "a pattern is seen";
  }
}

TEST(PlaneCaustics, KeepSolidsShadows) {
  Scene scene = over_floor(at_angle(0.4));
  PlacedSolid roof{make_solid(box_mesh({-0.2f, 1.0f, -0.2f}, {0.2f, 1.05f, 0.2f})), glm::mat4{1.0f}, {}};
  PlacedSolid table{make_solid(box_mesh({0.4f, 0.2f, 0.4f}, {0.7f, 0.25f, 0.7f})), glm::mat4{1.0f}, {}};
  scene.set_solids({roof, table});
  const FieldSurface water(field_of(still(0.5), {-1, -1}, {1, 1}, 129));
  const float air = std::tan(0.4f), bent = std::tan(std::asin(std::sin(0.4f) / 1.333f));
  for (const CausticsMethod method : kMethods) {
    const auto light = caustics(water, scene, tests::clear(), by(method));
    const auto floor = [&](float x, float z) { return light->at({x, 0, z}, kUp).refracted.x; };
    const float open = floor(-0.7f, -0.7f);
    ASSERT_GT(open, 0.0f);
    // The roof's shadow goes on bent; the table takes its light on its own top.
    const float middle = -0.525f * air - 0.5f * bent;
    EXPECT_EQ(floor(middle, 0), 0.0f);
    EXPECT_EQ(floor(middle - 0.15f, 0), 0.0f);
    EXPECT_NEAR(floor(middle - 0.27f, 0), open, 0.01f * open);
    EXPECT_NEAR(floor(middle + 0.27f, 0), open, 0.01f * open);
    EXPECT_EQ(floor(0.55f - 0.225f * bent, 0.55f), 0.0f);
    EXPECT_NEAR(light->at({0.55f, 0.25f, 0.55f}, kUp).refracted.x, open, 0.01f * open);
    EXPECT_NEAR(floor(0.3f, 0.55f), open, 0.01f * open);
  }
}

TEST(PlaneCaustics, LeaveLampsToTriangles) {
  EnvironmentOptions night;
  night.sun_radiance_scale = 0;
  Scene scene(Environment(night), Ground{});
  scene.set_lamps({{{0, 2, 0}, {1, 1, 1}}});
  const FieldSurface water(field_of(still(0.5), {-1, -1}, {1, 1}, 65));
  // The test's surface shows nothing, so that triangles cast nothing: the lamp's light stays as it is.
  const WaterLight::Light at =
      caustics(water, scene, tests::clear(), by(CausticsMethod::light_map))->at({0, 0, 0}, kUp);
  EXPECT_EQ(at.sun, vec3{1.0f});
  EXPECT_EQ(at.refracted, vec3{0.0f});
}

TEST(SimpleCaustics, AreEquation4) {
  HeightField field = field_of(crossing(0.5, 0.02), {0, 0}, {1, 1}, 33);
  const WaterLevel level(field);
  const EnteringLight light = entering_light(level.frame(), kUp, vec3{1.0f}, tests::clear());
  CausticsOptions options;
  options.simple_a = 0.7f;
  options.simple_b = -0.9f;
  options.simple_c = 1.1f;
  options.simple_keeps_mean = false;
  const PlaneMap map = simple_caustics(field, level, light, {}, options);
  float low = 1e9f, high = -1e9f;
  for (const float h : field.height) {
    low = std::min(low, h);
    high = std::max(high, h);
  }
  for (std::size_t i = 0; i < field.height.size(); ++i) {
    const float expected =
        0.7f * (field.height[i] - low) / (high - low) - 0.9f * std::abs(field.normal[i].x + field.normal[i].z) + 1.1f;
    ASSERT_NEAR(map.value[i], light.transmittance * expected, 1e-4f);
  }
}

TEST(CausticsMethod, IsNamed) {
  EXPECT_EQ(caustics_method_of("simple"), CausticsMethod::simple);
  EXPECT_EQ(caustics_method_of("light_map"), CausticsMethod::light_map);
  EXPECT_EQ(caustics_method_of("combined"), CausticsMethod::combined);
  EXPECT_EQ(caustics_method_of("triangles"), CausticsMethod::triangles);
  EXPECT_THROW(caustics_method_of("photons"), Error);
  CausticsOptions options;
  options.simple_b = std::numeric_limits<float>::quiet_NaN();
  const FieldSurface water(field_of(still(0.5), {-1, -1}, {1, 1}, 9));
  EXPECT_THROW(caustics(water, over_floor(kUp), tests::clear(), options), Error);
}

TEST(PlaneCaustics, MirrorLightOntoTheWallsOfATank) {
  const double angle = 0.9;
  Scene scene = over_floor(at_angle(angle));
  Tank tank;
  tank.style = TankStyle::tiled;
  tank.inside = {{-0.5f, 0, -0.5f}, {0.5f, 0.55f, 0.5f}};
  scene.set_tank(tank);
  const FieldSurface water(field_of(still(0.5), {-0.5f, -0.5f}, {0.5f, 0.5f}, 101));
  const vec3 low_wall{-0.5f, 0.53f, 0};
  const double expected =
      tests::reflectance(angle, kEta) * std::sin(angle) * static_cast<double>(scene.environment().sun_irradiance().x);
  CausticsOptions options = by(CausticsMethod::light_map);
  EXPECT_NEAR(
      static_cast<double>(caustics(water, scene, tests::clear(), options)->at(low_wall, {1, 0, 0}).refracted.x) /
          expected,
      1.0, 0.02);
  options.on_walls = false;
  EXPECT_EQ(caustics(water, scene, tests::clear(), options)->at(low_wall, {1, 0, 0}).refracted, vec3{0.0f});
}

}  // namespace
}  // namespace meniscus
