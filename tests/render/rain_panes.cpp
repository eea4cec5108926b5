#include "render/rain_panes.h"

#include <gtest/gtest.h>

#include "rain.h"
#include "render/rain_flights.h"

namespace meniscus {
namespace {

Tank glass_tank() {
  Tank tank;
  tank.style = TankStyle::glass;
  tank.inside.add(vec3(-1, 0, -1));
  tank.inside.add(vec3(1, 1, 1));
  tank.thickness = 0.02f;
  return tank;
}

TEST(GlassPanes, StandUprightAroundTheTankUpToItsRim) {
  const std::vector<PlacedSolid> panes = glass_panes(glass_tank());
  ASSERT_EQ(panes.size(), 4u);
  Bounds all;
  for (const PlacedSolid& pane : panes) {
    const Bounds box = pane.solid->bounds();
    all.add(box);
    EXPECT_FLOAT_EQ(box.low.y, 0);
    EXPECT_FLOAT_EQ(box.high.y, 1);
    EXPECT_NEAR(std::min(box.extent().x, box.extent().z), 0.02f, 1e-6f);
    // Nothing of it is in the tank.
    EXPECT_TRUE(box.high.x <= -1 || box.low.x >= 1 || box.high.z <= -1 || box.low.z >= 1);
  }
  EXPECT_NEAR(all.low.x, -1.02f, 1e-6f);
  EXPECT_NEAR(all.high.z, 1.02f, 1e-6f);
  Tank plain = glass_tank();
  plain.thickness = 0;  // a hundredth of the longest edge
  EXPECT_NEAR(glass_panes(plain).front().solid->bounds().extent().x, 0.02f, 1e-6f);
  Tank tiled = glass_tank();
  tiled.style = TankStyle::tiled;
  EXPECT_TRUE(glass_panes(tiled).empty());
  EXPECT_TRUE(glass_panes(Tank{}).empty());
}

TEST(GlassPanes, KeepSlantingRainOffTheWaterBehindThem) {
  // Drops of 2 mm fall 6.5 m and are blown 6.5 m in a second: what comes over the rim lands as far in as it is high.
  RainSettings settings = rain_on_square(3, 300);
  settings.rain.smallest_mm = 1.99f;
  settings.rain.largest_mm = 2.01f;
  settings.rain.wind.velocity = {fall_speed(0.002f), 0, 0};
  const Rain rain(settings.rain);
  Scene scene = empty_scene(-0.001f);
  scene.set_tank(glass_tank());
  const auto hits_inside = [&](const Scene& met) {
    Flights flights(rain, nullptr, 0.05);
    int sheltered = 0, open = 0;
    for (std::int64_t tick = 0; tick < 20; ++tick)
      for (const Flight& flight : flights.hits(tick, met, nullptr)) {
        if (flight.point.y > 0.1f || std::abs(flight.point.x) > 0.95f || std::abs(flight.point.z) > 0.95f) continue;
        ++(flight.point.x < -0.15f ? sheltered : open);
      }
    return std::pair(sheltered, open);
  };
  const auto [through, all] = hits_inside(scene);
  EXPECT_GT(through, 100);
  const auto [sheltered, open] = hits_inside(with_solids(scene, glass_panes(scene.tank())));
  EXPECT_EQ(sheltered, 0);
  EXPECT_GT(open, 100);
  EXPECT_LE(open, all);
}

TEST(RainyScene, KeepsDryWhatStandsBehindAPaneInTheWind) {
  RainSettings settings = rain_on_square(0.4f, 300);
  settings.rain.wind.velocity = {2 * fall_speed(0.002f), 0, 0};
  settings.rain.smallest_mm = 1.99f;
  settings.rain.largest_mm = 2.01f;
  const auto fallen = [&](const Scene& scene) {
    RainyScene rain(settings);
    rain.advance(0.5, scene, nullptr);
    return rain.budget().fallen;
  };
  Scene scene = empty_scene();
  EXPECT_GT(fallen(scene), 0);
  scene.set_tank(glass_tank());
  EXPECT_EQ(fallen(scene), 0);
}

}  // namespace
}  // namespace meniscus
