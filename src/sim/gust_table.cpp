#include "sim/gust_table.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace meniscus {
namespace {

constexpr double kOff = 1e-6;        ///< m that a cubic may be off
constexpr double kChordsOff = 0.04;  ///< m that a chord may stand off at the knots
constexpr double kMostCorners = 4096;
constexpr double kLongestStep = 1;   ///< s
constexpr double kFastest = 8.1;     ///< times that the fastest gusts are as fast as the slowest
constexpr double kDeviations = 2.0;  ///< of the fourth derivative, that it hardly exceeds

/// Cubics of points h apart stand off a curve by h^4 / 384 of its fourth derivative.
double step_of(const WindOptions& options, const Wind& wind) {
  const double rate = kFastest * 2 * std::numbers::pi / double{options.gust_period};
  const double fourth = kDeviations * double{wind.gust_acceleration()} * rate * rate;
  return std::min(kLongestStep, std::sqrt(std::sqrt(384 * kOff / fourth)));
}

}  // namespace

GustTable::GustTable(const Wind& wind, const Wind& calm, const WindOptions& options, double start)
    : wind_(wind),
      mean_(calm.carried(0, 1)),
      calm_(calm.at(vec3(0.0f), start)),
      start_(start),
      step_(step_of(options, wind)),
      apart_(std::sqrt(8 * kChordsOff / (kDeviations * double{wind.gust_acceleration()}))),
      chunks_(std::make_unique<std::atomic<const Chunk*>[]>(kChunks)) {}

GustTable::~GustTable() {
  for (std::size_t i = 0; i < kChunks; ++i) delete chunks_[i].load();
}

GustTable::Knot GustTable::knot(double time) const {
  return {wind_.carried(start_, time), glm::dvec3(wind_.at(vec3(0.0f), time)) - calm_ + mean_};
}

const GustTable::Chunk& GustTable::chunk(std::size_t number) const {
  const Chunk* found = chunks_[number].load(std::memory_order_acquire);
  if (found) return *found;
  auto made = std::make_unique<Chunk>();
  const double first = (static_cast<double>(number) - kBefore) * kSteps;
  for (std::size_t i = 0; i < made->knots.size(); ++i)
    made->knots[i] = knot(start_ + (first + static_cast<double>(i)) * step_);
  made->corners = corners(made->knots, start_ + first * step_);
  // Another thread may have been faster; it has made the same.
  if (!chunks_[number].compare_exchange_strong(found, made.get(), std::memory_order_acq_rel)) return *found;
  return *made.release();
}

/// Chords as long as all knots allow.
std::vector<GustTable::Corner> GustTable::corners(std::span<const Knot> knots, double first) const {
  const auto near = [&](std::size_t from, std::size_t until) {
    const glm::dvec3 slope = (knots[until].displacement - knots[from].displacement) / static_cast<double>(until - from);
    for (std::size_t i = from + 1; i < until; ++i) {
      const glm::dvec3 off = knots[i].displacement - knots[from].displacement - static_cast<double>(i - from) * slope;
      if (glm::dot(off, off) > kChordsOff * kChordsOff) return false;
    }
    return true;
  };
  std::vector<Corner> result;
  for (std::size_t from = 0; from + 1 < knots.size();) {
    result.push_back({first + static_cast<double>(from) * step_, knots[from].displacement});
    std::size_t until = from + 1;
    while (until + 1 < knots.size() && near(from, until + 1)) ++until;
    from = until;
  }
  return result;
}

double GustTable::steps_at(double time) const { return (time - start_) / step_ + double{kBefore} * kSteps; }

void GustTable::add_corners(double from, double until, std::vector<Corner>& corners) const {
  const double low = steps_at(from) / kSteps, high = steps_at(until) / kSteps;
  if (!(low >= 0 && high < kChunks && (until - from) / apart_ < kMostCorners)) {
    const double apart = std::max(apart_, (until - from) / kMostCorners);
    const int pieces = static_cast<int>(std::ceil((until - from) / apart));
    for (int i = 1; i < pieces; ++i) {
      const double time = from + (until - from) * i / pieces;
      corners.push_back({time, displacement(time)});
    }
    return;
  }
  for (auto number = static_cast<std::size_t>(low); number <= static_cast<std::size_t>(high); ++number)
    for (const Corner& corner : chunk(number).corners)
      if (corner.time > from && corner.time < until) corners.push_back(corner);
}

GustTable::Span GustTable::span(double time) const {
  const double steps = steps_at(time);
  if (!(steps >= 0 && steps < double{kChunks} * kSteps)) return {nullptr, 0};
  const auto whole = static_cast<std::size_t>(steps);
  return {&chunk(whole / kSteps).knots[whole % kSteps], steps - static_cast<double>(whole)};
}

glm::dvec3 GustTable::displacement(double time) const {
  const auto [a, t] = span(time);
  if (!a) return wind_.carried(start_, time);
  const glm::dvec3 rise = a[1].displacement - a->displacement, first = step_ * a->velocity - rise,
                   last = rise - step_ * a[1].velocity;
  return a->displacement + t * (rise + (1 - t) * ((1 - t) * first + t * last));
}

glm::dvec3 GustTable::gust(double time) const {
  const auto [a, t] = span(time);
  if (!a) return knot(time).velocity - mean_;
  const glm::dvec3 rise = (a[1].displacement - a->displacement) / step_;
  return (1 - t) * (1 - 3 * t) * a->velocity + t * (3 * t - 2) * a[1].velocity + 6 * t * (1 - t) * rise - mean_;
}

}  // namespace meniscus
