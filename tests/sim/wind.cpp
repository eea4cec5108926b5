#include <gtest/gtest.h>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>

#include "base/random.h"
#include "meniscus/sim.h"

namespace meniscus {
namespace {

TEST(Wind, IsTheSameEverywhereWithoutGustsAndField) {
  WindOptions options;
  options.velocity = {3, 0, -2};
  const Wind wind(options);
  EXPECT_TRUE(wind.still());
  EXPECT_EQ(wind.at({1, 2, 3}, 4), options.velocity);
  EXPECT_EQ(wind.carried(2, 5), glm::dvec3(9, 0, -6));
}

TEST(Wind, HasGustsOfItsDeviationAndNoMean) {
  WindOptions options;
  options.velocity = {3, 0, 4};
  options.gust = 2;
  for (const std::uint64_t seed : {1, 2, 3}) {
    options.seed = seed;
    const Wind wind(options);
    EXPECT_FALSE(wind.still());
    double along = 0, across = 0, along2 = 0, across2 = 0, both = 0;
    const int count = 200000;
    for (int i = 0; i < count; ++i) {
      const vec3 gust = wind.at({0, 0, 0}, 0.0503 * i) - options.velocity;
      EXPECT_NEAR(gust.y, 0, 1e-6f);
      const double p = 0.6 * gust.x + 0.8 * gust.z, q = 0.8 * gust.x - 0.6 * gust.z;
      along += p / count;
      across += q / count;
      along2 += p * p / count;
      across2 += q * q / count;
      both += p * q / count;
    }
    EXPECT_NEAR(along, 0, 0.01);
    EXPECT_NEAR(across, 0, 0.01);
    EXPECT_NEAR(std::sqrt(along2), 2, 0.02);
    EXPECT_NEAR(std::sqrt(across2), 1, 0.01);
    EXPECT_LT(std::abs(both), 0.1);
  }
}

TEST(Wind, CarriesByTheIntegralOfItself) {
  WindOptions options;
  options.velocity = {3, 0, 4};
  options.gust = 2;
  const Wind wind(options);
  glm::dvec3 sum{0.0};
  const int steps = 20000;
  for (int i = 0; i < steps; ++i) sum += glm::dvec3(wind.at({0, 0, 0}, 7 + 5.0 * (i + 0.5) / steps)) * (5.0 / steps);
  EXPECT_LT(glm::distance(wind.carried(7, 12), sum), 1e-4);
  EXPECT_LT(glm::distance(wind.carried(12, 7), -sum), 1e-4);
}

TEST(Wind, GustsKeepToTheGround) {
  for (const Axis up : {Axis::x, Axis::y, Axis::z}) {
    WindOptions options;
    options.up = up;
    options.gust = 3;
    const Wind wind(options);
    const int axis = static_cast<int>(up);
    float largest[3] = {0, 0, 0};
    for (int i = 0; i < 1000; ++i)
      for (int a = 0; a < 3; ++a) largest[a] = std::max(largest[a], std::abs(wind.at({0, 0, 0}, 0.1 * i)[a]));
    EXPECT_LT(largest[axis], 1e-5f);
    EXPECT_GT(largest[(axis + 1) % 3], 1);
    EXPECT_GT(largest[(axis + 2) % 3], 1);
  }
}

std::shared_ptr<Particles> points_of(const std::vector<vec3>& places, const std::function<vec3(vec3)>& velocity) {
  auto points = std::make_shared<Particles>();
  Attribute values{"velocity", 3, {}};
  for (const vec3 p : places) {
    points->x.push_back(p.x);
    points->y.push_back(p.y);
    points->z.push_back(p.z);
    const vec3 v = velocity(p);
    values.values.insert(values.values.end(), {v.x, v.y, v.z});
  }
  points->attributes.push_back(values);
  return points;
}
std::vector<vec3> lattice() {
  std::vector<vec3> places;
  for (int x = 0; x < 5; ++x)
    for (int z = 0; z < 4; ++z)
      for (int y = 0; y < 3; ++y) places.push_back(vec3{1, 2, 3} + vec3{0.5f, 0.3f, 0.7f} * vec3{x, y, z});
  return places;
}
std::vector<vec3> scattered(int count) {
  std::vector<vec3> places;
  Draws draws(4, 0);
  for (int i = 0; i < count; ++i) {
    const double x = draws.between(-3, 5), y = draws.between(0, 2);
    places.push_back(vec3(x, y, draws.between(1, 4)));
  }
  return places;
}
Wind through(const std::shared_ptr<Particles>& field) {
  WindOptions options;
  options.velocity = {100, 100, 100};
  options.field = field;
  return Wind(options);
}
vec3 swirl(vec3 p) { return {std::sin(p.x) + p.z, p.x * p.y, std::cos(p.z)}; }

TEST(WindField, IsExactAtItsPoints) {
  for (const auto& places : {lattice(), scattered(500), scattered(5), scattered(1)}) {
    const Wind wind = through(points_of(places, swirl));
    EXPECT_FALSE(wind.still());
    for (const vec3 p : places) EXPECT_LT(glm::distance(wind.at(p, 3), swirl(p)), 1e-4f);
  }
}

TEST(WindField, KeepsConstants) {
  for (const auto& places : {lattice(), scattered(500), scattered(7)}) {
    const Wind wind = through(points_of(places, [](vec3) { return vec3{1, -2, 3}; }));
    Draws draws(2, 0);
    for (int i = 0; i < 1000; ++i) {
      const double x = draws.between(-6, 8), y = draws.between(-2, 5);
      EXPECT_LT(glm::distance(wind.at(vec3(x, y, draws.between(-1, 8)), 0), vec3{1, -2, 3}), 1e-5f);
    }
  }
}

TEST(WindField, IsTrilinearOnALattice) {
  const auto linear = [](vec3 p) { return vec3{1 + p.x * p.y, p.z - p.x, p.x * p.y * p.z}; };
  const Wind wind = through(points_of(lattice(), linear));
  Draws draws(3, 0);
  for (int i = 0; i < 1000; ++i) {
    const double x = draws.between(1, 3), y = draws.between(2, 2.6);
    const vec3 p(x, y, draws.between(3, 5.1));
    EXPECT_LT(glm::distance(wind.at(p, 0), linear(p)), 1e-4f);
  }
}

TEST(WindField, IsHeldBeyondItsPoints) {
  for (const auto& places : {lattice(), scattered(500)}) {
    const Wind wind = through(points_of(places, swirl));
    EXPECT_EQ(wind.at({1e6f, 2.2f, 3.5f}, 0), wind.at({1e9f, 2.2f, 3.5f}, 0));
    EXPECT_EQ(wind.at({2, -5, 3.5f}, 0), wind.at({2, -50, 3.5f}, 0));
  }
}

// Modified inverse distances over all points, sorted: what the search by cells must find.
TEST(WindField, TakesTheEightNearest) {
  const std::vector<vec3> places = scattered(400);
  const Wind wind = through(points_of(places, swirl));
  Draws draws(6, 0);
  for (int i = 0; i < 300; ++i) {
    const double x = draws.between(-2.9, 4.9), y = draws.between(0.05, 1.95);
    const vec3 p(x, y, draws.between(1.05, 3.95));
    std::vector<std::pair<double, vec3>> near;
    for (const vec3 q : places) near.emplace_back(glm::distance(glm::dvec3(p), glm::dvec3(q)), q);
    std::sort(near.begin(), near.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    glm::dvec3 sum{0.0};
    double weights = 0;
    for (std::size_t k = 0; k < 8; ++k) {
      const double w = std::pow(1 / near[k].first - 1 / near[8].first, 2);
      sum += w * glm::dvec3(swirl(near[k].second));
      weights += w;
    }
    EXPECT_LT(glm::distance(glm::dvec3(wind.at(p, 0)), sum / weights), 1e-3) << i;
  }
}

TEST(WindField, HasNoJumps) {
  const Wind wind = through(points_of(scattered(300), swirl));
  vec3 before = wind.at({-2, 1, 2}, 0);
  for (int i = 1; i < 60000; ++i) {
    const vec3 now = wind.at({-2 + 1e-4f * static_cast<float>(i), 1, 2 + 1e-5f * static_cast<float>(i)}, 0);
    EXPECT_LT(glm::distance(now, before), 0.02f);
    before = now;
  }
}

TEST(WindField, MayHaveGusts) {
  WindOptions options;
  options.field = points_of(lattice(), [](vec3) { return vec3{0, 0, 5}; });
  options.gust = 1;
  const Wind wind(options);
  double mean = 0, squares = 0;
  for (int i = 0; i < 20000; ++i) {
    const double v = wind.at({2, 2, 4}, 0.11 * i).z - 5;
    mean += v / 20000;
    squares += v * v / 20000;
  }
  EXPECT_NEAR(mean, 0, 0.02);
  EXPECT_NEAR(squares, 1, 0.05);
}

void expect_refused(const WindOptions& options) {
  try {
    Wind{options};
    FAIL() << "not refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::invalid_argument) << error.what();
  }
}

TEST(Wind, RefusesWhatCannotBe) {
  const float nan = std::nanf("");
  WindOptions options;
  options.velocity.y = nan;
  expect_refused(options);
  options = {};
  options.gust = -1;
  expect_refused(options);
  options = {};
  options.gust_period = 0;
  expect_refused(options);
  options = {};
  options.field = std::make_shared<Particles>();
  expect_refused(options);
  auto field = points_of(scattered(4), swirl);
  field->attributes[0].name = "speed";
  options.field = field;
  expect_refused(options);
  field = points_of(scattered(4), swirl);
  field->attributes[0].values[3] = nan;
  options.field = field;
  expect_refused(options);
  field = points_of(scattered(4), swirl);
  field->attributes[0].values.pop_back();
  options.field = field;
  expect_refused(options);
}

TEST(WindField, TakesPointsInOnePlace) {
  const Wind wind = through(points_of(std::vector<vec3>(20, vec3{1, 2, 3}), swirl));
  const vec3 v = wind.at({5, 6, 7}, 0);
  EXPECT_LT(glm::distance(v, swirl({1, 2, 3})), 1e-4f);
}

}  // namespace
}  // namespace meniscus
