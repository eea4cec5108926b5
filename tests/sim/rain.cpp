#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <glm/geometric.hpp>
#include <numbers>
#include <unordered_set>

#include "base/random.h"
#include "meniscus/sim.h"
#include "refused.h"

namespace meniscus {
namespace {

constexpr double kRate = 1 / 3.6e6;  ///< m/s in a mm/h

RainOptions rain_on(float side, float rate) {
  RainOptions options;
  options.high = {side, side};
  options.rate_mm_h = rate;
  options.share = 1;
  return options;
}

/// Drops in air, 1/(m^3 m), before any scaling.
double in_air(double diameter, double rate) { return 8e6 * std::exp(-4100 * std::pow(rate, -0.21) * diameter); }

/// Middle sums over diameters in m.
double integral(double low, double high, const std::function<double(double)>& f) {
  const int steps = 20000;
  double sum = 0;
  for (int i = 0; i < steps; ++i) sum += f(low + (high - low) * (i + 0.5) / steps);
  return sum * (high - low) / steps;
}
double water(double d) { return std::numbers::pi / 6 * d * d * d; }
/// The factor that makes all drops together bring the rate.
double scale_of(double rate) {
  return rate * kRate /
         integral(0, 0.03, [&](double d) { return in_air(d, rate) * fall_speed(static_cast<float>(d)) * water(d); });
}

TEST(FallSpeed, IsWhatGunnAndKinzerMeasured) {
  for (const auto& [mm, speed] : std::initializer_list<std::pair<float, float>>{{0.1f, 0.27f},
                                                                                {0.5f, 2.06f},
                                                                                {0.9f, 3.67f},
                                                                                {1.0f, 4.03f},
                                                                                {1.2f, 4.64f},
                                                                                {2.0f, 6.49f},
                                                                                {3.0f, 8.06f},
                                                                                {5.0f, 9.09f},
                                                                                {5.8f, 9.17f}})
    EXPECT_NEAR(fall_speed(0.001f * mm), speed, 1e-4f) << mm;
  EXPECT_NEAR(fall_speed(0.00195f), 0.25f * 6.09f + 0.75f * 6.49f, 1e-3f);
  // The fit of [Atlas1973], 9.65 - 10.3 exp(-0.6 D), holds within 3 % from 0.6 to 5.8 mm.
  for (double mm = 0.6; mm < 5.8; mm += 0.1)
    EXPECT_NEAR(fall_speed(static_cast<float>(1e-3 * mm)) / (9.65 - 10.3 * std::exp(-0.6 * mm)), 1, 0.03) << mm;
  float before = 0;
  for (int um = 1; um < 10000; ++um) {
    const float speed = fall_speed(1e-6f * static_cast<float>(um));
    EXPECT_GE(speed, before);
    before = speed;
  }
  EXPECT_EQ(fall_speed(0), 0);
  EXPECT_EQ(fall_speed(-1), 0);
  EXPECT_EQ(fall_speed(1), 9.17f);
}

TEST(Rain, BringsItsRateInTheMean) {
  for (const float rate : {1.0f, 10.0f, 50.0f, 150.0f})
    for (const float share : {1.0f, 0.01f}) {
      RainOptions options = rain_on(2, rate);
      options.share = share;
      const Rain rain(options);
      const double seconds = share == 1 ? 6 : 300;
      double sum = 0, squares = 0;
      for (const RainDrop& drop : rain.arriving(0, seconds)) {
        sum += rain.volume(drop);
        squares += rain.volume(drop) * rain.volume(drop);
      }
      const double all = rate * kRate * 4 * seconds;
      EXPECT_NEAR(sum + rain.rate_of_mist() * 4 * seconds, all, 4 * std::sqrt(squares)) << rate << " " << share;
      EXPECT_LT(4 * std::sqrt(squares), 0.2 * all);
      EXPECT_LT(rain.rate_of_mist(), 0.1 * rate * kRate);
    }
}

TEST(Rain, DividesTheRateExactlyBetweenDropsAndMist) {
  for (const float rate : {1.0f, 10.0f, 50.0f, 150.0f}) {
    const Rain rain(rain_on(3, rate));
    const double scale = scale_of(rate);
    const auto arrivals = [&](double d) { return scale * in_air(d, rate) * fall_speed(static_cast<float>(d)); };
    EXPECT_NEAR(rain.drops_per_second() / (9 * integral(0.0005, 0.006, arrivals)), 1, 1e-3);
    const double made = integral(0.0005, 0.006, [&](double d) { return arrivals(d) * water(d); });
    EXPECT_NEAR(rain.rate_of_mist(), rate * kRate - made, 1e-4 * rate * kRate);
    EXPECT_NEAR(scale, 1, 0.16);  // as good as the published fits are
  }
}

TEST(Rain, TakesLightByTwiceItsCrossSections) {
  for (const float rate : {1.0f, 50.0f}) {
    // N_0 pi / 2 int D^2 exp(-Lambda D) = pi N_0 / Lambda^3
    const double lambda = 4100 * std::pow(double{rate}, -0.21);
    const double wanted = scale_of(rate) * std::numbers::pi * 8e6 / (lambda * lambda * lambda);
    EXPECT_NEAR(Rain(rain_on(1, rate)).extinction(), wanted, 2e-3 * wanted);
  }
}

TEST(Rain, HasTheSizesOfItsFlux) {
  const Rain rain(rain_on(3, 20));
  const std::vector<RainDrop> drops = rain.arriving(0, 8);
  constexpr int kBins = 40;
  const double low = 0.0005, high = 0.006, width = (high - low) / kBins;
  const auto arrivals = [&](double d) { return in_air(d, 20) * fall_speed(static_cast<float>(d)); };
  const double all = integral(low, high, arrivals);
  std::vector<int> found(kBins, 0);
  for (const RainDrop& drop : drops) {
    ASSERT_GE(drop.diameter, 0.0005f);
    ASSERT_LE(drop.diameter, 0.006f);
    ++found[static_cast<std::size_t>(std::min((drop.diameter - low) / width, kBins - 1.0))];
  }
  double chi2 = 0;
  int bins = 0;
  for (int bin = 0; bin < kBins; ++bin) {
    const double expected =
        static_cast<double>(drops.size()) * integral(low + bin * width, low + (bin + 1) * width, arrivals) / all;
    if (expected < 10) continue;
    const double off = found[static_cast<std::size_t>(bin)] - expected;
    chi2 += off * off / expected;
    ++bins;
  }
  EXPECT_GT(bins, 20);
  EXPECT_GT(drops.size(), 50000u);
  EXPECT_LT(chi2, bins + 4 * std::sqrt(2.0 * bins));
  EXPECT_GT(chi2, bins - 4 * std::sqrt(2.0 * bins));
}

TEST(Rain, FallsOnAllPlacesAndTimesAlike) {
  RainOptions options = rain_on(2, 20);
  options.low = {-1, 5};
  options.high = {3, 6};
  options.level = 0.5f;
  const Rain rain(options);
  const std::vector<RainDrop> drops = rain.arriving(3, 11);
  std::vector<int> found(8 * 4 * 8, 0);
  for (const RainDrop& drop : drops) {
    ASSERT_EQ(drop.place.y, 0.5f);
    const auto cell = [](double t, int count) { return static_cast<std::size_t>(std::min(t * count, count - 1.0)); };
    ++found[cell((drop.place.x + 1) / 4.0, 8) + 8 * (cell(drop.place.z - 5.0, 4) + 4 * cell((drop.time - 3) / 8, 8))];
  }
  const double expected = static_cast<double>(drops.size()) / static_cast<double>(found.size());
  double chi2 = 0;
  for (const int n : found) chi2 += (n - expected) * (n - expected) / expected;
  EXPECT_NEAR(chi2, 255, 4 * std::sqrt(2.0 * 255));
  EXPECT_NEAR(static_cast<double>(drops.size()), 8 * rain.drops_per_second(),
              4 * std::sqrt(8 * rain.drops_per_second()));
}

bool same(const std::vector<RainDrop>& a, const std::vector<RainDrop>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const RainDrop& p, const RainDrop& q) {
    return p.id == q.id && p.diameter == q.diameter && p.time == q.time && p.place == q.place;
  });
}

TEST(Rain, IsTheSameInAnyPiecesAndAnyOrder) {
  const Rain rain(rain_on(2, 20));
  const std::vector<RainDrop> whole = rain.arriving(0.3, 2.3);
  std::vector<RainDrop> pieces;
  std::vector<double> cuts{0.3};
  Draws draws(1, 1);
  while (cuts.back() < 2.3) cuts.push_back(std::min(2.3, cuts.back() + draws.between(0.0001, 0.05)));
  // Backwards, as if the film were rendered from its end.
  for (std::size_t k = cuts.size() - 1; k > 0; --k) {
    const std::vector<RainDrop> piece = rain.arriving(cuts[k - 1], cuts[k]);
    for (const RainDrop& drop : piece) EXPECT_TRUE(drop.time > cuts[k - 1] && drop.time <= cuts[k]);
    pieces.insert(pieces.begin(), piece.begin(), piece.end());
  }
  EXPECT_GT(whole.size(), 10000u);
  EXPECT_TRUE(same(whole, pieces));
  EXPECT_TRUE(std::is_sorted(whole.begin(), whole.end(), [](const RainDrop& a, const RainDrop& b) {
    return a.time != b.time ? a.time < b.time : a.id < b.id;
  }));
  std::unordered_set<std::uint64_t> ids;
  for (const RainDrop& drop : whole) ids.insert(drop.id);
  EXPECT_EQ(ids.size(), whole.size());
  EXPECT_TRUE(rain.arriving(2, 2).empty());
  EXPECT_TRUE(rain.arriving(2, 1).empty());
}

TEST(Rain, IsTheSameOnAnyNumberOfThreads) {
  const auto run = [](int threads) {
    const ThreadLimit limit(threads);
    return Rain(rain_on(10, 50)).arriving(0.1, 0.4);
  };
  const std::vector<RainDrop> one = run(1);
  EXPECT_GT(one.size(), 10000u);
  EXPECT_TRUE(same(one, run(2)));
  EXPECT_TRUE(same(one, run(5)));
}

TEST(Rain, DiffersBySeed) {
  RainOptions options = rain_on(1, 10);
  const std::vector<RainDrop> one = Rain(options).arriving(0, 1);
  options.seed = 2;
  const std::vector<RainDrop> two = Rain(options).arriving(0, 1);
  std::unordered_set<std::uint64_t> ids;
  for (const RainDrop& drop : one) ids.insert(drop.id);
  for (const RainDrop& drop : two) EXPECT_EQ(ids.count(drop.id), 0u);
  EXPECT_NE(one.front().time, two.front().time);
}

TEST(Rain, LastsAsLongAsItIsTold) {
  RainOptions options = rain_on(2, 20);
  options.start = 10;
  options.duration = 3;
  const Rain rain(options);
  EXPECT_TRUE(rain.arriving(-1e300, 10).empty());
  EXPECT_TRUE(rain.arriving(13, 1e300).empty());
  const std::vector<RainDrop> all = rain.arriving(-std::numeric_limits<double>::infinity(), 1e300);
  EXPECT_NEAR(static_cast<double>(all.size()), 3 * rain.drops_per_second(), 4 * std::sqrt(3 * rain.drops_per_second()));
  EXPECT_GE(all.front().time, 10);
  EXPECT_LE(all.back().time, 13);
  EXPECT_TRUE(same(all, rain.arriving(9, 14)));
  options.duration = 0;
  EXPECT_TRUE(Rain(options).arriving(0, 100).empty());
}

TEST(Rain, MakesAsManyDropsAsItMay) {
  RainOptions options = rain_on(100, 50);
  options.share = 0;
  options.most_per_second = 20000;
  const Rain rain(options);
  EXPECT_NEAR(rain.drops_per_second(), 20000, 0.1);
  EXPECT_LT(rain.share(), 0.05f);
  options.high = {0.1f, 0.1f};
  EXPECT_EQ(Rain(options).share(), 1);
  options.rate_mm_h = 1e-30f;
  EXPECT_TRUE(Rain(options).arriving(0, 1e9).empty());
  options.rate_mm_h = 1e-3f;
  EXPECT_LT(Rain(options).arriving(0, 100).size(), 10u);
}

/// Drops in a box of air at a time, of all that arrive soon enough to be there.
std::vector<RainDrop> in_air_at(const Rain& rain, double time, Bounds box) {
  std::vector<RainDrop> result;
  const double longest = 2 * rain.options().top / fall_speed(1e-3f * rain.options().smallest_mm);
  for (const RainDrop& drop : rain.arriving(time, time + longest)) {
    const vec3 p = rain.position(drop, time);
    if (p.x >= box.low.x && p.x < box.high.x && p.y >= box.low.y && p.y < box.high.y && p.z >= box.low.z &&
        p.z < box.high.z)
      result.push_back(drop);
  }
  return result;
}

TEST(Rain, FillsTheAirWithOrWithoutWind) {
  for (const bool windy : {false, true}) {
    RainOptions options = rain_on(1, 20);
    options.low = {windy ? -8.0f : -2.0f, -4};
    options.high = {windy ? 12.0f : 2.0f, 4};
    options.top = 2;
    options.share = 0.25f;
    if (windy) {
      options.wind.velocity = {3, 0, 0.5f};
      options.wind.gust = 1;
    }
    const Rain rain(options);
    const double all = scale_of(20) * integral(0.0005, 0.006, [](double d) { return in_air(d, 20); }),
                 wanted = 0.25 * all;
    for (const float height : {0.2f, 1.2f}) {
      Bounds box;
      box.add(vec3{-2, height, -1});
      box.add(vec3{2, height + 0.5f, 1});
      const double volume = 4;
      const std::vector<RainDrop> drops = in_air_at(rain, 100, box);
      EXPECT_NEAR(static_cast<double>(drops.size()), wanted * volume, 4 * std::sqrt(wanted * volume))
          << windy << height;
      // Of all sizes: the mean volume too.
      double mean = 0;
      for (const RainDrop& drop : drops) mean += water(drop.diameter) / static_cast<double>(drops.size());
      const double mean_wanted =
          scale_of(20) * integral(0.0005, 0.006, [](double d) { return in_air(d, 20) * water(d); }) / all;
      EXPECT_NEAR(mean, mean_wanted, 0.3 * mean_wanted);
    }
  }
}

/// A field on a lattice, a shear with height.
std::shared_ptr<const Particles> shear() {
  auto field = std::make_shared<Particles>();
  Attribute velocity{"velocity", 3, {}};
  for (int z = 0; z < 3; ++z)
    for (int y = 0; y < 9; ++y)
      for (int x = 0; x < 3; ++x) {
        field->x.push_back(20.0f * static_cast<float>(x - 1));
        field->y.push_back(static_cast<float>(y));
        field->z.push_back(20.0f * static_cast<float>(z - 1));
        velocity.values.insert(velocity.values.end(), {0.8f * static_cast<float>(y), 0, -0.5f});
      }
  field->attributes.push_back(velocity);
  return field;
}

class RainWays : public testing::TestWithParam<int> {
 protected:
  RainOptions options() const {
    RainOptions options = rain_on(4, 20);
    options.level = 0.25f;
    options.top = 7;
    if (GetParam() >= 1) options.wind.velocity = {4, 0, -1};
    if (GetParam() == 2) options.wind.gust = 2;
    if (GetParam() == 3) options.wind.field = shear();
    return options;
  }
};
TEST_P(RainWays, AgreeWithPositionsAndVelocities) {
  const Rain rain(options());
  const std::vector<RainDrop> drops = rain.arriving(5, 5.02);
  ASSERT_GT(drops.size(), 50u);
  for (const RainDrop& drop : drops) {
    const Rain::Way way = rain.way(drop);
    ASSERT_GE(way.points.size(), 2u);
    ASSERT_EQ(way.points.size(), way.times.size());
    EXPECT_EQ(way.points.back(), drop.place);
    EXPECT_EQ(way.times.back(), drop.time);
    EXPECT_NEAR(way.points.front().y, 7.25f, 1e-4f);
    for (std::size_t k = 0; k + 1 < way.points.size(); ++k) {
      ASSERT_LT(way.times[k], way.times[k + 1]);
      EXPECT_LT(glm::distance(rain.position(drop, way.times[k]), way.points[k]), 1e-4f);
      const vec3 middle = rain.position(drop, 0.5 * (way.times[k] + way.times[k + 1]));
      EXPECT_LT(glm::distance(middle, 0.5f * (way.points[k] + way.points[k + 1])), 0.05f);
    }
    // Past the level it goes on; velocities are what positions change by, and the wind less the fall.
    for (const double after : {-0.6, -0.2, 0.1, 0.5}) {
      const double time = drop.time + after;
      const vec3 velocity = rain.velocity(drop, time);
      const vec3 change = (rain.position(drop, time + 0.001) - rain.position(drop, time - 0.001)) / 0.002f;
      EXPECT_LT(glm::distance(change, velocity), 0.05f * glm::length(velocity)) << after;
      const vec3 wind = rain.wind().at(rain.position(drop, time), time);
      EXPECT_LT(glm::distance(velocity, wind - vec3{0, fall_speed(drop.diameter), 0}), 1e-3f);
    }
    EXPECT_LT(glm::distance(rain.position(drop, drop.time), drop.place), 1e-6f);
  }
}
INSTANTIATE_TEST_SUITE_P(CalmWindGustsField, RainWays, testing::Values(0, 1, 2, 3));

TEST(Rain, FallsStraightInConstantWind) {
  RainOptions options = rain_on(4, 20);
  options.wind.velocity = {4, 0, -1};
  const Rain rain(options);
  const RainDrop drop = rain.arriving(5, 6).front();
  EXPECT_EQ(rain.way(drop).points.size(), 2u);
  const double seconds = 8 / fall_speed(drop.diameter);
  const vec3 top = rain.way(drop).points.front();
  EXPECT_LT(glm::distance(top, drop.place + vec3{-4 * seconds, 8, seconds}), 1e-4f);
}

TEST(Rain, ComesFromTheClosedFormInAShear) {
  // u = 0.8 y, y = v s at s before the arrival at level 0: x = x0 - 0.8 v s^2 / 2.
  RainOptions options = rain_on(4, 20);
  options.top = 7;
  options.wind.field = shear();
  const Rain rain(options);
  for (const RainDrop& drop : rain.arriving(5, 5.01)) {
    const double fall = fall_speed(drop.diameter), s = 6 / fall;
    const vec3 wanted = drop.place + vec3{-0.4 * fall * s * s, 6, 0.5 * s};
    EXPECT_LT(glm::distance(rain.position(drop, drop.time - s), wanted), 0.05f);
  }
}

TEST(Rain, ComesDownInAnyWind) {
  RainOptions options = rain_on(1, 20);
  options.wind.velocity = {0, 50, 0};
  const Rain rain(options);
  const RainDrop drop = rain.arriving(1, 2).front();
  const Rain::Way way = rain.way(drop);
  EXPECT_NEAR(way.points.front().y, 8, 1e-3);
  EXPECT_NEAR(rain.velocity(drop, 1).y, -0.1 * fall_speed(drop.diameter), 1e-5);
}

TEST(Rain, FallsAlongTheUpAxis) {
  RainOptions options = rain_on(1, 20);
  options.up = Axis::z;
  options.level = 3;
  const Rain rain(options);
  const RainDrop drop = rain.arriving(1, 2).front();
  EXPECT_EQ(drop.place.z, 3);
  EXPECT_NEAR(rain.way(drop).points.front().z, 11, 1e-4);
  EXPECT_LT(rain.velocity(drop, 0).z, -1);
}

RainDrop single(double time, vec3 place, float diameter) {
  RainDrop drop;
  drop.time = time;
  drop.place = place;
  drop.diameter = diameter;
  return drop;
}

TEST(Rain, BringsSingleDropsWhereAndWhenTheyAreAskedFor) {
  RainOptions options = rain_on(1, 0);
  options.level = 0.5f;
  options.wind.velocity = {2, 0, 0};
  options.drops = {single(0.8, {0.25f, 7, -3}, 0.003f), single(0.2, {0, 0, 0}, 0.002f),
                   single(0.8, {1, 0, 1}, 0.0001f)};
  const Rain alone(options);
  EXPECT_EQ(alone.drops_per_second(), 0);
  EXPECT_EQ(alone.rate_of_mist(), 0);
  EXPECT_EQ(alone.extinction(), 0);
  const std::vector<RainDrop> drops = alone.arriving(-100, 1e12);
  ASSERT_EQ(drops.size(), 3u);
  EXPECT_EQ(drops[0].time, 0.2);
  EXPECT_EQ(drops[0].place, (vec3{0, 0.5f, 0}));
  EXPECT_EQ(drops[1].time, 0.8);
  EXPECT_TRUE(drops[0].id != drops[1].id && drops[1].id != drops[2].id && drops[0].id != drops[2].id);
  // After `from` and not after `until`, whatever the pieces.
  EXPECT_TRUE(alone.arriving(0.2, 0.79).empty());
  EXPECT_EQ(alone.arriving(0.1, 0.2).size(), 1u);
  EXPECT_EQ(alone.arriving(0.2, 0.8).size(), 2u);
  EXPECT_TRUE(alone.arriving(0.8, 0.1).empty());
  // They fall like any other and bring their own water.
  const RainDrop& drop = drops[1].diameter > 0.001f ? drops[1] : drops[2];
  EXPECT_FLOAT_EQ(static_cast<float>(alone.volume(drop)), static_cast<float>(water(0.003)));
  EXPECT_LT(glm::distance(alone.velocity(drop, 0.5), vec3{2, -fall_speed(0.003f), 0}), 1e-5f);
  EXPECT_LT(glm::distance(alone.position(drop, 0.3), drop.place + 0.5f * vec3{-2, fall_speed(0.003f), 0}), 1e-4f);
  // Beside rain they change nothing about it, however few of its drops are made.
  RainOptions rainy = rain_on(2, 20);
  rainy.share = 0.25f;
  const std::vector<RainDrop> without = Rain(rainy).arriving(0, 1);
  rainy.drops = options.drops;
  const Rain both(rainy);
  const std::vector<RainDrop> with = both.arriving(0, 1);
  ASSERT_EQ(with.size(), without.size() + 3);
  EXPECT_TRUE(std::is_sorted(with.begin(), with.end(), [](const auto& a, const auto& b) { return a.time < b.time; }));
  std::unordered_set<std::uint64_t> ids;
  for (const RainDrop& one : with) ids.insert(one.id);
  EXPECT_EQ(ids.size(), with.size());
  for (const RainDrop& one : without) {
    EXPECT_EQ(ids.count(one.id), 1u);
    EXPECT_NEAR(both.volume(one), 4 * water(one.diameter), 1e-6 * water(one.diameter));
  }
}

TEST(Rain, RefusesWhatCannotBe) {
  const auto with = [](auto change) {
    RainOptions options = rain_on(1, 10);
    change(options);
    return [options] { Rain{options}; };
  };
  const float nan = std::nanf("");
  expect_refused(with([](RainOptions& o) { o.rate_mm_h = -1; }));
  expect_refused(with([&](RainOptions& o) { o.rate_mm_h = nan; }));
  expect_refused(with([](RainOptions& o) { o.rate_mm_h = 1e30f; }));
  expect_refused(with([](RainOptions& o) { o.smallest_mm = 7; }));
  expect_refused(with([](RainOptions& o) { o.smallest_mm = 0; }));
  expect_refused(with([&](RainOptions& o) { o.largest_mm = nan; }));
  expect_refused(with([](RainOptions& o) { o.high = o.low; }));
  expect_refused(with([&](RainOptions& o) { o.level = nan; }));
  expect_refused(with([](RainOptions& o) { o.top = -1; }));
  expect_refused(with([](RainOptions& o) { o.start = std::nan(""); }));
  expect_refused(with([](RainOptions& o) { o.duration = -1; }));
  expect_refused(with([](RainOptions& o) { o.share = 2; }));
  expect_refused(with([](RainOptions& o) { o.most_per_second = 0; }));
  expect_refused(with([&](RainOptions& o) { o.wind.velocity.x = nan; }));
  expect_refused(with([&](RainOptions& o) { o.drops = {single(nan, vec3{0.0f}, 0.001f)}; }));
  expect_refused(with([&](RainOptions& o) { o.drops = {single(0, {0, 0, nan}, 0.001f)}; }));
  expect_refused(with([](RainOptions& o) { o.drops = {single(0, vec3{0.0f}, 0)}; }));
  expect_refused(with([](RainOptions& o) { o.high = {1e5f, 1e5f}; }), ErrorCode::limit_exceeded);
  const Rain rain(rain_on(1, 10));
  expect_refused([&] { rain.arriving(0, std::numeric_limits<double>::infinity()); }, ErrorCode::limit_exceeded);
  EXPECT_TRUE(rain.arriving(std::nan(""), std::nan("")).empty());
}

}  // namespace
}  // namespace meniscus
