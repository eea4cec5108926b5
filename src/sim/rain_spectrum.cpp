#include "sim/rain_spectrum.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "meniscus/formulas/rain.h"
#include "meniscus/sim.h"

namespace meniscus {
namespace {

constexpr std::size_t kSteps = 4096, kGuides = 4096;
constexpr double kWaterRate = 1.0 / 3.6e6;  ///< m/s in a mm/h

/// Drops in air between two diameters, mm, and what they do, by the middles of `steps` steps.
struct Sums {
  double number = 0;   ///< that come down, 1/(m^2 s)
  double water = 0;    ///< that comes down, m/s
  double section = 0;  ///< of their cross sections, m^2/m^3
};
Sums sums_between(double rate, double low_mm, double high_mm, std::size_t steps) {
  Sums sums;
  const double width = (high_mm - low_mm) / static_cast<double>(steps);
  for (std::size_t i = 0; i < steps; ++i) {
    const double mm = low_mm + (static_cast<double>(i) + 0.5) * width, d = 1e-3 * mm;
    const double count = width * double{formulas::marshall_palmer(static_cast<float>(mm), static_cast<float>(rate))};
    const double arrivals = count * double{fall_speed(static_cast<float>(d))};
    sums.number += arrivals;
    sums.water += arrivals * std::numbers::pi / 6 * d * d * d;
    sums.section += count * std::numbers::pi / 4 * d * d;
  }
  return sums;
}

}  // namespace

RainSpectrum::RainSpectrum(double rate, double smallest_mm, double largest_mm)
    : below_(kSteps + 1, 0.0), guide_(kGuides + 1, 0) {
  if (!(rate > 0)) return;  // without water there are no drops
  // Sizes fall by e every 1 / Lambda: beyond 40 of them there is nothing.
  const double e_fold_mm = std::pow(rate, 0.21) / 4.1;
  const Sums all = sums_between(rate, 0, 40 * e_fold_mm, 1 << 15);
  scale_ = rate * kWaterRate / all.water;
  extinction_ = 2 * scale_ * all.section;

  // Drops that come down below each of the diameters, by Simpson's rule within each step.
  first_ = 1e-3 * smallest_mm;
  step_ = 1e-3 * (largest_mm - smallest_mm) / kSteps;
  const auto density = [&](double d) {  // 1/(m^2 s) per m of diameter
    return 1e3 * scale_ * double{formulas::marshall_palmer(static_cast<float>(1e3 * d), static_cast<float>(rate))} *
           double{fall_speed(static_cast<float>(d))};
  };
  const auto brought = [&](double d) { return density(d) * std::numbers::pi / 6 * d * d * d; };
  for (std::size_t i = 0; i < kSteps; ++i) {
    const double low = first_ + static_cast<double>(i) * step_, middle = low + 0.5 * step_, high = low + step_;
    below_[i + 1] = below_[i] + step_ / 6 * (density(low) + 4 * density(middle) + density(high));
    water_ += step_ / 6 * (brought(low) + 4 * brought(middle) + brought(high));
  }
  arrivals_ = below_.back();
  // Drops that large hardly ever come in so little rain: none are made.
  if (!(arrivals_ > 1e-100)) arrivals_ = water_ = 0;
  const double per_all = arrivals_ > 0 ? 1 / arrivals_ : 0;
  for (std::size_t i = 0; i <= kSteps; ++i)
    below_[i] = arrivals_ > 0 ? below_[i] * per_all : static_cast<double>(i) / kSteps;
  below_.back() = 1;
  std::size_t i = 0;
  for (std::size_t g = 0; g <= kGuides; ++g) {
    while (i + 1 < kSteps && below_[i + 1] < static_cast<double>(g) / kGuides) ++i;
    guide_[g] = static_cast<std::uint32_t>(i);
  }
}

}  // namespace meniscus
