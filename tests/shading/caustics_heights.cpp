// Triangles cast from a height field, and the plane methods beside them.
#include <gtest/gtest.h>
#include <glm/common.hpp>

#include "caustics_fields.h"
#include "shading/caustics_map.h"

namespace meniscus {
namespace {

using tests::at_angle;
using tests::crossing;
using tests::field_of;
using tests::still;

const vec3 kUp{0, 1, 0};
constexpr double kEta = static_cast<double>(1.333f);

Scene over_floor(vec3 sun) { return Scene(tests::sun_from(sun), Ground{}); }

CausticsOptions by(CausticsMethod method) {
  CausticsOptions options;
  options.method = method;
  options.screen_width = 160;
  options.map_size = 200;
  return options;
}

TEST(TrianglesOfAHeightField, LightTheFloorUnderStillWaterAsInClosedForm) {
  for (const double angle : {0.0, 0.6}) {
    const Scene scene = over_floor(at_angle(angle));
    const auto water = make_height_field_surface(field_of(still(0.5), {-1, -1}, {1, 1}, 65));
    const auto light = caustics(*water, scene, tests::clear(), by(CausticsMethod::triangles));
    const double expected = std::cos(angle) * (1 - tests::reflectance(angle, kEta)) *
                            static_cast<double>(scene.environment().sun_irradiance().x);
    for (const float x : {-0.4f, 0.0f, 0.3f})
      for (const float z : {-0.5f, 0.2f}) {
        const WaterLight::Light at = light->at({x, 0, z}, kUp);
        EXPECT_NEAR(static_cast<double>(at.refracted.x) / expected, 1.0, 0.01);
        EXPECT_EQ(at.sun, vec3{0.0f});
      }
  }
}

TEST(TrianglesOfAHeightField, LoseNoLightOfWaves) {
  const Scene scene = over_floor(glm::normalize(vec3{0.3f, 1, 0.2f}));
  const auto water = make_height_field_surface(field_of(crossing(0.5, 0.015), {-1, -1}, {1, 1}, 129));
  const Bounds box = casting_box(*water, {});
  const LightCast cast = cast_light(*water, caustics_lights(scene, box, 1).at(0), box, scene, tests::clear(),
                                    by(CausticsMethod::triangles), nullptr, true);
  const LightBalance& balance = cast.balance;
  EXPECT_GT(balance.entered, 0.0);
  EXPECT_NEAR((balance.drawn + balance.hidden + balance.grazing + balance.lost + balance.mirrored + balance.trapped) /
                  balance.entered,
              1.0, 1e-6);
  EXPECT_NEAR(balance.drawn / balance.entered, 1.0, 0.06) << "some of it meets the sides of the water";
  const vec3 power = cast.maps.at(0).power();
  EXPECT_NEAR(static_cast<double>(power.x + power.y + power.z) / balance.drawn, 1.0, 0.03);
}

TEST(LightMap, ShowsThePatternOfTheTriangles) {
  const Scene scene = over_floor(glm::normalize(vec3{0.3f, 1, 0.2f}));
  const auto water = make_height_field_surface(field_of(crossing(0.5, 0.012), {-1, -1}, {1, 1}, 161));
  const auto triangles = caustics(*water, scene, tests::clear(), by(CausticsMethod::triangles));
  const auto correlation = [&](CausticsMethod method) {
    const auto light = caustics(*water, scene, tests::clear(), by(method));
    double xy = 0, xx = 0, yy = 0, mx = 0, my = 0;
    int n = 0;
    const auto each = [&](auto&& add) {
      for (float x = -0.7f; x < 0.6f; x += 0.013f)
        for (float z = -0.7f; z < 0.6f; z += 0.013f)
          add(static_cast<double>(triangles->at({x, 0, z}, kUp).refracted.y),
              static_cast<double>(light->at({x, 0, z}, kUp).refracted.y));
    };
    each([&](double x, double y) {
      mx += x;
      my += y;
      ++n;
    });
    mx /= n;
    my /= n;
    each([&](double x, double y) {
      xy += (x - mx) * (y - my);
      xx += (x - mx) * (x - mx);
      yy += (y - my) * (y - my);
    });
    EXPECT_NEAR(my / mx, 1.0, 0.04);
    return xy / std::sqrt(xx * yy);
  };
  EXPECT_GT(correlation(CausticsMethod::light_map), 0.95);
  EXPECT_GT(correlation(CausticsMethod::combined), 0.9);
  EXPECT_GT(correlation(CausticsMethod::simple), 0.25);
}

TEST(PlaneCaustics, LookForTheHeightsOfOtherSurfaces) {
  // Balls in a lattice are no height field: what is seen of them from above is.
  const Scene scene = over_floor(kUp);
  Particles particles;
  for (int j = 0; j < 24; ++j)
    for (int i = 0; i < 24; ++i)
      for (int k = 0; k < 8; ++k) {
        particles.x.push_back(0.04f * (static_cast<float>(i) + 0.5f));
        particles.y.push_back(0.04f * (static_cast<float>(k) + 0.5f));
        particles.z.push_back(0.04f * (static_cast<float>(j) + 0.5f));
      }
  RaycastOptions options;
  options.spacing = 0.04f;
  const auto water = make_raycast_surface(particles, options);
  const auto light = caustics(*water, scene, tests::clear(), by(CausticsMethod::light_map));
  const double expected =
      (1 - tests::reflectance(0, kEta)) * static_cast<double>(scene.environment().sun_irradiance().x);
  double sum = 0;
  int count = 0;
  for (float x = 0.3f; x < 0.66f; x += 0.02f)
    for (float z = 0.3f; z < 0.66f; z += 0.02f, ++count)
      sum += static_cast<double>(light->at({x, 0, z}, kUp).refracted.x);
  EXPECT_NEAR(sum / count / expected, 1.0, 0.05);
  EXPECT_EQ(light->at({0.5f, 0, 0.5f}, kUp).sun, vec3{0.0f});
  EXPECT_EQ(light->at({-1, 0, 0.5f}, kUp).sun, vec3{1.0f});
}

}  // namespace
}  // namespace meniscus
