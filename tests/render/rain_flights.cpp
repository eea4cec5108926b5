#include "render/rain_flights.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "rain.h"

namespace meniscus {
namespace {

constexpr double kTick = 0.01;

/// Still water at `level` over [0, 2] x [0, 2], down to the rain's level.
std::unique_ptr<Surface> still_water(float level) {
  HeightField field;
  field.step = vec2(0.25f);
  field.floor = -0.5f;
  field.height = Image<float>(9, 9, level);
  return make_height_field_surface(std::move(field));
}

RainOptions rain_around_water() {
  RainOptions options;
  options.rate_mm_h = 60;
  options.low = vec2(-1);
  options.high = vec2(3);
  options.level = -0.5f;
  options.top = 6;
  options.share = 0.2f;
  options.smallest_mm = 0.8f;
  options.wind.velocity = {1.5f, 0, -0.5f};
  options.wind.gust = 1;
  return options;
}

// The ways of drops are known: each comes to the water's level at one time, and is over the water then or not.
TEST(Flights, MeetStillWaterWhenTheyComeToItsLevel) {
  const Rain rain(rain_around_water());
  const float level = 0.05f;
  const std::unique_ptr<Surface> water = still_water(level);
  const Scene scene = empty_scene(-10);
  std::map<std::uint64_t, Flight> met;
  Flights flights(rain, nullptr, kTick);
  for (std::int64_t tick = 0; tick < 100; ++tick) {
    double before = static_cast<double>(tick) * kTick;
    for (const Flight& flight : flights.hits(tick, scene, water.get())) {
      EXPECT_GE(flight.hit, before);
      EXPECT_LE(flight.hit, static_cast<double>(tick + 1) * kTick);
      before = flight.hit;
      if (flight.target == Flight::Target::water) {
        EXPECT_TRUE(met.emplace(flight.drop.id, flight).second);
      }
    }
  }
  std::size_t expected = 0;
  for (const RainDrop& drop : rain.arriving(0, 3)) {
    const vec3 one = rain.position(drop, 0), other = rain.position(drop, 1);
    const double time = static_cast<double>((level - one.y) / (other.y - one.y));  // an even fall
    const vec3 place = rain.position(drop, time);
    const float inside = std::min({place.x, 2 - place.x, place.z, 2 - place.z});
    if (std::abs(inside) < 2e-3f || std::abs(time) < 1e-3 || std::abs(time - 1) < 1e-3) {
      met.erase(drop.id);
      continue;
    }
    const auto found = met.find(drop.id);
    const bool from_the_side = found != met.end() && found->second.point.y < level - 1e-3f;
    if (from_the_side || inside < 0) continue;
    if (time < 0 || time > 1) {
      EXPECT_EQ(found, met.end()) << time;
      continue;
    }
    ++expected;
    ASSERT_NE(found, met.end()) << time;
    EXPECT_NEAR(found->second.hit, time, 1e-4);
    EXPECT_NEAR(found->second.point.x, place.x, 1e-3f);
    EXPECT_NEAR(found->second.point.z, place.z, 1e-3f);
  }
  EXPECT_GT(expected, 300u);
}

TEST(Flights, AreTheSameForAnyNumberOfThreads) {
  const RainSettings settings = rain_on_square(1);
  const Rain rain(settings.rain);
  const WetGround ground(settings.ground.cells);
  const std::unique_ptr<Surface> water = still_water(0.1f);
  Scene scene = empty_scene();
  const auto hits = [&](int threads) {
    const ThreadLimit limit(threads);
    std::vector<Flight> all;
    Flights flights(rain, &ground, kTick);
    for (std::int64_t tick = 0; tick < 20; ++tick) {
      const float x = tick < 10 ? -0.9f : -0.6f;  // a roof that is moved once
      scene.set_solids({box({x, 2, -0.9f}, {x + 0.4f, 2.1f, 0})});
      for (const Flight& flight : flights.hits(tick, scene, water.get())) all.push_back(flight);
    }
    return all;
  };
  const std::vector<Flight> expected = hits(1);
  std::map<Flight::Target, std::size_t> targets;
  for (const Flight& flight : expected) ++targets[flight.target];
  EXPECT_GT(targets[Flight::Target::water], 100u);
  EXPECT_GT(targets[Flight::Target::ground], 100u);
  EXPECT_GT(targets[Flight::Target::body], 20u);
  for (const int threads : {2, 5}) {
    const std::vector<Flight> found = hits(threads);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].drop.id, expected[i].drop.id);
      EXPECT_EQ(found[i].hit, expected[i].hit);
      EXPECT_EQ(found[i].point, expected[i].point);
      EXPECT_EQ(found[i].target, expected[i].target);
    }
  }
}

}  // namespace
}  // namespace meniscus
