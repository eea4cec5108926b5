/// Rain: drag of drops in air, their orbits and sizes, small waves on water.
#ifndef MENISCUS_FORMULAS_RAIN_H
#define MENISCUS_FORMULAS_RAIN_H

#include "meniscus/formulas/glsl_subset.h"

FORMULAS_BEGIN

/// Reynolds number [Mizukami2013] eq. 4: speed m/s, length m (a drop's diameter), density kg/m^3 and viscosity Pa s of
/// what it moves in.
FORMULA float reynolds_number(float speed, float length, float density, float viscosity) {
  return speed * length * density / viscosity;
}

/// Drag coefficient of a ball [Mizukami2013] eq. 3; Re > 0.
FORMULA float drag_coefficient(float reynolds) {
  float root = 0.55f + 4.8f / sqrt(reynolds);
  return root * root;
}

/// Drag of a drop in air over its mass and its speed, 1/s: F / (m V) with F = C_d rho V^2 S / 2 [Mizukami2013] eq. 2,
/// 3,
/// 4. S is the cross section, m the mass of a ball, so that S / (2 m) = 3 / (4 density diameter). Written so that it
/// stays finite down to speed 0, where C_d V goes to Stokes' form, 23.04 viscosity / (air diameter).
/// @param speed     >= 0, m/s, against the air
/// @param diameter  > 0, m
/// @param density   of the drop, kg/m^3
/// @param air       density of the air, kg/m^3
FORMULA float drag_rate(float speed, float diameter, float density, float air, float viscosity) {
  float root = 0.55f * sqrt(speed) + 4.8f * sqrt(viscosity / (air * diameter));
  return 0.75f * air / (density * diameter) * root * root;
}

/// (1 - exp(-x)) / x; 1 at 0. x >= 0.
FORMULA float decay_mean(float x) {
  if (x < 0.3f) return 1.0f + x * (-0.5f + x * (1.0f / 6.0f + x * (-1.0f / 24.0f + x * (1.0f / 120.0f - x / 720.0f))));
  return (1.0f - exp(-x)) / x;
}

/// (x - 1 + exp(-x)) / x^2; 1/2 at 0. x >= 0.
FORMULA float decay_rest(float x) {
  if (x < 0.3f)
    return 0.5f + x * (-1.0f / 6.0f + x * (1.0f / 24.0f + x * (-1.0f / 120.0f + x * (1.0f / 720.0f - x / 5040.0f))));
  return (x - 1.0f + exp(-x)) / (x * x);
}

/// Where a drop is after `time`, from its start, m: the orbit of [Mizukami2013] eq. 1 as vectors and relative to the
/// wind, without what cancels where the drag is small. For the wind 0 and gravity (0, -g) it is eq. 1.
/// @param velocity  m/s, at the start
/// @param drag      F / m of eq. 1, >= 0, 1/s: drag_rate() of the start
FORMULA vec3 orbit_offset(vec3 velocity, vec3 wind, vec3 gravity, float drag, float time) {
  float x = drag * time;
  return wind * time + (velocity - wind) * (time * decay_mean(x)) + gravity * (time * time * decay_rest(x));
}

/// Its velocity then, m/s: the derivative of orbit_offset().
FORMULA vec3 orbit_velocity(vec3 velocity, vec3 wind, vec3 gravity, float drag, float time) {
  float x = drag * time;
  float mean = decay_mean(x);
  return wind + (velocity - wind) * (1.0f - x * mean) + gravity * (time * mean);
}

/// Number of drops in air by their diameter, 1/m^3 per mm of diameter [MarshallPalmer1948]: N_0 exp(-Lambda D) with
/// N_0 = 8000 and Lambda = 4.1 R^-0.21 1/mm.
/// @param rate  R, mm/h
FORMULA float marshall_palmer(float diameter_mm, float rate) {
  return 8000.0f * exp(-4.1f * pow(rate, -0.21f) * diameter_mm);
}

/// Phase speed of waves on water, m/s: c^2 = (g / k + sigma k / rho) tanh(k depth); wave_number k > 0, 1/m.
FORMULA float wave_speed(float wave_number, float depth, float gravity, float tension_over_density) {
  float deep = gravity / wave_number + tension_over_density * wave_number;
  float x = min(2.0f * wave_number * depth, 80.0f);
  float t = x < 1e-3f ? 0.5f * x : 1.0f - 2.0f / (exp(x) + 1.0f);
  return sqrt(deep * t);
}

FORMULAS_END

#endif
