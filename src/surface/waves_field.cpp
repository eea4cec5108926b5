// Height fields of superposed waves.
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "surface/height_field_axes.h"
#include "surface/height_field_grid.h"

namespace meniscus {
namespace {

constexpr double kGravity = 9.81;     ///< m/s^2
constexpr int kFixedPoints = 12;      ///< steps before Newton's
constexpr int kNewton = 20;           ///< steps at most
constexpr double kTolerance = 1e-12;  ///< of a place, in wavelengths

/// A train as it is summed: z = amplitude cos(theta), theta = ka a + kb b + phase; a gerstner wave also carries the
/// water towards its crests, by -shift sin(theta) along its way.
struct Train {
  double amplitude, shift;  ///< m
  double ka, kb, k;         ///< 1/m; k is their length
  double phase;             ///< at the time asked for
};

[[noreturn]] void fail(std::string problem, std::string expected, std::string found) {
  throw Error(ErrorCode::invalid_argument,
              ErrorDetail{std::move(problem), std::move(expected), std::move(found), {}, {}, {}, {}});
}

void check(const WaveTrain& wave) {
  if (!(wave.amplitude >= 0) || !std::isfinite(wave.amplitude))
    fail("the amplitude of a wave is out of range", "0 m or more", fmt::format("{} m", wave.amplitude));
  if (!(wave.wavelength > 0) || !std::isfinite(wave.wavelength))
    fail("the length of a wave is out of range", "more than 0 m", fmt::format("{} m", wave.wavelength));
  if (!(wave.steepness >= 0 && wave.steepness <= 1))
    fail("the steepness of a wave is out of range", "0 to 1", fmt::format("{}", wave.steepness));
  if (!std::isfinite(wave.direction_deg) || !std::isfinite(wave.phase_deg) || !std::isfinite(wave.speed))
    fail("a wave has a direction, phase or speed that is none", "finite numbers",
         fmt::format("{} degrees, {} degrees, {} m/s", wave.direction_deg, wave.phase_deg, wave.speed));
}

std::vector<Train> trains_of(std::span<const WaveTrain> waves, double depth, double time) {
  constexpr double kTurn = 2 * std::numbers::pi, kDegree = std::numbers::pi / 180;
  std::vector<Train> trains;
  double steepest = 0;  // sum of the slopes of the gerstner waves
  for (const WaveTrain& wave : waves) {
    const double k = kTurn / static_cast<double>(wave.wavelength);
    const double direction = kDegree * static_cast<double>(wave.direction_deg);
    const double omega =
        wave.speed != 0 ? k * static_cast<double>(wave.speed) : std::sqrt(kGravity * k * std::tanh(k * depth));
    // Whole turns are left out, so that late times are as exact as early ones.
    const double phase =
        std::fmod(kDegree * static_cast<double>(wave.phase_deg) - std::fmod(omega * time, kTurn), kTurn);
    trains.push_back(
        {static_cast<double>(wave.amplitude), 0, k * std::cos(direction), k * std::sin(direction), k, phase});
    if (wave.kind == WaveTrain::Kind::gerstner) steepest += k * static_cast<double>(wave.amplitude);
  }
  // Crests fold where the sum of k shift exceeds one: each wave gets the part of its own slope.
  for (std::size_t i = 0; i < trains.size(); ++i)
    if (waves[i].kind == WaveTrain::Kind::gerstner && steepest > 0)
      trains[i].shift = static_cast<double>(waves[i].steepness) * trains[i].amplitude / steepest;
  return trains;
}

struct Place {
  double a, b;
};

/// What lies at rest at (a0, b0) is carried to this place; its derivatives by a0 and b0.
struct Carried {
  double a, b, aa, ab, bb;
};
Carried carried(std::span<const Train> trains, Place rest) {
  Carried to{rest.a, rest.b, 1, 0, 1};
  for (const Train& train : trains) {
    if (train.shift == 0) continue;
    const double theta = train.ka * rest.a + train.kb * rest.b + train.phase;
    const double da = train.ka / train.k, db = train.kb / train.k;
    const double sine = train.shift * std::sin(theta), cosine = train.shift * std::cos(theta);
    to.a -= da * sine;
    to.b -= db * sine;
    to.aa -= da * train.ka * cosine;
    to.ab -= da * train.kb * cosine;  // the matrix is symmetric
    to.bb -= db * train.kb * cosine;
  }
  return to;
}

/// What is carried to `place` has lain here: by fixed-point iteration, which converges as waves do not fold, and then
/// by Newton's, which is quick except at the sharpest crests.
Place rest_of(std::span<const Train> trains, Place place) {
  double shortest = 0, shifts = 0;
  for (const Train& train : trains) {
    shortest = std::max(shortest, train.k);
    shifts += train.shift;
  }
  if (shifts == 0) return place;
  const double tolerance = kTolerance / shortest;
  Place rest = place;
  const auto miss = [&](const Carried& at) { return Place{place.a - at.a, place.b - at.b}; };
  for (int i = 0; i < kFixedPoints; ++i) {
    const Place off = miss(carried(trains, rest));
    rest = {rest.a + off.a, rest.b + off.b};
  }
  for (int i = 0; i < kNewton; ++i) {
    const Carried at = carried(trains, rest);
    const Place off = miss(at);
    if (std::abs(off.a) + std::abs(off.b) <= tolerance) break;
    const double determinant = at.aa * at.bb - at.ab * at.ab;
    Place by = off;  // the fixed-point step
    if (determinant > 1e-9)
      by = {(at.bb * off.a - at.ab * off.b) / determinant, (at.aa * off.b - at.ab * off.a) / determinant};
    const double longest = 0.25 / shortest, size = std::hypot(by.a, by.b);
    if (size > longest) by = {by.a * longest / size, by.b * longest / size};
    Place next{rest.a + by.a, rest.b + by.b};
    const Place left = miss(carried(trains, next));
    if (std::hypot(left.a, left.b) > std::hypot(off.a, off.b)) next = {rest.a + off.a, rest.b + off.b};
    rest = next;
  }
  return rest;
}

/// Height over still water and the normal that is not unit, of what has lain at `rest`.
struct Wave {
  double height, normal_a, normal_b, normal_up;
};
Wave wave_at(std::span<const Train> trains, Place rest) {
  double height = 0, by_a = 0, by_b = 0;
  for (const Train& train : trains) {
    const double theta = train.ka * rest.a + train.kb * rest.b + train.phase;
    height += train.amplitude * std::cos(theta);
    by_a -= train.amplitude * train.ka * std::sin(theta);
    by_b -= train.amplitude * train.kb * std::sin(theta);
  }
  // The cross product of the tangents (aa, ab, by_a) and (ab, bb, by_b).
  const Carried at = carried(trains, rest);
  const Wave wave{height, at.ab * by_b - at.bb * by_a, at.ab * by_a - at.aa * by_b, at.aa * at.bb - at.ab * at.ab};
  return wave;
}

}  // namespace

HeightField height_field(const WaveFieldOptions& options, double time) {
  float shortest = std::numeric_limits<float>::infinity();
  double amplitudes = 0;
  for (const WaveTrain& wave : options.waves) {
    check(wave);
    shortest = std::min(shortest, wave.wavelength);
    amplitudes += static_cast<double>(wave.amplitude);
  }
  if (!std::isfinite(time))
    fail("the time of a wave field is none", "a finite number of seconds", fmt::format("{}", time));
  const FieldAxes axes(options.up);
  const vec3 extent = options.region.high - options.region.low;
  const double depth = static_cast<double>(extent[axes.up]);
  if (!(depth > 0))
    fail("a wave field has no depth", "a region that is more than 0 m high", fmt::format("{} m", depth));
  if (!(amplitudes < depth))
    fail("the waves reach the floor", fmt::format("amplitudes of less than {} m together", static_cast<float>(depth)),
         fmt::format("{} m", amplitudes));
  const float longer = std::max(extent[axes.a], extent[axes.b]);
  const float step = options.step != 0 ? options.step : std::max(0.125f * shortest, longer / 256.0f);
  if (step > 0.5f * shortest)
    fail("a wave is too short for the columns of its field",
         fmt::format("two columns a wavelength, {} m and more", 2 * step), fmt::format("{} m", shortest));
  HeightField field = blank_field(options.up, options.region, std::isfinite(step) ? step : longer / 256.0f);
  const std::vector<Train> trains = trains_of(options.waves, depth, time);
  const int width = field.height.width(), height = field.height.height();
  field.normal = Image<vec3>(width, height);
  const double level = static_cast<double>(options.region.high[axes.up]);
  parallel_for(static_cast<std::size_t>(height), 4, [&](std::size_t begin, std::size_t end) {
    for (int j = static_cast<int>(begin); j < static_cast<int>(end); ++j)
      for (int i = 0; i < width; ++i) {
        const Place place{static_cast<double>(field.low.x) + i * static_cast<double>(field.step.x),
                          static_cast<double>(field.low.y) + j * static_cast<double>(field.step.y)};
        const Wave wave = wave_at(trains, rest_of(trains, place));
        field.height(i, j) = static_cast<float>(level + wave.height);
        const glm::dvec3 normal{wave.normal_a, wave.normal_b, std::max(wave.normal_up, 1e-9)};
        const glm::dvec3 n = normal / glm::length(normal);
        field.normal(i, j) = axes.place(static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z));
      }
  });
  return field;
}

}  // namespace meniscus
