#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>

#include "base/random.h"
#include "meniscus/sim.h"

namespace meniscus {
namespace {

/// An eye at (5, 1.5, -3) over 30 m x 20 m, not in the middle.
RainOptions looked_at(float rate) {
  RainOptions options;
  options.rate_mm_h = rate;
  options.low = {-10, -10};
  options.high = {20, 10};
  options.top = 3;
  options.whole_within = 2;
  options.most_per_second = 1e7;
  options.eye = [](double) { return vec3{5, 1.5f, -3}; };
  return options;
}

double away(const RainDrop& drop) { return std::hypot(drop.place.x - 5.0, drop.place.z + 3.0); }

bool same(const std::vector<RainDrop>& a, const std::vector<RainDrop>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const RainDrop& p, const RainDrop& q) {
    return p.id == q.id && p.diameter == q.diameter && p.time == q.time && p.place == q.place && p.weight == q.weight;
  });
}

/// Sums over drops with their weights; `squares` those of the weighted values.
struct Sum {
  double value = 0, squares = 0;
  void add(double v) {
    value += v;
    squares += v * v;
  }
  double sigma() const { return std::sqrt(squares); }
};

TEST(RainThinning, BringsTheRateNearFarAndAltogether) {
  const RainOptions options = looked_at(6);
  const Rain rain(options);
  RainOptions everywhere = options;
  everywhere.eye = nullptr;
  everywhere.share = 1;
  const Rain all(everywhere);
  const double seconds = 2, rate = 6 / 3.6e6 - all.rate_of_mist(), number = all.drops_per_second() / 600;
  Sum near, middle, far, whole, drops_far;
  for (const RainDrop& drop : rain.arriving(1, 1 + seconds)) {
    const double r = away(drop), v = rain.volume(drop);
    (r < 2 ? near : r < 6 ? middle : far).add(v);
    whole.add(v);
    if (r >= 6) drops_far.add(drop.weight);
  }
  // Disks up to 6 m lie in the region.
  const double pi = std::numbers::pi;
  EXPECT_NEAR(near.value, rate * seconds * pi * 4, 4 * near.sigma());
  EXPECT_NEAR(middle.value, rate * seconds * pi * 32, 4 * middle.sigma());
  EXPECT_NEAR(far.value, rate * seconds * (600 - pi * 36), 4 * far.sigma());
  EXPECT_NEAR(whole.value, rate * seconds * 600, 4 * whole.sigma());
  EXPECT_NEAR(drops_far.value, number * seconds * (600 - pi * 36), 4 * drops_far.sigma());
  EXPECT_LT(4 * near.sigma(), 0.1 * near.value);
  EXPECT_LT(4 * middle.sigma(), 0.1 * middle.value);
  EXPECT_LT(4 * far.sigma(), 0.1 * far.value);
}

TEST(RainThinning, MakesAllNearAndFewerFarAway) {
  const Rain rain(looked_at(6));
  EXPECT_EQ(rain.share(), 1);
  EXPECT_EQ(rain.options().whole_within, 2);
  float heaviest = 0;
  std::size_t far = 0, small_far = 0, count = 0;
  double weights_far = 0;
  for (const RainDrop& drop : rain.arriving(0, 2)) {
    const double r = away(drop);
    ++count;
    ASSERT_TRUE(r > 1.999 || drop.weight == 1) << r;
    ASSERT_GE(drop.weight, 1);
    heaviest = std::max(heaviest, drop.weight);
    if (r > 10) ++far, weights_far += double{drop.weight};
    // Of the small ones (w / r)^2 is left.
    if (r > 4 && drop.diameter < 0.0006f) {
      ++small_far;
      ASSERT_NEAR(drop.weight, std::min(r * r / 4, 100.0), 1e-3 * r * r);
    }
  }
  EXPECT_GT(small_far, 100u);
  EXPECT_LE(heaviest, 100);
  EXPECT_GT(weights_far, 5 * static_cast<double>(far));
  EXPECT_LT(static_cast<double>(count) / 2, 1.1 * rain.drops_per_second());
}

TEST(RainThinning, TellsHowManyDropsItMakesWithTheEyeOverTheMiddle) {
  for (const float whole : {0.0f, 0.5f, 3.0f, 12.0f, 100.0f}) {
    RainOptions options = looked_at(6);
    options.whole_within = whole;
    options.eye = [](double) { return vec3{5, 1, 0}; };
    const Rain rain(options);
    const double expected = rain.drops_per_second();
    EXPECT_NEAR(static_cast<double>(rain.arriving(0, 0.25).size()), 0.25 * expected,
                2 * std::sqrt(expected) + 0.0025 * expected)
        << whole;
  }
}

TEST(RainThinning, HasTheSizesOfTheRain) {
  RainOptions options = looked_at(6);
  const std::vector<RainDrop> drops = Rain(options).arriving(0, 2);
  options.eye = nullptr;
  options.share = 1;
  std::map<int, Sum> found;
  std::map<int, double> wanted;
  for (const RainDrop& drop : drops) found[static_cast<int>(drop.diameter * 4000)].add(drop.weight);
  for (const RainDrop& drop : Rain(options).arriving(0, 2)) wanted[static_cast<int>(drop.diameter * 4000)] += 1;
  int bins = 0;
  for (const auto& [bin, number] : wanted) {
    const Sum& sum = found[bin];
    if (number < 1000) continue;
    EXPECT_NEAR(sum.value, number, 4.5 * std::sqrt(sum.squares + number)) << bin;
    EXPECT_LT(sum.sigma(), 0.1 * number);
    ++bins;
  }
  EXPECT_GT(bins, 8);
}

TEST(RainThinning, KeepsTheDropsWhereverTheEyeIs) {
  // What is made from both places is the same drop, but for its weight; near the second eye are new ones.
  RainOptions options = looked_at(6);
  const std::vector<RainDrop> one = Rain(options).arriving(0, 0.4);
  options.eye = [](double) { return vec3{3, 1.5f, -3}; };
  const std::vector<RainDrop> two = Rain(options).arriving(0, 0.4);
  std::map<std::uint64_t, const RainDrop*> known;
  for (const RainDrop& drop : one) known[drop.id] = &drop;
  EXPECT_EQ(known.size(), one.size());
  std::size_t both = 0;
  for (const RainDrop& drop : two) {
    const auto found = known.find(drop.id);
    if (found == known.end()) {
      EXPECT_GT(away(drop), 2);  // all of those have been made
      continue;
    }
    ++both;
    EXPECT_EQ(found->second->time, drop.time);
    EXPECT_EQ(found->second->place, drop.place);
    EXPECT_EQ(found->second->diameter, drop.diameter);
  }
  EXPECT_GT(static_cast<double>(both), 0.5 * static_cast<double>(two.size()));
  EXPECT_LT(both, two.size());
}

/// A walk through gusts.
RainOptions walk() {
  RainOptions options = looked_at(6);
  options.wind.velocity = {2, 0, 1};
  options.wind.gust = 1;
  options.eye = [](double t) { return vec3{1.5 * t, 1.6, std::sin(t)}; };
  return options;
}

TEST(RainThinning, IsTheSameInAnyPiecesAndAnyOrder) {
  const Rain rain(walk());
  const std::vector<RainDrop> whole = rain.arriving(0.3, 0.8);
  std::vector<RainDrop> pieces;
  std::vector<double> cuts{0.3};
  Draws draws(1, 1);
  while (cuts.back() < 0.8) cuts.push_back(std::min(0.8, cuts.back() + draws.between(0.0001, 0.05)));
  for (std::size_t k = cuts.size() - 1; k > 0; --k) {
    const std::vector<RainDrop> piece = rain.arriving(cuts[k - 1], cuts[k]);
    pieces.insert(pieces.begin(), piece.begin(), piece.end());
  }
  EXPECT_GT(whole.size(), 5000u);
  EXPECT_TRUE(same(whole, pieces));
  EXPECT_TRUE(std::is_sorted(whole.begin(), whole.end(), [](const RainDrop& a, const RainDrop& b) {
    return a.time != b.time ? a.time < b.time : a.id < b.id;
  }));
}

TEST(RainThinning, IsTheSameOnAnyNumberOfThreads) {
  const auto run = [](int threads) {
    const ThreadLimit limit(threads);
    return Rain(walk()).arriving(0.1, 0.4);
  };
  const std::vector<RainDrop> one = run(1);
  EXPECT_TRUE(same(one, run(2)));
  EXPECT_TRUE(same(one, run(5)));
}

TEST(RainThinning, FillsTheAirBeforeTheEye) {
  // Seen from 2 m above the ground, what the wind carries past the eye lands metres behind it.
  RainOptions options = looked_at(6);
  options.wind.velocity = {6, 0, 0};
  options.low = {-4, -4};
  options.high = {14, 4};
  options.top = 4;
  options.eye = [](double) { return vec3{0, 2, 0}; };
  const Rain rain(options);
  std::size_t light = 0, all = 0;
  for (const RainDrop& drop : rain.arriving(10, 12)) {
    const vec3 place = rain.position(drop, 10);
    if (glm::distance(place, vec3{0, 2, 0}) > 1) continue;
    ++all;
    light += drop.weight == 1;
  }
  EXPECT_GT(all, 1000u);
  EXPECT_EQ(light, all);
}

TEST(RainThinning, StaysBelowTheMostThatMayBeMade) {
  RainOptions options = looked_at(6);
  options.low = {-40, -40};
  options.high = {40, 40};
  options.whole_within = 10;
  options.most_per_second = 100000;
  const Rain rain(options);
  EXPECT_LT(rain.options().whole_within, 2);
  EXPECT_GT(rain.options().whole_within, 0.5f);
  EXPECT_EQ(rain.share(), 1);
  EXPECT_NEAR(rain.drops_per_second(), 100000, 100);
  EXPECT_LT(static_cast<double>(rain.arriving(0, 1).size()), 102000);
  // Over so wide a region what is far away stands for more yet.
  options.low = {-1000, -1000};
  options.high = {1000, 1000};
  const Rain wide(options);
  EXPECT_NEAR(wide.drops_per_second(), 100000, 100);
  Sum water;
  for (const RainDrop& drop : wide.arriving(0, 1)) water.add(wide.volume(drop));
  EXPECT_NEAR(water.value, (6 / 3.6e6 - wide.rate_of_mist()) * 4e6, 4 * water.sigma());
}

TEST(RainThinning, TakesAnyEye) {
  RainOptions options = looked_at(5);
  options.most_per_second = 100000;
  const auto drops_with = [&](std::function<vec3(double)> eye) {
    options.eye = std::move(eye);
    return Rain(options).arriving(0, 1);
  };
  const float nan = std::nanf(""), infinity = std::numeric_limits<float>::infinity();
  const std::size_t far = drops_with([](double) { return vec3{1e6f, 2, 0}; }).size();
  EXPECT_GT(far, 0u);
  EXPECT_EQ(drops_with([=](double) { return vec3{nan, 0, 0}; }).size(), far);
  EXPECT_EQ(drops_with([=](double) { return vec3{0, infinity, 0}; }).size(), far);
  // A cut from one place to another.
  const auto cut = [](double t) { return t < 0.5 ? vec3{-5, 1, 0} : vec3{12, 1, 3}; };
  std::size_t near = 0;
  for (const RainDrop& drop : drops_with(cut))
    if (glm::distance(vec2(drop.place.x, drop.place.z), drop.time < 0.5 ? vec2(-5, 0) : vec2(12, 3)) < 0.5f) {
      ++near;
      EXPECT_EQ(drop.weight, 1);
    }
  EXPECT_GT(near, 50u);
  // No rain at all, and hardly any for a very long time.
  options.rate_mm_h = 0;
  EXPECT_TRUE(Rain(options).arriving(0, 1e9).empty());
  options.rate_mm_h = 1e-30f;
  EXPECT_LT(Rain(options).arriving(0, 1e9).size(), 5u);
}

}  // namespace
}  // namespace meniscus
