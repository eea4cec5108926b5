#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "rain.h"
#include "render/rain_flights.h"
#include "render/rain_ground.h"
#include "render/rain_puddles.h"

namespace meniscus {
namespace {

TEST(RainyScene, BringsTheRateOfItsRainToTheGround) {
  RainyScene rain(rain_on_square(1));
  const Scene scene = empty_scene();
  rain.advance(4, scene, nullptr);
  const double area = 4, seconds = 4;
  const double expected = 100e-3 / 3600 * seconds * area;
  // The share of the largest drops is what the mean scatters by.
  EXPECT_NEAR(rain.budget().fallen, expected, 0.06 * expected);
}

TEST(RainyScene, LosesNoWater) {
  RainSettings settings = rain_on_square(0.5f, 300);
  settings.rained_mm = 8;
  settings.ground.rut_depth = 0.02f;
  settings.rain.wind.velocity = {2, 0, 1};
  RainyScene rain(settings);
  const Scene scene = empty_scene(-1);
  for (const double time : {0.0, 0.7, 1.5}) {
    rain.advance(time, scene, nullptr);
    const WaterBudget budget = rain.budget();
    EXPECT_GT(budget.fallen, 0);
    EXPECT_NEAR(budget.soaked + budget.standing + budget.drained, budget.fallen, 1e-9 * budget.fallen) << time;
  }
}

/// Drops that hit the ground in each quarter of a line across a roof's shadow.
std::vector<Flight> hits_on_ground(const RainSettings& settings, const Scene& scene, double seconds) {
  const Rain rain(settings.rain);
  const WetGround ground(settings.ground.cells);
  constexpr double kTick = 0.05;
  Flights flights(rain, &ground, kTick);
  std::vector<Flight> found;
  for (std::int64_t tick = 0; tick < std::llround(seconds / kTick); ++tick)
    for (const Flight& flight : flights.hits(tick, scene, nullptr))
      if (flight.target == Flight::Target::ground) found.push_back(flight);
  return found;
}

TEST(RainyScene, ARoofKeepsTheGroundUnderItDry) {
  const RainSettings settings = rain_on_square(1.5f);
  Scene scene = empty_scene();
  scene.set_solids({box({-1, 2, -1}, {1, 2.2f, 1})});
  std::size_t under = 0, beside = 0;
  for (const Flight& flight : hits_on_ground(settings, scene, 2)) {
    const bool below = std::max(std::abs(flight.point.x), std::abs(flight.point.z)) < 1;
    ++(below ? under : beside);
  }
  EXPECT_EQ(under, 0u);
  EXPECT_GT(beside, 1000u);
}

TEST(RainyScene, AShadowOfSlantingRainIsShiftedByTheTangentOfItsAngle) {
  RainSettings settings = rain_on_square(3.5f);
  settings.rain.smallest_mm = 1.99f;  // all drops of one speed
  settings.rain.largest_mm = 2.01f;
  settings.rain.wind.velocity = {3, 0, 0};
  const float height = 2;
  Scene scene = empty_scene();
  scene.set_solids({box({-1, height, -1}, {1, height + 0.001f, 1})});
  RainDrop drop;
  drop.diameter = 2e-3f;
  const Rain rain(settings.rain);
  const vec3 velocity = rain.velocity(drop, 0);
  const float shift = height * velocity.x / -velocity.y;
  ASSERT_GT(shift, 0.7f);
  std::size_t inside = 0, around = 0;
  for (const Flight& flight : hits_on_ground(settings, scene, 8)) {
    const float x = flight.point.x - shift;
    if (std::abs(x) < 0.98f && std::abs(flight.point.z) < 0.98f) ++inside;
    if ((std::abs(x) > 1.02f && std::abs(x) < 1.5f) && std::abs(flight.point.z) < 0.98f) ++around;
  }
  EXPECT_EQ(inside, 0u);
  EXPECT_GT(around, 20u);
}

TEST(RainyScene, IsTheSameHoweverOftenItIsAskedFor) {
  RainSettings settings = rain_on_square(0.5f);
  settings.rained_mm = 12;
  settings.ground.rut_depth = 0.02f;
  const Scene scene = empty_scene(-1);
  RainyScene once(settings), often(settings);
  once.advance(0.5, scene, nullptr);
  for (int frame = 0; frame <= 30; ++frame) often.advance(frame / 60.0, scene, nullptr);
  EXPECT_EQ(once.hits(), often.hits());
  EXPECT_EQ(once.budget().standing, often.budget().standing);
  const HeightField a = once.puddles(), b = often.puddles();
  EXPECT_TRUE(std::equal(a.height.begin(), a.height.end(), b.height.begin(), b.height.end()));
  const View view = perspective_view({0, 1, 2}, {0, 0, 0}, {0, 1, 0}, 1, 320, 180);
  const std::vector<WaterPiece> from_once = once.pieces(view), from_often = often.pieces(view);
  ASSERT_EQ(from_once.size(), from_often.size());
  EXPECT_GT(from_once.size(), 10u);
  for (std::size_t i = 0; i < from_once.size(); ++i) {
    EXPECT_EQ(from_once[i].from, from_often[i].from);
    EXPECT_EQ(from_once[i].opacity, from_often[i].opacity);
  }
}

TEST(RainyScene, DoesNotGoBack) {
  RainyScene rain(rain_on_square(0.2f));
  const Scene scene = empty_scene();
  rain.advance(0.1, scene, nullptr);
  EXPECT_NO_THROW(rain.advance(0.1, scene, nullptr));
  EXPECT_THROW(rain.advance(0.05, scene, nullptr), Error);
  EXPECT_THROW(rain.advance(std::nan(""), scene, nullptr), Error);
  EXPECT_THROW(rain.advance(1e12, scene, nullptr), Error);
}

TEST(RainyScene, ShowsWhatItIsAskedFor) {
  RainSettings settings = rain_on_square(0.5f);
  settings.rained_mm = 12;
  settings.ground.rut_depth = 0.02f;
  const Scene scene = empty_scene(-1);
  const View view = perspective_view({0, 1, 2}, {0, 0, 0}, {0, 1, 0}, 1, 320, 180);
  const auto pieces_of = [&](RainShown shown) {
    settings.shown = shown;
    RainyScene rain(settings);
    rain.advance(0.2, scene, nullptr);
    return rain.pieces(view);
  };
  const auto is_streak = [](const WaterPiece& piece) { return piece.kind == WaterPiece::Kind::streak; };
  const std::vector<WaterPiece> all = pieces_of(RainShown::all), splashes = pieces_of(RainShown::splashes),
                                streaks = pieces_of(RainShown::streaks);
  EXPECT_TRUE(std::none_of(splashes.begin(), splashes.end(), is_streak));
  EXPECT_TRUE(std::all_of(streaks.begin(), streaks.end(), is_streak));
  EXPECT_GT(splashes.size(), 0u);
  EXPECT_GT(streaks.size(), 0u);
  EXPECT_EQ(all.size(), splashes.size() + streaks.size());
  EXPECT_TRUE(pieces_of(RainShown::neither).empty());
}

TEST(RainyScene, MakesRingsAndSplashesOnDeepWater) {
  RainSettings settings;
  settings.rain.rate_mm_h = 100;
  settings.rain.low = vec2(-1);
  settings.rain.high = vec2(1);
  settings.rain.level = -1;
  WaveFieldOptions still;
  still.region = {{-0.5f, -0.5f, -0.5f}, {0.5f, 0.2f, 0.5f}};
  still.step = 0.05f;
  const std::unique_ptr<Surface> water = make_height_field_surface(height_field(still, 0));
  const Scene scene = empty_scene(-0.5f);
  RainyScene rain(settings);
  EXPECT_TRUE(rain.rings().empty());
  rain.advance(0.5, scene, water.get());
  const HeightField rings = rain.rings();
  ASSERT_FALSE(rings.empty());
  EXPECT_GT(*std::max_element(rings.height.begin(), rings.height.end()), 1e-5f);
  EXPECT_GT(rain.hits(), 100u);
  const View view = perspective_view({0, 1, 2}, {0, 0.2f, 0}, {0, 1, 0}, 1, 320, 180);
  std::size_t on_water = 0;
  for (const WaterPiece& piece : rain.pieces(view))
    if (piece.kind == WaterPiece::Kind::pyramid && std::abs(piece.from.y - 0.2f) < 0.03f) ++on_water;
  EXPECT_GT(on_water, 10u);
}

/// Water whose surface rises by `slope` metres a metre along x.
std::unique_ptr<Surface> sloping_water(float slope) {
  HeightField field;
  field.low = vec2(-0.5f);
  field.step = vec2(0.05f);
  field.floor = -2;
  field.height = Image<float>(21, 21);
  for (int j = 0; j < 21; ++j)
    for (int i = 0; i < 21; ++i) field.height(i, j) = slope * (0.05f * static_cast<float>(i) - 0.5f);
  find_normals(field);
  return make_height_field_surface(std::move(field));
}

/// What stands up of the splashes on it after a while.
std::vector<WaterPiece> piles_on(const Surface& water) {
  RainSettings settings;
  settings.rain.rate_mm_h = 100;
  settings.rain.low = vec2(-0.45f);
  settings.rain.high = vec2(0.45f);
  settings.rain.level = -3;
  RainyScene rain(settings);
  rain.advance(0.4, empty_scene(-2.5f), &water);
  EXPECT_GT(rain.hits(), 100u);
  std::vector<WaterPiece> pieces = rain.pieces(perspective_view({0, 1, 3}, {0, 0, 0}, {0, 1, 0}, 1, 640, 360));
  std::erase_if(pieces, [](const WaterPiece& piece) { return piece.kind != WaterPiece::Kind::pyramid; });
  return pieces;
}

TEST(RainyScene, CrownsAndConesStandUprightOnWaves) {
  const std::vector<WaterPiece> piles = piles_on(*sloping_water(1));
  ASSERT_GT(piles.size(), 50u);
  vec3 sum{0.0f};
  for (const WaterPiece& pile : piles) sum += pile.to - pile.from;
  EXPECT_GT(sum.y, 0);
  EXPECT_LT(std::abs(sum.x), 0.15f * sum.y);  // along the normal it would be as much as upwards
}

TEST(RainyScene, NothingShootsOutOfTheSteepSideOfABreakingWave) { EXPECT_TRUE(piles_on(*sloping_water(3)).empty()); }

TEST(PuddleField, IsLevelOverABowlAndEndsUnderItsShores) {
  GroundOptions options;
  options.low = vec2(-1);
  options.high = vec2(1);
  options.cell = 0.02f;
  options.roughness = 0;
  options.heights = Image<float>(100, 100);
  for (int y = 0; y < 100; ++y)
    for (int x = 0; x < 100; ++x) {
      const vec2 at = (vec2(x, y) - 49.5f) / 50.0f;
      options.heights(x, y) = 0.2f * std::min(at.x * at.x + at.y * at.y, 1.0f);
    }
  WetGround ground(options);
  ground.rain(0.02);
  ground.settle();
  const HeightField field = puddle_field(ground, nullptr);
  ASSERT_FALSE(field.empty());
  float low = 1, high = 0;
  std::size_t below = 0;
  for (int j = 0; j < field.height.height(); ++j)
    for (int i = 0; i < field.height.width(); ++i) {
      const float level = field.height(i, j);
      if (!(level > -1)) continue;
      low = std::min(low, level);
      high = std::max(high, level);
      const auto cell = ground.cell_at(field.point(static_cast<float>(i), static_cast<float>(j), level));
      ASSERT_TRUE(cell);
      if (ground.bed(*cell) > level) ++below;
    }
  EXPECT_LT(high - low, 1e-4f);
  EXPECT_GT(below, 50u);
}

TEST(PuddleField, HasWavesThatLeaveItsShoresWhereTheyAre) {
  GroundOptions options;
  options.low = vec2(-0.5f);
  options.high = vec2(0.5f);
  options.roughness = 0;
  options.heights = Image<float>(50, 50);
  for (int y = 0; y < 50; ++y)
    for (int x = 0; x < 50; ++x)
      options.heights(x, y) = 0.04f * std::min(glm::length((vec2(x, y) - 24.5f) / 25.0f), 1.0f);
  WetGround ground(options);
  ground.rain(0.006);
  ground.settle();
  RippleOptions waves;
  waves.low = options.low;
  waves.high = options.high;
  waves.step = 0.02f;
  waves.strength = 30;
  Ripples ripples(waves);
  ripples.set_depths(puddle_depths(ground, ripples));
  for (const float x : {-0.15f, 0.0f, 0.17f}) ripples.hit({x, 0, 0.1f}, 0.004f, 8);
  for (int i = 0; i < 20; ++i) ripples.advance(0.01);
  const HeightField still = puddle_field(ground, nullptr), moved = puddle_field(ground, &ripples);
  const PuddleLevels levels(ground);
  float highest = 0;
  for (int j = 0; j < moved.height.height(); ++j)
    for (int i = 0; i < moved.height.width(); ++i) {
      const vec2 place = moved.low + moved.step * vec2(i, j);
      const float level = levels.level(place), bed = levels.bed(place), height = moved.height(i, j);
      if (!(height > -1)) continue;
      if (level <= bed)
        EXPECT_EQ(height, level) << "under the ground beside the water";
      else
        EXPECT_GT(height, bed) << "no place falls dry";
      highest = std::max(highest, std::abs(height - level));
    }
  EXPECT_FALSE(still.empty());
  EXPECT_GT(highest, 1e-4f) << "there are waves";
}

TEST(ReliefMesh, KeepsTheEdgesOfAStep) {
  GroundOptions options;
  options.low = vec2(-0.3f);
  options.high = vec2(0.3f);
  options.roughness = 0;
  options.heights = Image<float>(30, 30);
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 30; ++x) options.heights(x, y) = x < 12 ? 0.0f : 0.12f + 0.001f * static_cast<float>(y);
  const WetGround ground(options);
  const Mesh mesh = relief_mesh(ground, -0.001f);
  int steep = 0;
  for (std::size_t t = 0; t < mesh.corners.size(); t += 3) {
    const auto corner = [&](std::size_t k) { return mesh.corners[t + k]; };
    const vec3 a = mesh.positions[corner(0)], b = mesh.positions[corner(1)], c = mesh.positions[corner(2)];
    if (std::max({std::abs(a.x), std::abs(b.x), std::abs(c.x), std::abs(a.z), std::abs(b.z), std::abs(c.z)}) > 0.27f)
      continue;  // the border
    const vec3 face = glm::normalize(glm::cross(b - a, c - a));
    ASSERT_GT(face.y, 0.0f);
    steep += face.y < 0.5f ? 1 : 0;
    for (std::size_t k = 0; k < 3; ++k) EXPECT_GT(glm::dot(mesh.normals[corner(k)], face), 0.999f) << a.x << ' ' << a.z;
  }
  EXPECT_GT(steep, 20);
}

TEST(PuddleField, HasNoPuddleOfOneDropOnAFilm) {
  GroundOptions options;
  options.high = vec2(1);
  options.roughness = 0;
  WetGround ground(options);
  ground.rain(ground.capacity(0) + 0.5e-3);
  // Four millimetres of water on one cell, shared with its neighbours.
  ground.add(*ground.cell_at({0.5f, 0, 0.5f}), 4e-3 * 4e-4);
  EXPECT_GT(ground.depth(*ground.cell_at({0.5f, 0, 0.5f})), kPuddle);
  EXPECT_TRUE(puddle_field(ground, nullptr).empty());
}

TEST(PuddleField, IsEmptyOnDryGround) {
  GroundOptions options;
  options.high = vec2(1);
  EXPECT_TRUE(puddle_field(WetGround(options), nullptr).empty());
}

}  // namespace
}  // namespace meniscus
