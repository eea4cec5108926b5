#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/field_axes.h"
#include "meniscus/sim.h"
#include "sim/ripples_step.h"

namespace meniscus {
namespace {

constexpr double kGravity = 9.81, kWaterDensity = 1000;
constexpr double kWaveEnergy = 0.06;  ///< part of the drop's that goes into waves
constexpr double kLeastRadius = 1.5;  ///< of the crater, in steps between points
constexpr double kSteepest = 0.4;     ///< of a crater's depth to its radius, where the waves are small
constexpr double kDeepest = 0.5;      ///< of the water that a crater takes
constexpr float kMostDiameter = 0.1f, kMostSpeed = 1000;

/// Radius of the half ball that a drop opens in deep water when its kinetic energy goes into raising the water and
/// into the new surface: pi g R^4 / 4 + pi sigma / rho R^2 = pi d^3 v^2 / 12.          [Engel1967] [PumphreyElmore1990]
double cavity_radius(double diameter, double speed, double tension_over_density) {
  const double energy = diameter * diameter * diameter * speed * speed / 12;
  const double root = std::sqrt(tension_over_density * tension_over_density + kGravity * energy);
  return std::sqrt(2 * energy / (root + tension_over_density));
}

}  // namespace

void Ripples::hit(vec3 point, float diameter, float speed) {
  const FieldAxes axes(options_.up);
  const double a = (double{point[axes.a]} - double{options_.low.x}) / double{options_.step};
  const double b = (double{point[axes.b]} - double{options_.low.y}) / double{options_.step};
  if (!std::isfinite(a) || !std::isfinite(b) || !(diameter > 0 && diameter <= kMostDiameter) ||
      !(speed >= 0 && speed <= kMostSpeed))
    throw Error(ErrorCode::invalid_argument,
                {"a hit of the ripples is out of range",
                 "a finite point, a diameter of 0 .. 0.1 m, a speed of 0 .. 1000 m/s",
                 fmt::format("({}, {}, {}), {} m, {} m/s", point.x, point.y, point.z, diameter, speed),
                 {},
                 {},
                 {},
                 {}});
  if (step_ == 0 || a < -0.5 || b < -0.5 || a >= width_ - 0.5 || b >= height_ - 0.5) return;
  const std::size_t width = static_cast<std::size_t>(width_);
  const int middle_i = static_cast<int>(std::lround(a)), middle_j = static_cast<int>(std::lround(b));
  if (!(speeds2_[padded(middle_i, middle_j)] > 0)) return;
  const double depth = depths_[static_cast<std::size_t>(middle_i) + width * static_cast<std::size_t>(middle_j)];

  // Crater and rim (1 - s)^3 (1 - 5 s), s = r^2 / (5 R^2), which hold the same amount; its own energy against gravity,
  // g A^2 0.1587 pi R^2, is the part of the drop's that waves carry.
  const double d = diameter, v = speed;
  const double cavity = cavity_radius(d, v, double{options_.surface_tension} / kWaterDensity);
  const double radius = std::max(cavity, kLeastRadius * double{options_.step});
  // A crater that is wider than the cavity would have slopes less by the square of their ratio with the same energy;
  // the real ones are short and steep, and slopes are what is seen. It gets a part of them back.
  double amplitude = std::sqrt(kWaveEnergy * d * d * d * v * v / 12 / (kGravity * 0.15873 * radius * radius));
  amplitude *= std::sqrt(radius / std::max(cavity, 1e-2 * radius));
  amplitude = std::min({amplitude, kSteepest * radius, kDeepest * depth}) * double{options_.strength};
  const double reach = std::sqrt(5.0) * radius / double{options_.step}, per_reach2 = 1 / (reach * reach);
  const int i0 = std::max(static_cast<int>(std::ceil(a - reach)), 0),
            j0 = std::max(static_cast<int>(std::ceil(b - reach)), 0);
  const int i1 = std::min(static_cast<int>(std::floor(a + reach)), width_ - 1),
            j1 = std::min(static_cast<int>(std::floor(b + reach)), height_ - 1);
  const auto shape = [&](int i, int j) {
    const double s = ((i - a) * (i - a) + (j - b) * (j - b)) * per_reach2;
    if (s >= 1 || !(speeds2_[padded(i, j)] > 0)) return 0.0;
    const double t = 1 - s;
    return t * t * t * (5 * s - 1);
  };
  // What the crater loses the rim gets, also where the shore cuts them off: the lesser one decides.
  double dug = 0, heaped = 0;
  for (int j = j0; j <= j1; ++j)
    for (int i = i0; i <= i1; ++i) {
      const double value = shape(i, j);
      (value < 0 ? dug : heaped) += std::abs(value);
    }
  if (dug == 0 || heaped == 0) return;
  const double both = std::min(dug, 2 * heaped);
  const double down = amplitude * both / dug, up = amplitude * both / heaped;
  const float per_decay = static_cast<float>(std::exp(options_.damping * step_));
  for (int j = j0; j <= j1; ++j)
    for (int i = i0; i <= i1; ++i) {
      const double value = shape(i, j);
      if (value == 0) continue;
      const std::size_t k = static_cast<std::size_t>(i) + width * static_cast<std::size_t>(j) + 1;
      const float change = static_cast<float>((value < 0 ? down : up) * value);
      now_[k] += change;
      before_[k] += per_decay * change;  // at rest
    }
  const std::size_t tiles_a = (width + kTileWidth - 1) / kTileWidth;
  for (int tb = j0 / kTileHeight; tb <= j1 / kTileHeight; ++tb)
    for (int ta = i0 / kTileWidth; ta <= i1 / kTileWidth; ++ta)
      moving_tiles_[static_cast<std::size_t>(ta) + tiles_a * static_cast<std::size_t>(tb)] = kTileMoves;
}

}  // namespace meniscus
