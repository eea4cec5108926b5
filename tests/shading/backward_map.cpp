#include "shading/backward_map.h"

#include <gtest/gtest.h>
#include <glm/common.hpp>
#include <numbers>

#include "caustics_fields.h"

namespace meniscus {
namespace {

using tests::at_angle;
using tests::crossing;
using tests::field_of;
using tests::still;
using tests::Wave;
using tests::Waves;

PlaneMap map_of(const HeightField& field, vec3 sun, int size) {
  const WaterLevel level(field);
  const EnteringLight light = entering_light(level.frame(), sun, vec3{1.0f}, tests::clear());
  return backward_map(field, level, light, {}, 0.0f, size);
}

double power(const PlaneMap& map) {
  double sum = 0;
  for (const float value : map.value) sum += static_cast<double>(value);
  return sum * static_cast<double>(map.texel.x) * static_cast<double>(map.texel.y);
}

/// Sun light per horizontal area that crosses the waves of a rectangle, over that of the sun on a level surface.
double crosses(const Waves& waves, vec3 sun, glm::dvec2 low, glm::dvec2 high) {
  constexpr int kCells = 300;
  double sum = 0;
  for (int j = 0; j < kCells; ++j)
    for (int i = 0; i < kCells; ++i) {
      const Wave wave =
          waves(low.x + (high.x - low.x) * (i + 0.5) / kCells, low.y + (high.y - low.y) * (j + 0.5) / kCells);
      const glm::dvec3 upright{-wave.da, 1, -wave.db}, s(sun);
      const double cosine = glm::dot(upright, s) / glm::length(upright);
      if (cosine > 0) sum += glm::dot(upright, s) / s.y * (1 - tests::reflectance(std::acos(cosine), 1.333f));
    }
  return sum * (high.x - low.x) * (high.y - low.y) / (kCells * kCells);
}

TEST(BackwardMap, IsEvenUnderStillWater) {
  for (const double angle : {0.0, 0.5, 1.1})
    for (const int size : {64, 100, 129, 200}) {
      const PlaneMap map = map_of(field_of(still(0.5), {-1, -1}, {1, 1}, 129), at_angle(angle), size);
      const double expected = 1 - tests::reflectance(angle, 1.333f);
      for (float a = -0.9f; a < 0.95f; a += 0.0123f)
        for (float b = -0.9f; b < 0.95f; b += 0.31f)
          ASSERT_NEAR(static_cast<double>(map.at({a, b})) / expected, 1.0, 0.01) << angle << " " << size << " " << a;
      EXPECT_EQ(map.at({1.3f, 0}), 0.0f);
    }
}

TEST(BackwardMap, BringsAllLightToThePlaneThatCrossesTheWaves) {
  for (const double amplitude : {0.004, 0.012})
    for (const double angle : {0.0, 0.6}) {
      const Waves waves = crossing(0.5, amplitude);
      const PlaneMap map = map_of(field_of(waves, {-1, -0.7f}, {1, 0.7f}, 200), at_angle(angle), 160);
      EXPECT_NEAR(power(map) / crosses(waves, at_angle(angle), {-1, -0.7}, {1, 0.7}), 1.0, 0.01) << amplitude;
    }
}

/// What a place of the floor gets, as [Cords2008] says it: rays from the place to the waves, out of the water by eq. 3,
/// into a sun whose disc is a Gaussian. In double precision, over the functions.
double traced_backwards(const Waves& waves, vec3 sun, glm::dvec2 place, double spread, double cone, int rays) {
  const double eta = static_cast<double>(1.333f);
  const glm::dvec3 s(sun);
  const double sine = std::sqrt(s.x * s.x + s.z * s.z), tangent = std::tan(std::asin(sine / eta));
  const glm::dvec2 towards = sine > 1e-9 ? glm::dvec2{s.x, s.z} / sine * tangent : glm::dvec2{0.0};
  double sum = 0;
  for (int j = 0; j < rays; ++j)
    for (int i = 0; i < rays; ++i) {
      const glm::dvec2 slope = towards + cone * glm::dvec2{2 * (i + 0.5) / rays - 1, 2 * (j + 0.5) / rays - 1};
      // Up to the surface: height above the floor by Newton's method.
      double up = 0.5;
      Wave wave{};
      for (int k = 0; k < 12; ++k) {
        wave = waves(place.x + slope.x * up, place.y + slope.y * up);
        up -= (up - wave.height) / (1 - wave.da * slope.x - wave.db * slope.y);
      }
      const glm::dvec3 ray = glm::normalize(glm::dvec3{slope.x, 1, slope.y});
      const glm::dvec3 normal = glm::normalize(glm::dvec3{wave.da, -1, wave.db});  // on the water's side
      const double cos_i = -glm::dot(ray, normal), k = 1 - eta * eta * (1 - cos_i * cos_i);
      if (!(k > 0)) continue;
      const glm::dvec3 out = eta * ray + (eta * cos_i - std::sqrt(k)) * normal;
      const glm::dvec3 off = out - s;
      const double squared = glm::dot(off, off);
      if (squared > 36 * spread * spread) continue;
      const double radiance = std::exp(-0.5 * squared / (spread * spread)) / (2 * std::numbers::pi * spread * spread);
      sum += eta * eta * radiance * (1 - tests::reflectance(std::acos(std::sqrt(k)), eta)) * std::pow(ray.y, 4);
    }
  return sum * (2 * cone / rays) * (2 * cone / rays) / s.y;
}

TEST(TracedBackwards, IsFresnelsTransmittanceUnderStillWater) {
  for (const double angle : {0.0, 0.7})
    EXPECT_NEAR(traced_backwards(still(0.5), at_angle(angle), {0.1, 0}, 0.01, 0.1, 300),
                1 - tests::reflectance(angle, 1.333f), 0.005);
}

TEST(BackwardMap, IsWhatIsTracedBackwardsIntoTheSun) {
  const Waves waves = crossing(0.5, 0.015);
  for (const double angle : {0.0, 0.4}) {
    const vec3 sun = at_angle(angle);
    PlaneMap map = map_of(field_of(waves, {-1, -1}, {1, 1}, 257), sun, 256);
    // A sun as wide as what the spline, the samples and the lookup blur, about 0.65 texels.
    const double texel = static_cast<double>(map.texel.x), spread = 0.65 * texel / 0.5 * 1.333;
    const double eta = static_cast<double>(1.333f), slide = 0.5 * std::tan(std::asin(std::sin(angle) / eta));
    double error = 0, sum = 0, contrast = 0;
    constexpr int kPlaces = 14;
    for (int k = 0; k < kPlaces; ++k) {
      const glm::dvec2 entry{-0.6 + 0.09 * k, 0.5 * std::sin(2.0 * k)};
      const double expected = traced_backwards(waves, sun, {entry.x - slide, entry.y}, spread, 0.12, 200);
      const double found = static_cast<double>(map.at(vec2(entry)));
      error += std::abs(found - expected);
      contrast += std::abs(expected - 0.98);
      sum += expected;
    }
    EXPECT_LT(error / sum, 0.06) << angle;
    EXPECT_GT(contrast / sum, 0.12) << "the waves bend too little to tell";
  }
}

TEST(BackwardMap, GivesTheSameBitsWithAnyNumberOfThreads) {
  const HeightField field = field_of(crossing(0.5, 0.01), {0, 0}, {2, 1}, 150);
  const auto with = [&](int threads) {
    const ThreadLimit limit(threads);
    return map_of(field, at_angle(0.4), 200);
  };
  const PlaneMap one = with(1), five = with(5);
  ASSERT_EQ(one.value.size(), five.value.size());
  for (std::size_t i = 0; i < one.value.size(); ++i) ASSERT_EQ(one.value[i], five.value[i]);
}

TEST(BackwardMap, IsTheSameWhicheverWayIsUp) {
  const vec3 sun = glm::normalize(vec3{0.3f, 1, 0.2f});
  const PlaneMap y = map_of(field_of(crossing(0.5, 0.01), {-1, -1}, {1, 1}, 65, Axis::y), sun, 64);
  const PlaneMap z = map_of(field_of(crossing(0.5, 0.01), {-1, -1}, {1, 1}, 65, Axis::z), {sun.x, sun.z, sun.y}, 64);
  for (std::size_t i = 0; i < y.value.size(); ++i) ASSERT_NEAR(y.value[i], z.value[i], 1e-4f);
}

TEST(BackwardMap, IsEmptyWithoutWater) {
  HeightField field = field_of(still(0.5), {0, 0}, {1, 1}, 16);
  for (float& height : field.height) height = -std::numeric_limits<float>::infinity();
  EXPECT_TRUE(map_of(field, at_angle(0), 64).value.empty());
}

TEST(BackwardMap, IsDarkUnderHoles) {
  HeightField field = field_of(still(0.5), {0, 0}, {1, 1}, 101);
  for (int j = 0; j < 101; ++j)
    for (int i = 40; i < 60; ++i) field.height(i, j) = -std::numeric_limits<float>::infinity();
  const PlaneMap map = map_of(field, at_angle(0), 100);
  EXPECT_EQ(map.at({0.5f, 0.5f}), 0.0f);
  EXPECT_NEAR(map.at({0.3f, 0.5f}), 0.98f, 0.01f);
  EXPECT_NEAR(power(map) / 0.98, 0.8, 0.012);
}

}  // namespace
}  // namespace meniscus
