#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

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

/// The path of one drop through a wind that has no gradient: its displacement between two times is known.
glm::dvec3 carried(const Wind& wind, double fall, const FieldAxes& axes, double from, double until) {
  glm::dvec3 way = wind.carried(from, until);
  const double rise = wind.at(vec3{0.0f}, from)[axes.up];
  way[axes.up] = (until - from) * std::min(rise - fall, -0.1 * fall);
  return way;
}

/// Steps through a field, from the drop's arrival on, backwards or forwards: midpoint rule, each of the same length.
class FieldSteps {
 public:
  FieldSteps(const Wind& wind, const RainDrop& drop, const FieldAxes& axes, double length, int direction)
      : wind_(wind),
        axes_(axes),
        fall_(fall_speed(drop.diameter)),
        length_(length),
        sign_(direction),
        place_(drop.place),
        time_(drop.time) {}

  glm::dvec3 place() const { return place_; }
  double time() const { return time_; }
  glm::dvec3 velocity() const { return drop_velocity(wind_.at(vec3(place_), time_), fall_, axes_); }

  void step() {
    const glm::dvec3 first = velocity();
    const double seconds = sign_ * length_ / glm::length(first);
    const glm::dvec3 middle = place_ + 0.5 * seconds * first;
    place_ += seconds * drop_velocity(wind_.at(vec3(middle), time_ + 0.5 * seconds), fall_, axes_);
    time_ += seconds;
  }

 private:
  const Wind& wind_;
  FieldAxes axes_;
  double fall_, length_, sign_;
  glm::dvec3 place_;
  double time_;
};

}  // namespace

vec3 Rain::position(const RainDrop& drop, double time) const {
  const FieldAxes& axes = parts_->axes;
  if (wind_.uniform())
    return vec3(glm::dvec3(drop.place) + carried(wind_, fall_speed(drop.diameter), axes, drop.time, time));
  const int direction = time < drop.time ? -1 : 1;
  FieldSteps steps(wind_, drop, axes, parts_->step_length, direction);
  for (int i = 0; i < kMostSteps; ++i) {
    const glm::dvec3 place = steps.place();
    const double before = steps.time();
    steps.step();
    if ((steps.time() - time) * direction >= 0)
      return vec3(place + (time - before) / (steps.time() - before) * (steps.place() - place));
  }
  return vec3(steps.place() + (time - steps.time()) * steps.velocity());
}

vec3 Rain::velocity(const RainDrop& drop, double time) const {
  const vec3 place = wind_.uniform() ? drop.place : position(drop, time);
  return vec3(drop_velocity(wind_.at(place, time), fall_speed(drop.diameter), parts_->axes));
}

Rain::Way Rain::way(const RainDrop& drop) const {
  const FieldAxes& axes = parts_->axes;
  const double top = double{options_.level} + double{options_.top};
  Way way;
  if (wind_.uniform()) {
    // The fall is even: the drop's time at the top is known.
    const double fall = fall_speed(drop.diameter);
    const double down = -carried(wind_, fall, axes, 0, 1)[axes.up];
    const double seconds = double{options_.top} / down;
    const int pieces = static_cast<int>(std::clamp(std::ceil(seconds / parts_->ways_apart), 1.0, double{kMostSteps}));
    way.points.reserve(static_cast<std::size_t>(pieces) + 1);
    way.times.reserve(static_cast<std::size_t>(pieces) + 1);
    for (int i = 0; i < pieces; ++i) {
      const double time = drop.time - seconds * (pieces - i) / pieces;
      way.times.push_back(time);
      way.points.push_back(position(drop, time));
    }
    way.times.push_back(drop.time);
    way.points.push_back(drop.place);
    return way;
  }
  FieldSteps steps(wind_, drop, axes, parts_->step_length, -1);
  way.points.push_back(drop.place);
  way.times.push_back(drop.time);
  for (int i = 0; i < kMostSteps; ++i) {
    const glm::dvec3 place = steps.place();
    const double before = steps.time();
    steps.step();
    const double part = std::min((top - place[axes.up]) / (steps.place()[axes.up] - place[axes.up]), 1.0);
    way.points.push_back(vec3(place + part * (steps.place() - place)));
    way.times.push_back(before + part * (steps.time() - before));
    if (part < 1 || steps.place()[axes.up] >= top) break;
  }
  std::reverse(way.points.begin(), way.points.end());
  std::reverse(way.times.begin(), way.times.end());
  return way;
}

}  // namespace meniscus
