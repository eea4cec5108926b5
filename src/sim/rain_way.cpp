#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>
#include <limits>
#include <numbers>

#include "sim/rain_parts.h"

namespace meniscus {

// A drop takes up the wind over v / g, a few tenths of a second and some metres: that is neglected, it goes with the
// air around it and falls through it at its terminal velocity.
glm::dvec3 drop_velocity(vec3 wind, double fall, const FieldAxes& axes) {
  glm::dvec3 velocity(wind);
  velocity[axes.up] = std::min(velocity[axes.up] - fall, -0.1 * fall);
  return velocity;
}

namespace {

constexpr int kMostSteps = 4096;
constexpr double kPartOfChord = 0.5;  ///< of a chord in gusts, that a step through a field may last
constexpr double kLeastStep = 1e-3;   ///< of the height of the top
constexpr double kChordsOff = 0.035;  ///< m that a chord of a way may stand off its samples

/// What a way is made of: the drop's places at times in rising or in falling order.
struct Samples {
  explicit Samples(std::size_t expected) {
    places.reserve(expected);
    times.reserve(expected);
  }
  std::vector<glm::dvec3> places;
  std::vector<double> times;

  void add(glm::dvec3 place, double time) {
    places.push_back(place);
    times.push_back(time);
  }
};

/// Leaves out samples as long as chords stay near the others at all their times: along each axis the slopes that pass
/// close to all samples since the last one that was kept narrow down, until none is left.
Rain::Way chords_of(const Samples& samples) {
  const double off = kChordsOff / std::numbers::sqrt3;
  Rain::Way way;
  const auto keep = [&](std::size_t i) {
    way.points.push_back(vec3(samples.places[i]));
    way.times.push_back(samples.times[i]);
  };
  keep(0);
  std::size_t from = 0;
  while (from + 1 < samples.places.size()) {
    glm::dvec3 low(-std::numeric_limits<double>::infinity()), high = -low;
    std::size_t until = from + 1;
    for (std::size_t i = from + 1; i < samples.places.size(); ++i) {
      const double per_second = 1 / (samples.times[i] - samples.times[from]), wide = off * std::abs(per_second);
      const glm::dvec3 slope = (samples.places[i] - samples.places[from]) * per_second;
      if (glm::all(glm::lessThanEqual(low, slope)) && glm::all(glm::lessThanEqual(slope, high))) until = i;
      low = glm::max(low, slope - wide);
      high = glm::min(high, slope + wide);
      if (!glm::all(glm::lessThanEqual(low, high))) break;
    }
    keep(until);
    from = until;
  }
  return way;
}

/// Steps through a field, from the drop's arrival on, backwards or forwards: midpoint rule, each of the same length.
class FieldSteps {
 public:
  /// @param wind   without gusts
  /// @param gusts  may be null
  FieldSteps(const Wind& wind, const GustTable* gusts, const RainDrop& drop, const FieldAxes& axes, double length,
             double least, int direction)
      : wind_(wind),
        gusts_(gusts),
        axes_(axes),
        fall_(fall_speed(drop.diameter)),
        length_(length),
        least_(least),
        longest_(gusts ? kPartOfChord * gusts->chord() : std::numeric_limits<double>::infinity()),
        sign_(direction),
        place_(drop.place),
        time_(drop.time) {}

  glm::dvec3 place() const { return place_; }
  double time() const { return time_; }
  glm::dvec3 velocity() const { return velocity(place_, time_); }

  void step() {
    const glm::dvec3 first = velocity();
    const double speed = glm::length(first);
    const double seconds = sign_ * std::min(length_ / speed, std::max(longest_, least_ / speed));
    before_ = place_;
    straight_ = seconds * first;
    place_ += seconds * velocity(before_ + 0.5 * straight_, time_ + 0.5 * seconds);
    time_ += seconds;
  }
  /// Where the drop is after a part of the last step: on the parabola with the velocity at its beginning.
  glm::dvec3 within(double part) const { return before_ + part * (straight_ + part * bend()); }
  /// Part of the last step after which the drop is `rise` higher than before it, if it is by then.
  double part_at(double rise) const {
    const double first = straight_[axes_.up], more = bend()[axes_.up];
    const double root = std::sqrt(std::max(first * first + 4 * more * rise, 0.0));
    return 2 * rise / (first + root);
  }

 private:
  glm::dvec3 velocity(glm::dvec3 place, double time) const {
    const vec3 steady = wind_.at(vec3(place), time);
    return drop_velocity(gusts_ ? vec3(glm::dvec3(steady) + gusts_->gust(time)) : steady, fall_, axes_);
  }

  glm::dvec3 bend() const { return place_ - before_ - straight_; }

  const Wind& wind_;
  const GustTable* gusts_;
  FieldAxes axes_;
  double fall_, length_, least_;  ///< m/s, m, and m that steps are not cut below
  double longest_;                ///< s, in gusts
  double sign_;
  glm::dvec3 place_;
  double time_;
  glm::dvec3 before_{0.0}, straight_{0.0};  ///< m, of the last step: where it began, and how far it would have led
};

}  // namespace

vec3 Rain::position(const RainDrop& drop, double time) const {
  const Parts& parts = *parts_;
  if (wind_.uniform()) {
    const double seconds = time - drop.time;
    glm::dvec3 carried = parts.gusts ? parts.gusts->displacement(time) - parts.gusts->displacement(drop.time)
                                     : wind_.carried(drop.time, time);
    carried[parts.axes.up] = -seconds * parts.down(drop);
    return vec3(glm::dvec3(drop.place) + carried);
  }
  const int direction = time < drop.time ? -1 : 1;
  FieldSteps steps(parts.steady(wind_), parts.gusts.get(), drop, parts.axes, parts.step_length,
                   kLeastStep * double{options_.top}, direction);
  for (int i = 0; i < kMostSteps; ++i) {
    const double before = steps.time();
    steps.step();
    if ((steps.time() - time) * direction >= 0) return vec3(steps.within((time - before) / (steps.time() - before)));
  }
  return vec3(steps.place() + (time - steps.time()) * steps.velocity());
}

vec3 Rain::velocity(const RainDrop& drop, double time) const {
  const vec3 place = wind_.uniform() ? drop.place : position(drop, time);
  return vec3(drop_velocity(wind_.at(place, time), fall_speed(drop.diameter), parts_->axes));
}

Rain::Way Rain::way(const RainDrop& drop) const {
  const Parts& parts = *parts_;
  const int up = parts.axes.up;
  if (wind_.uniform()) {
    // The fall is even: the drop's time at the top is known.
    const double down = parts.down(drop), seconds = double{options_.top} / down;
    if (!parts.gusts) return {{position(drop, drop.time - seconds), drop.place}, {drop.time - seconds, drop.time}};
    const GustTable& gusts = *parts.gusts;
    const double start = drop.time - seconds;
    const glm::dvec3 origin = glm::dvec3(drop.place) - gusts.displacement(drop.time);
    thread_local std::vector<GustTable::Corner> corners;  // not allocated for each drop
    corners.assign(1, {start, gusts.displacement(start)});
    gusts.add_corners(start, drop.time, corners);
    Way way{std::vector<vec3>(corners.size() + 1, drop.place), std::vector<double>(corners.size() + 1, drop.time)};
    for (std::size_t i = 0; i < corners.size(); ++i) {
      glm::dvec3 place = origin + corners[i].displacement;
      place[up] = double{drop.place[up]} + (drop.time - corners[i].time) * down;
      way.points[i] = vec3(place);
      way.times[i] = corners[i].time;
    }
    return way;
  }
  const double top = double{options_.level} + double{options_.top};
  FieldSteps steps(parts.steady(wind_), parts.gusts.get(), drop, parts.axes, parts.step_length,
                   kLeastStep * double{options_.top}, -1);
  Samples samples(static_cast<std::size_t>(2 * options_.top / parts.step_length) + 3);
  samples.add(drop.place, drop.time);
  for (int i = 0; i < kMostSteps; ++i) {
    const double left = top - steps.place()[up], before = steps.time();
    steps.step();
    const bool there = steps.place()[up] >= top;
    const double part = there ? std::clamp(steps.part_at(left), 0.0, 1.0) : 1.0;
    for (const double at : {0.5 * part, part}) samples.add(steps.within(at), before + at * (steps.time() - before));
    if (there) break;
  }
  Way way = chords_of(samples);
  std::reverse(way.points.begin(), way.points.end());
  std::reverse(way.times.begin(), way.times.end());
  return way;
}

}  // namespace meniscus
