#include <gtest/gtest.h>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <numbers>
#include <numeric>

#include "base/random.h"
#include "meniscus/formulas/rain.h"
#include "meniscus/sim.h"
#include "refused.h"

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

RippleOptions pond(float side, float step = 0.01f) {
  RippleOptions options;
  options.high = {side, side};
  options.step = step;
  return options;
}

Ripples over(const RippleOptions& options, const std::function<float(vec3)>& depth) {
  Ripples ripples(options);
  std::vector<float> depths;
  for (int j = 0; j < ripples.height(); ++j)
    for (int i = 0; i < ripples.width(); ++i) depths.push_back(depth(ripples.place(i, j, 0)));
  ripples.set_depths(depths);
  return ripples;
}
Ripples over(const RippleOptions& options, float depth) {
  return over(options, [&](vec3) { return depth; });
}

double sum_of(const Ripples& ripples) {
  return std::accumulate(ripples.heights().begin(), ripples.heights().end(), 0.0);
}
double largest_of(const Ripples& ripples) {
  double largest = 0;
  for (const float h : ripples.heights()) largest = std::max(largest, std::abs(double{h}));
  return largest;
}

/// Where along a line from (i, j) on the ring is highest, in steps along the line, by a parabola through three points.
double crest(const Ripples& ripples, int i, int j, int di, int dj, int from, int until) {
  const auto height = [&](int n) {
    return double{ripples.heights()[static_cast<std::size_t>(i + n * di + ripples.width() * (j + n * dj))]};
  };
  int best = from;
  for (int n = from; n <= until; ++n)
    if (height(n) > height(best)) best = n;
  const double l = height(best - 1), m = height(best), r = height(best + 1);
  return best + 0.5 * (l - r) / (l - 2 * m + r);
}

/// m/s of the crest of a ring between two times, along a direction of the grid.
double ring_speed(Ripples ripples, int di, int dj, double first, double second) {
  const int middle = ripples.width() / 2;
  ripples.hit(ripples.place(middle, middle, 0), 0.05f, 5);
  const double pitch = ripples.options().step * std::hypot(di, dj);
  ripples.advance(first);
  const double before = crest(ripples, middle, middle, di, dj, 4, middle - 15);
  ripples.advance(second - first);
  const double after = crest(ripples, middle, middle, di, dj, 4, middle - 15);
  return pitch * (after - before) / (second - first);
}

class ShallowRings : public testing::TestWithParam<float> {};
TEST_P(ShallowRings, RunWithTheRootOfGravityTimesDepth) {
  RippleOptions options = pond(4);
  options.wavelength = kInfinity;
  options.damping = 0;
  const double speed = std::sqrt(9.81 * double{GetParam()});
  EXPECT_NEAR(Ripples(options).speed(GetParam()), speed, 1e-4 * speed);
  EXPECT_NEAR(ring_speed(over(options, GetParam()), 1, 0, 0.8 / speed, 1.6 / speed), speed, 0.02 * speed);
}
INSTANTIATE_TEST_SUITE_P(Depths, ShallowRings, testing::Values(0.0025f, 0.01f, 0.04f, 1.0f));

TEST(Ripples, RunWithTheSpeedOfTheirWavelengthByDefault) {
  const double k = 2 * std::numbers::pi / 0.03;
  for (const double depth : {0.003, 0.01, 1.0}) {
    const double speed = std::sqrt((9.81 / k + 0.0728e-3 * k) * std::tanh(k * depth));
    RippleOptions options = pond(4);
    options.damping = 0;
    const Ripples ripples = over(options, static_cast<float>(depth));
    EXPECT_NEAR(ripples.speed(static_cast<float>(depth)), speed, 1e-4 * speed);
    EXPECT_NEAR(ring_speed(ripples, 1, 0, 0.8 / speed, 1.6 / speed), speed, 0.02 * speed) << depth;
  }
}

TEST(Ripples, AreRound) {
  RippleOptions options = pond(4);
  options.damping = 0;
  Ripples ripples = over(options, 1.0f);
  const int middle = ripples.width() / 2;
  ripples.hit(ripples.place(middle, middle, 0), 0.05f, 5);
  ripples.advance(1.2 / ripples.speed(1));
  const double along = crest(ripples, middle, middle, 1, 0, 4, 185),
               other = crest(ripples, middle, middle, 0, -1, 4, 185),
               aslant = std::sqrt(2.0) * crest(ripples, middle, middle, 1, 1, 4, 130);
  EXPECT_NEAR(along, 120, 15);  // the crest comes a little after the front
  EXPECT_NEAR(other, along, 1e-3 * along);
  EXPECT_NEAR(aslant, along, 0.03 * along);
}

TEST(Ripples, OfSmallDropsAreRoundToo) {
  Ripples ripples = over(pond(2), 1.0f);
  ripples.hit(ripples.place(100, 100, 0), 0.002f, 6.5f);
  ripples.advance(0.6 / ripples.speed(1));
  const double along = crest(ripples, 100, 100, 1, 0, 4, 85),
               aslant = std::sqrt(2.0) * crest(ripples, 100, 100, 1, 1, 4, 65);
  EXPECT_NEAR(along, 60, 10);
  EXPECT_NEAR(aslant, along, 0.03 * along);
}

// All shores closed: a round pond within the grid.
float in_round_pond(vec3 place, float middle, float radius) {
  return std::hypot(place.x - middle, place.z - middle) < radius ? 0.01f : 0.0f;
}

TEST(Ripples, KeepTheirEnergyWithoutDamping) {
  RippleOptions options = pond(1);
  options.damping = 0;
  Ripples ripples = over(options, [](vec3 p) { return in_round_pond(p, 0.5f, 0.35f); });
  ripples.hit({0.45f, 0, 0.6f}, 0.004f, 8);
  ripples.advance(0.04);
  const double energy = ripples.energy();
  ASSERT_GT(energy, 0);
  for (int frame = 0; frame < 250; ++frame) ripples.advance(0.04);
  EXPECT_NEAR(ripples.energy(), energy, 0.01 * energy);
}

TEST(Ripples, LoseEnergyAllTheTimeWithoutHits) {
  Ripples ripples = over(pond(1), [](vec3 p) { return p.x < 0.7f ? 0.02f : 0.002f; });
  Draws draws(1, 0);
  for (int n = 0; n < 20; ++n)
    ripples.hit({static_cast<float>(draws.uniform()), 0, static_cast<float>(draws.uniform())}, 0.003f, 8);
  double energy = ripples.energy();
  for (int frame = 0; frame < 100; ++frame) {
    ripples.advance(0.04);
    EXPECT_LT(ripples.energy(), energy);
    energy = ripples.energy();
  }
}

TEST(Ripples, SinkAsTheirDampingSays) {
  RippleOptions options = pond(1);
  options.damping = 3;
  const auto shape = [](vec3 p) { return in_round_pond(p, 0.5f, 0.35f); };
  Ripples ripples = over(options, shape);
  ripples.hit({0.5f, 0, 0.5f}, 0.004f, 8);
  ripples.advance(0.04);
  const double energy = ripples.energy();
  for (int frame = 0; frame < 25; ++frame) ripples.advance(0.04);
  EXPECT_NEAR(ripples.energy() / energy, std::exp(-6.0), 0.02 * std::exp(-6.0));
}

/// A channel along a, nine points wide between its shores, and in it a straight wave: its mean across the channel.
class Channel {
 public:
  Channel(float length, float wavelength, const std::function<float(float)>& depth)
      : ripples_([&] {
          RippleOptions options;
          options.high = {length, 0.1f};
          options.wavelength = wavelength;
          options.damping = 0;
          return over(options, [&](vec3 p) { return p.z < 0.005f || p.z > 0.095f ? 0.0f : depth(p.x); });
        }()) {}
  void hit(int i, float diameter, float speed) {
    for (int j = 1; j < 10; ++j) ripples_.hit(ripples_.place(i, j, 0), diameter, speed);
  }
  Ripples& ripples() { return ripples_; }
  double height(int i) const {
    double sum = 0;
    for (int j = 1; j < 10; ++j) sum += ripples_.heights()[static_cast<std::size_t>(i + j * ripples_.width())];
    return sum / 9;
  }
  /// Steps between points along a where the wave is highest, from `from` until `until`.
  double crest(int from, int until) const {
    int best = from;
    for (int i = from; i <= until; ++i)
      if (height(i) > height(best)) best = i;
    const double l = height(best - 1), m = height(best), r = height(best + 1);
    return best + 0.5 * (l - r) / (l - 2 * m + r);
  }

 private:
  Ripples ripples_;
};

TEST(Ripples, SlowDownByHalfOnAQuarterOfTheDepth) {
  const auto speed_over = [&](float near, float far) {
    Channel channel(6, kInfinity, [&](float a) { return a < 3 ? near : far; });
    channel.hit(200, 0.05f, 5);
    const double deep = std::sqrt(9.81 * 0.01);
    channel.ripples().advance(1.8 / deep);
    const double before = channel.crest(310, 590);
    channel.ripples().advance(0.8 / deep);
    return (channel.crest(310, 590) - before) * 0.01 / (0.8 / deep);
  };
  const double deep = speed_over(0.01f, 0.01f), changed = speed_over(0.01f, 0.0025f);
  EXPECT_NEAR(deep, std::sqrt(9.81 * 0.01), 0.02 * deep);
  EXPECT_NEAR(changed, 0.5 * deep, 0.02 * deep);
}

TEST(Ripples, ComeBackFromAShoreButNotFromTheBorder) {
  // The highest of a wave that began at 4.5 m and has gone 2.5 m, there and back again, or on in a longer channel.
  const auto highest = [&](float length, float shore, int from, int until) {
    Channel channel(length, 0.03f, [&](float a) { return a < shore ? 1.0f : 0.0f; });
    channel.hit(450, 0.004f, 8);
    channel.ripples().advance(2.5 / channel.ripples().speed(1));
    double height = 0;
    for (int i = from; i < until; ++i) height = std::max(height, channel.height(i));
    return height;
  };
  const double on = highest(9, 10, 600, 750);
  EXPECT_GT(on, 1e-5);
  EXPECT_NEAR(highest(6, 5.8f, 400, 550), on, 0.02 * on);
  EXPECT_LT(highest(6, 7, 400, 550), 0.04 * on);
}

TEST(Ripples, DoNotComeBackAslantFromTheBorder) {
  RippleOptions options = pond(2);
  options.damping = 0;
  RippleOptions large = pond(6);
  large.damping = 0;
  large.low = {-2, -2};
  large.high = {4, 4};
  Ripples cut = over(options, 1.0f), whole = over(large, 1.0f);
  for (Ripples* ripples : {&cut, &whole}) ripples->hit({1, 0, 0.5f}, 0.004f, 8);
  const double speed = cut.speed(1);
  double highest = 0, off = 0;
  for (int frame = 0; frame < 20; ++frame) {
    for (Ripples* ripples : {&cut, &whole}) ripples->advance(0.1 / speed);
    for (int j = 20; j <= 180; ++j)
      for (int i = 20; i <= 180; ++i) {
        const double wanted = whole.heights()[static_cast<std::size_t>(i + 200 + whole.width() * (j + 200))];
        const double found = cut.heights()[static_cast<std::size_t>(i + cut.width() * j)];
        if (frame == 6) highest = std::max(highest, std::abs(wanted));
        off = std::max(off, std::abs(found - wanted));
      }
  }
  EXPECT_GT(highest, 0);
  EXPECT_LT(off, 0.03 * highest);
}

TEST(Ripples, NeitherMakeNorLoseWater) {
  Ripples ripples = over(pond(1), [](vec3 p) { return in_round_pond(p, 0.5f, 0.33f); });
  Draws draws(2, 0);
  double moved = 0;
  for (int n = 0; n < 300; ++n) {
    // Some in the middle, most where the shore cuts the crater's rim or the crater itself.
    const double angle = draws.between(0, 6.28), radius = n % 3 ? draws.between(0.28, 0.33) : draws.between(0, 0.3);
    ripples.hit(
        {static_cast<float>(0.5 + radius * std::cos(angle)), 0, static_cast<float>(0.5 + radius * std::sin(angle))},
        0.004f, 8);
    if (n < 10) moved = std::max(moved, largest_of(ripples));
    EXPECT_NEAR(sum_of(ripples), 0, 1e-5 * (n + 1) * moved);
    if (n % 10 == 0) ripples.advance(0.04);
  }
  EXPECT_GT(moved, 1e-4);
  for (int frame = 0; frame < 100; ++frame) ripples.advance(0.04);
  EXPECT_NEAR(sum_of(ripples), 0, 1e-2 * moved);
  for (int j = 0; j < ripples.height(); ++j)
    for (int i = 0; i < ripples.width(); ++i) {
      if (in_round_pond(ripples.place(i, j, 0), 0.5f, 0.33f) > 0) continue;
      EXPECT_EQ(ripples.heights()[static_cast<std::size_t>(i + ripples.width() * j)], 0);
    }
}

TEST(Ripples, StayStableForAnHourOfRain) {
  Ripples ripples = over(pond(0.25f), [](vec3 p) { return 0.001f + 0.02f * p.x; });
  Draws draws(3, 0);
  double highest = 0;
  for (int second = 0; second < 3600; ++second) {
    for (int n = 0; n < 3; ++n)
      ripples.hit({static_cast<float>(draws.between(0, 0.25)), 0, static_cast<float>(draws.between(0, 0.25))}, 0.002f,
                  6.5f);
    for (double left = 1; left > 0;) {
      const double part = second % 2 ? 0.06 : draws.between(0.001, 0.1);
      ripples.advance(part);
      left -= part;
    }
    if (second >= 100) highest = std::max(highest, largest_of(ripples));
    ASSERT_TRUE(highest < 0.02) << second;
  }
  EXPECT_LT(std::abs(sum_of(ripples)) / static_cast<double>(ripples.heights().size()), 1e-4);
  for (int frame = 0; frame < 500; ++frame) ripples.advance(0.04);
  EXPECT_LT(largest_of(ripples), 1e-6);
}

TEST(Ripples, StayStableAmongAnyShores) {
  Draws draws(7, 0);
  for (const double dry : {0.1, 0.3, 0.5, 0.7}) {
    RippleOptions options = pond(0.5f);
    options.damping = 0;
    Ripples ripples = over(options, [&](vec3) { return draws.uniform() < dry ? 0.0f : 1.0f; });
    for (int n = 0; n < 50; ++n)
      ripples.hit({static_cast<float>(draws.between(0, 0.5)), 0, static_cast<float>(draws.between(0, 0.5))}, 0.004f, 8);
    // By the longest steps that there are.
    const double step = ripples.inner_step(), start = largest_of(ripples);
    ASSERT_GT(start, 0);
    for (int n = 0; n < 5000; ++n) ripples.advance(step);
    EXPECT_LT(largest_of(ripples), 3 * start) << dry;
  }
}

TEST(Ripples, ComeToRestAndCostNothingThen) {
  Ripples ripples = over(pond(1), 0.01f);
  ripples.hit({0.5f, 0, 0.5f}, 0.002f, 6.5f);
  EXPECT_GT(largest_of(ripples), 1e-4);
  for (int frame = 0; frame < 1000; ++frame) ripples.advance(0.04);
  EXPECT_EQ(largest_of(ripples), 0);
  EXPECT_EQ(ripples.energy(), 0);
  ripples.advance(1e12);
}

TEST(Ripples, CountTheStrength) {
  RippleOptions options = pond(1);
  const auto after = [&](float strength) {
    options.strength = strength;
    Ripples ripples = over(options, 0.1f);
    ripples.hit({0.5f, 0, 0.5f}, 0.002f, 6.5f);
    return ripples.heights()[50 + 50 * static_cast<std::size_t>(ripples.width())];
  };
  EXPECT_LT(after(1), 0);
  EXPECT_NEAR(after(2), 2 * after(1), 1e-6f);
  EXPECT_EQ(after(0), 0);
}

TEST(Ripples, AreDeeperForLargerAndFasterDropsButLeaveTheGroundCovered) {
  const auto depth_of = [&](float water, float diameter, float speed) {
    Ripples ripples = over(pond(1), water);
    ripples.hit({0.5f, 0, 0.5f}, diameter, speed);
    return largest_of(ripples);
  };
  EXPECT_GT(depth_of(0.1f, 0.002f, 6.5f), 2 * depth_of(0.1f, 0.001f, 4));
  EXPECT_GT(depth_of(0.1f, 0.002f, 6.5f), depth_of(0.1f, 0.002f, 3));
  EXPECT_LE(depth_of(0.001f, 0.005f, 9), 0.00051);
  EXPECT_EQ(depth_of(0.1f, 0.002f, 0), 0);
}

TEST(Ripples, CarryTheirPartOfTheDropsEnergy) {
  // Fine enough that the crater is the cavity's own: 6 % of the drop's energy, over the density of water.
  Ripples ripples = over(pond(0.1f, 0.001f), 1.0f);
  ripples.hit({0.05f, 0, 0.05f}, 0.002f, 6.5f);
  double potential = 0;
  for (const float h : ripples.heights()) potential += 0.5 * 9.81 * double{h} * double{h} * 1e-6;
  const double kinetic = std::numbers::pi / 12 * 8e-9 * 6.5 * 6.5;
  EXPECT_NEAR(potential / kinetic, 0.06, 0.0015);
}

TEST(Ripples, AreLessSteepOnWiderPointsButNotByAllThatTheSameEnergyWouldMakeThem) {
  // A crater of 9.6 mm, once whole and once as wide as 1.5 points of 30 mm: by energy its depth would go as 1 / R.
  const auto deepest = [](float step) {
    Ripples ripples = over(pond(100 * step, step), 1.0f);
    ripples.hit({50 * step, 0, 50 * step}, 0.002f, 6.5f);
    return largest_of(ripples);
  };
  const double narrow = deepest(0.001f), wide = deepest(0.03f), ratio = 1.5 * 0.03 / 0.0096;
  EXPECT_NEAR(wide / narrow, std::sqrt(ratio) / ratio, 0.02);
}

TEST(Ripples, GoOnInNewShapes) {
  const auto shape = [](vec3 p) { return in_round_pond(p, 0.5f, 0.4f); };
  Ripples kept = over(pond(1), shape), changed = kept;
  for (Ripples* ripples : {&kept, &changed}) {
    ripples->hit({0.5f, 0, 0.5f}, 0.002f, 6.5f);
    ripples->advance(0.2);
  }
  std::vector<float> depths;
  for (int j = 0; j < kept.height(); ++j)
    for (int i = 0; i < kept.width(); ++i) depths.push_back(in_round_pond(kept.place(i, j, 0), 0.5f, 0.45f));
  changed.set_depths(depths);
  EXPECT_EQ(0, std::memcmp(kept.heights().data(), changed.heights().data(), kept.heights().size_bytes()));
  for (Ripples* ripples : {&kept, &changed}) ripples->advance(0.4);
  // The wave has not come to the shores by then.
  EXPECT_EQ(0, std::memcmp(kept.heights().data(), changed.heights().data(), kept.heights().size_bytes()));
  changed.set_depths(std::vector<float>(depths.size(), 0.0f));
  EXPECT_EQ(largest_of(changed), 0);
  EXPECT_EQ(changed.energy(), 0);
}

TEST(Ripples, KeepTheirMotionWhenTheStepChanges) {
  RippleOptions options = pond(1);
  options.wavelength = kInfinity;
  options.damping = 0;
  const auto shape = [](vec3 p) { return in_round_pond(p, 0.5f, 0.4f); };
  Ripples even = over(options, shape), uneven = even;
  for (Ripples* ripples : {&even, &uneven}) ripples->hit({0.5f, 0, 0.5f}, 0.05f, 5);
  Draws draws(1, 2);
  double time = 0;
  while (time < 0.9) {
    const double part = draws.between(0.003, 0.05);
    uneven.advance(part);
    time += part;
  }
  uneven.advance(1 - time);
  for (int n = 0; n < 100; ++n) even.advance(0.01);
  double off = 0;
  for (std::size_t k = 0; k < even.heights().size(); ++k)
    off = std::max(off, std::abs(double{even.heights()[k]} - uneven.heights()[k]));
  EXPECT_LT(off, 0.06 * largest_of(even));
  EXPECT_NEAR(uneven.energy(), even.energy(), 0.03 * even.energy());
}

TEST(Ripples, AreTheSameBitsOnAnyNumberOfThreads) {
  const auto run = [](int threads) {
    const ThreadLimit limit(threads);
    Ripples ripples = over(pond(3), [](vec3 p) { return 0.004f * p.x - 0.001f; });
    Draws draws(5, 0);
    for (int frame = 0; frame < 20; ++frame) {
      for (int n = 0; n < 30; ++n)
        ripples.hit({static_cast<float>(draws.between(0, 3)), 0, static_cast<float>(draws.between(0, 3))}, 0.002f,
                    6.5f);
      ripples.advance(0.04);
    }
    return std::vector<float>(ripples.heights().begin(), ripples.heights().end());
  };
  const std::vector<float> one = run(1);
  EXPECT_EQ(one, run(2));
  EXPECT_EQ(one, run(5));
}

TEST(Ripples, LieAlongTheUpAxis) {
  for (const Axis up : {Axis::x, Axis::y, Axis::z}) {
    RippleOptions options = pond(1);
    options.low = {1, 2};
    options.high = {2, 2.5f};
    options.up = up;
    Ripples ripples = over(options, 0.1f);
    EXPECT_EQ(ripples.width(), 101);
    EXPECT_EQ(ripples.height(), 51);
    const vec3 place = ripples.place(30, 20, 7);
    const vec3 wanted = up == Axis::x ? vec3{7, 1.3f, 2.2f} : up == Axis::y ? vec3{1.3f, 7, 2.2f} : vec3{1.3f, 2.2f, 7};
    EXPECT_NEAR(glm::distance(place, wanted), 0, 1e-5f);
    ripples.hit(place, 0.002f, 6.5f);
    EXPECT_LT(ripples.heights()[30 + 20 * 101], -1e-4f);
  }
}

TEST(Ripples, TakeHitsBesideTheWaterForNothing) {
  Ripples ripples = over(pond(1), [](vec3 p) { return p.x < 0.5f ? 0.01f : 0.0f; });
  ripples.hit({0.7f, 0, 0.5f}, 0.002f, 6.5f);
  ripples.hit({-3, 0, 0.5f}, 0.002f, 6.5f);
  ripples.hit({1e30f, 0, 0.5f}, 0.002f, 6.5f);
  EXPECT_EQ(largest_of(ripples), 0);
  Ripples dry(pond(1));
  dry.hit({0.5f, 0, 0.5f}, 0.002f, 6.5f);
  dry.advance(1);
  EXPECT_EQ(largest_of(dry), 0);
}

TEST(Ripples, RefuseWhatCannotBe) {
  const auto with = [](auto change) {
    RippleOptions options = pond(1);
    change(options);
    return [options] { Ripples{options}; };
  };
  const float nan = std::nanf("");
  expect_refused(with([](RippleOptions& o) { o.high = o.low; }));
  expect_refused(with([&](RippleOptions& o) { o.high.x = nan; }));
  expect_refused(with([&](RippleOptions& o) { o.step = nan; }));
  expect_refused(with([](RippleOptions& o) { o.step = 0; }));
  expect_refused(with([](RippleOptions& o) { o.wavelength = 0; }));
  expect_refused(with([](RippleOptions& o) { o.damping = -1; }));
  expect_refused(with([&](RippleOptions& o) { o.strength = nan; }));
  expect_refused(with([](RippleOptions& o) { o.surface_tension = -1; }));
  expect_refused(with([](RippleOptions& o) { o.step = 1e-4f; }), ErrorCode::limit_exceeded);
  Ripples ripples = over(pond(1), 0.01f);
  expect_refused([&] { ripples.set_depths({1, 2, 3}); });
  expect_refused([&] { ripples.set_depths(std::vector<float>(ripples.heights().size(), nan)); });
  expect_refused([&] { ripples.hit({nan, 0, 0}, 0.002f, 6); });
  expect_refused([&] { ripples.hit({0.5f, 0, 0.5f}, -1, 6); });
  expect_refused([&] { ripples.hit({0.5f, 0, 0.5f}, 0.002f, kInfinity); });
  expect_refused([&] { ripples.advance(-1); });
  expect_refused([&] { ripples.advance(std::nan("")); });
  ripples.hit({0.5f, 0, 0.5f}, 0.002f, 6);
  expect_refused([&] { ripples.advance(1e30); }, ErrorCode::limit_exceeded);
}

}  // namespace
}  // namespace meniscus
