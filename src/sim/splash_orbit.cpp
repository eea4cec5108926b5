#include "sim/splash_orbit.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "meniscus/formulas/rain.h"

namespace meniscus {
namespace {

/// Part of the time by which Newton's last step may have moved it: each step squares the error, here to below 1e-6.
constexpr float kNear = 3e-4f;

}  // namespace

float air_drag(float speed, float diameter) {
  return formulas::drag_rate(speed, diameter, kWaterDensity, kAirDensity, kAirViscosity);
}

float terminal_speed(float diameter, float gravity) {
  // drag(V) V = g, and drag grows with V by less than V itself: the mean of the exponents makes the fixed point tight.
  float speed = std::sqrt(gravity * diameter * kWaterDensity / kAirDensity);
  for (int i = 0; i < 64; ++i) {
    const float next = std::sqrt(speed * gravity / air_drag(speed, diameter));
    if (std::abs(next - speed) <= 1e-7f * speed) return next;
    speed = next;
  }
  return speed;
}

float landing_time(const Orbit& orbit, vec3 normal, float latest) {
  const float v = glm::dot(orbit.velocity, normal), w = glm::dot(orbit.wind, normal),
              g = glm::dot(orbit.gravity, normal), k = orbit.drag;
  // The mean velocity away from the plane up to t; it starts at v > 0 and is 0 on landing. Without drag it is a
  // straight line in t.
  const auto mean = [&](float t) {
    const float part = formulas::decay_mean(k * t);
    return w + (v - w) * part + g * t * formulas::decay_rest(k * t);
  };
  if (!(v > 0)) return 0;
  if (!(mean(latest) < 0)) return latest;
  float low = 0, high = latest;
  float t = g < 0 ? std::min(-2 * v / g, 0.5f * latest) : 0.5f * latest;
  for (int i = 0; i < 64; ++i) {
    const float x = k * t, part = formulas::decay_mean(x);
    const float value = w + (v - w) * part + g * t * formulas::decay_rest(x);
    (value > 0 ? low : high) = t;
    const float last = w + (v - w) * (1 - x * part) + g * t * part;  // velocity at t
    const float slope = (last - value) / t;
    float next = t - value / slope;
    if (std::abs(next - t) <= kNear * t) return std::min(next, latest);
    if (!(next > low && next < high)) next = 0.5f * (low + high);
    t = next;
  }
  return t;
}

float leaving_time(const Orbit& orbit, float distance, float latest) {
  const auto offset = [&](float t) {
    return formulas::orbit_offset(orbit.velocity, orbit.wind, orbit.gravity, orbit.drag, t);
  };
  if (glm::length(offset(latest)) <= distance) return latest;
  float low = 0, high = latest;
  float t = std::min(distance / std::max(glm::length(orbit.velocity), 1e-6f), 0.5f * latest);
  for (int i = 0; i < 64; ++i) {
    const vec3 at = offset(t);
    const float gone = glm::length(at);
    (gone < distance ? low : high) = t;
    const vec3 velocity = formulas::orbit_velocity(orbit.velocity, orbit.wind, orbit.gravity, orbit.drag, t);
    const float slope = glm::dot(velocity, at) / gone;
    float next = t - (gone - distance) / slope;
    if (std::abs(next - t) <= kNear * t) return std::min(next, latest);
    if (!(next > low && next < high)) next = 0.5f * (low + high);
    t = next;
  }
  return t;
}

OrbitState stepped_orbit(const Orbit& orbit, float diameter, double time, double dt, SteppedDrag drag) {
  const glm::dvec3 wind(orbit.wind), gravity(orbit.gravity);
  glm::dvec3 offset(0.0), velocity(orbit.velocity);
  for (double t = 0; t < time; t += dt) {
    const double step = std::min(dt, time - t);
    const glm::dvec3 against = velocity - wind;
    const double k = drag == SteppedDrag::held
                         ? static_cast<double>(orbit.drag)
                         : static_cast<double>(air_drag(static_cast<float>(glm::length(against)), diameter));
    const glm::dvec3 acceleration = gravity - k * against;         // eq. 5, with gravity
    offset += velocity * step + acceleration * (step * step / 2);  // eq. 7
    velocity += acceleration * step;                               // eq. 6
  }
  return {vec3(offset), vec3(velocity)};
}

}  // namespace meniscus
