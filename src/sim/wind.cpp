#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "base/field_axes.h"
#include "base/random.h"
#include "meniscus/sim.h"
#include "sim/wind_field.h"

namespace meniscus {
namespace {

constexpr std::size_t kSines = 8;
constexpr double kNextFrequency = 1.25;  ///< of a sine over the one before, but for a chance part: five in all
constexpr float kFastest = 200;          ///< m/s

/// One component of the gusts: sines of chance phases, mean 0, whose powers fall with the frequency as in turbulence,
/// f^-5/3 a unit of f [Kolmogorov1941], which is f^-2/3 a factor.
class Gusts {
 public:
  Gusts() = default;
  /// @param deviation  m/s
  /// @param period     s, of the slowest
  Gusts(double deviation, double period, Draws draws) {
    double frequency = draws.between(1, 1.2) / period, power = 0;  // else both components beat together
    for (Sine& sine : sines_) {
      sine = {std::pow(frequency * period, -1.0 / 3), 2 * std::numbers::pi * frequency,
              2 * std::numbers::pi * draws.uniform()};
      power += 0.5 * sine.amplitude * sine.amplitude;
      frequency *= kNextFrequency * draws.between(0.95, 1.05);
    }
    for (Sine& sine : sines_) sine.amplitude *= deviation / std::sqrt(power);
  }

  double at(double time) const {
    double sum = 0;
    for (const Sine& s : sines_) sum += s.amplitude * std::sin(s.rate * time + s.phase);
    return sum;
  }
  /// Of at(): its integral is the difference of this at both ends.
  double primitive(double time) const {
    double sum = 0;
    for (const Sine& s : sines_) sum -= s.amplitude / s.rate * std::cos(s.rate * time + s.phase);
    return sum;
  }
  /// Standard deviation of the acceleration, m/s^2.
  double change() const {
    double squares = 0;
    for (const Sine& s : sines_) squares += 0.5 * s.amplitude * s.amplitude * s.rate * s.rate;
    return std::sqrt(squares);
  }

 private:
  struct Sine {
    double amplitude = 0, rate = 1, phase = 0;
  };
  std::array<Sine, kSines> sines_;
};

[[noreturn]] void refuse(std::string problem, std::string expected) {
  throw Error(ErrorCode::invalid_argument, {std::move(problem), std::move(expected), {}, {}, {}, {}, {}});
}

}  // namespace

struct Wind::Parts {
  vec3 mean{0.0f};
  bool gusty = false;
  glm::dvec3 along{0.0}, across{0.0};  ///< unit
  Gusts gusts_along, gusts_across;
  std::unique_ptr<const WindField> field;
};

Wind::Wind(const WindOptions& options) {
  const vec3 v = options.velocity;
  if (!(std::abs(v.x) <= kFastest && std::abs(v.y) <= kFastest && std::abs(v.z) <= kFastest))
    refuse("the wind's velocity is out of range", "numbers of at most 200 m/s");
  if (!(options.gust >= 0 && options.gust <= kFastest)) refuse("the gusts are out of range", "0 .. 200 m/s");
  if (!(options.gust_period >= 0.01f && options.gust_period <= 1e6f))
    refuse("the period of the gusts is out of range", "0.01 .. 1e6 s");
  auto parts = std::make_shared<Parts>();
  parts->mean = v;
  if (options.field) {
    parts->field = std::make_unique<const WindField>(*options.field);
    parts->mean = parts->field->mean();
  }
  if (options.gust > 0) {
    // Along the mean wind as seen from above; where there is none, along the first axis.
    const FieldAxes axes(options.up);
    glm::dvec3 along{0.0};
    along[axes.a] = parts->mean[axes.a];
    along[axes.b] = parts->mean[axes.b];
    if (glm::length(along) < 1e-6) along = glm::dvec3(axes.place(1, 0, 0));
    parts->gusty = true;
    parts->along = glm::normalize(along);
    parts->across = glm::cross(glm::dvec3(direction_of(options.up)), parts->along);
    parts->gusts_along = Gusts(options.gust, options.gust_period, Draws(options.seed, 0));
    parts->gusts_across = Gusts(0.5 * options.gust, options.gust_period, Draws(options.seed, 1));
  }
  parts_ = std::move(parts);
}

vec3 Wind::at(vec3 point, double time) const {
  const vec3 steady = parts_->field ? parts_->field->at(point) : parts_->mean;
  if (!parts_->gusty) return steady;
  return vec3(glm::dvec3(steady) + parts_->gusts_along.at(time) * parts_->along +
              parts_->gusts_across.at(time) * parts_->across);
}

bool Wind::uniform() const { return !parts_->field; }
bool Wind::still() const { return uniform() && !parts_->gusty; }

glm::dvec3 Wind::carried(double from, double until) const {
  const glm::dvec3 steady = (until - from) * glm::dvec3(parts_->mean);
  if (!parts_->gusty) return steady;
  const Gusts &along = parts_->gusts_along, &across = parts_->gusts_across;
  return steady + (along.primitive(until) - along.primitive(from)) * parts_->along +
         (across.primitive(until) - across.primitive(from)) * parts_->across;
}

float Wind::gust_acceleration() const {
  if (!parts_->gusty) return 0;
  return static_cast<float>(std::hypot(parts_->gusts_along.change(), parts_->gusts_across.change()));
}

float Wind::finest() const { return parts_->field ? parts_->field->pitch() : std::numeric_limits<float>::infinity(); }

}  // namespace meniscus
