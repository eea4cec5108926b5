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
