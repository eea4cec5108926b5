#include "sim/rain_thinning.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace meniscus {
namespace {

constexpr int kPerOctave = 4, kOctaves = 32;  ///< of the table over q
constexpr int kRings = 1024;

/// Part of a circle around the middle of a rectangle that lies in it.
double part_within(glm::dvec2 half, double radius) {
  double part = 1;
  for (const double side : {half.x, half.y})
    if (radius > side) part -= 2 / std::numbers::pi * std::acos(side / radius);
  return std::max(part, 0.0);
}

}  // namespace

RainThinning::RainThinning(const RainSpectrum& spectrum, double least)
    : least_(least), first_(spectrum.first()), step_(spectrum.step()) {
  double mean = 0;
  for (std::size_t i = 0; i < spectrum.steps(); ++i) mean += spectrum.part(i) * spectrum.middle(i);
  for (std::size_t i = 0; i < spectrum.steps(); ++i) {
    const double relative = spectrum.middle(i) / mean;
    favour_.push_back(relative > 1 ? relative * relative : 1);
  }
  kept_.assign(kOctaves * kPerOctave + 1, 0.0);
  for (std::size_t k = 0; k < kept_.size(); ++k) {
    const double q = std::exp2(-static_cast<double>(k) / kPerOctave);
    for (std::size_t i = 0; i < spectrum.steps(); ++i) kept_[k] += spectrum.part(i) * kept(q, spectrum.middle(i));
  }
}

double RainThinning::favour(double diameter) const {
  const double place = std::clamp((diameter - first_) / step_, 0.0, static_cast<double>(favour_.size() - 1));
  return favour_[static_cast<std::size_t>(place)];
}

double RainThinning::kept(double q, double diameter) const {
  return std::max(least_, std::min(1.0, q * favour(diameter)));
}

double RainThinning::kept_at(double q) const {
  const double place = std::clamp(-std::log2(q) * kPerOctave, 0.0, static_cast<double>(kept_.size() - 1));
  const std::size_t k = std::min(static_cast<std::size_t>(place), kept_.size() - 2);
  const double t = place - static_cast<double>(k);
  return kept_[k] + t * (kept_[k + 1] - kept_[k]);
}

double RainThinning::kept_over(glm::dvec2 sides, double whole) const {
  // Rings of even width in the logarithm of the radius, from where all are made out to the corners.
  const glm::dvec2 half = 0.5 * sides;
  const double corner = std::hypot(half.x, half.y), area = sides.x * sides.y;
  if (whole >= corner) return kept_at(1);
  const double first = std::max(whole, 1e-4 * std::min(half.x, half.y));
  const double ratio = std::pow(corner / first, 1.0 / kRings);
  double sum = 0, inner = 0, radius = first;
  // The middle disk by even rings: parts of it may stick out of a narrow region.
  for (int i = 0; i < kRings; ++i) {
    const double outer = first * (i + 1) / kRings, middle = first * (i + 0.5) / kRings;
    sum += std::numbers::pi * (outer * outer - inner * inner) * part_within(half, middle) *
           kept_at(whole > 0 ? std::min(1.0, whole * whole / (middle * middle)) : 1e-300);
    inner = outer;
  }
  for (int i = 0; i < kRings; ++i) {
    const double outer = radius * ratio, middle = std::sqrt(radius * outer);
    sum += std::numbers::pi * (outer * outer - radius * radius) * part_within(half, middle) *
           kept_at(std::max(whole * whole / (middle * middle), 1e-300));
    radius = outer;
  }
  return std::min(sum / area, 1.0);
}

RainLayer::RainLayer(const RainSpectrum& spectrum, const RainThinning& thinning, double low, double high)
    : low_(low), high_(high), least_(thinning.least()), first_(spectrum.first()), step_(spectrum.step()) {
  below_.assign(spectrum.steps() + 1, 0.0);
  for (std::size_t i = 0; i < spectrum.steps(); ++i) {
    const Between u = between(thinning.favour(spectrum.middle(i)));
    below_[i + 1] = below_[i] + spectrum.part(i) * (u.high - u.low);
  }
  share_ = below_.back();
  if (share_ > 0)
    for (double& below : below_) below /= share_;
}

RainLayer::Between RainLayer::between(double favour) const {
  if (low_ <= 0) return {0, std::max(least_, std::min(1.0, favour * high_))};
  const double low = std::max(least_, favour * low_);
  return {low, std::max(low, std::min(1.0, favour * high_))};
}

RainLayer::Drop RainLayer::drop(double part, double within, const RainThinning& thinning) const {
  // The last step whose beginning is not above the part: steps without drops are passed over.
  const auto above = std::upper_bound(below_.begin(), below_.end(), part);
  const std::size_t i = static_cast<std::size_t>(
      std::clamp<std::ptrdiff_t>(above - below_.begin() - 1, 0, static_cast<std::ptrdiff_t>(below_.size()) - 2));
  const double wide = below_[i + 1] - below_[i], t = wide > 0 ? std::clamp((part - below_[i]) / wide, 0.0, 1.0) : 0.5;
  const double diameter = first_ + step_ * (static_cast<double>(i) + t);
  const Between u = between(thinning.favour(first_ + step_ * (static_cast<double>(i) + 0.5)));
  return {static_cast<float>(diameter), static_cast<float>(u.low + within * (u.high - u.low))};
}

}  // namespace meniscus
