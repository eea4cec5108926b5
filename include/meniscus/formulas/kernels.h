/// Smoothing kernels in three dimensions: W(r, h) in 1/m^3 with support h (W = 0 for r >= h), each integrating
/// to one over its support. r >= 0 and h > 0 are metres.
#ifndef MENISCUS_FORMULAS_KERNELS_H
#define MENISCUS_FORMULAS_KERNELS_H

#include "meniscus/formulas/glsl_subset.h"

FORMULAS_BEGIN

/// Cubic spline [Monaghan1992], written with truncated powers of q = r / h:
///   W = 8 / (pi h^3) (2 (1 - q)^3 - 8 (1/2 - q)^3),  each bracket cut off at zero.
FORMULA float cubic_spline(float r, float h) {
  float q = r / h;
  float outer = max(1.0f - q, 0.0f);
  float inner = max(0.5f - q, 0.0f);
  return 2.546479089470325f / (h * h * h) * (2.0f * outer * outer * outer - 8.0f * inner * inner * inner);
}

/// dW/dr of the cubic spline, 1/m^4; <= 0.
FORMULA float cubic_spline_slope(float r, float h) {
  float q = r / h;
  float outer = max(1.0f - q, 0.0f);
  float inner = max(0.5f - q, 0.0f);
  return 2.546479089470325f / (h * h * h * h) * (24.0f * inner * inner - 6.0f * outer * outer);
}

/// Poly6 [Muller2003] eq. 20: W = 315 / (64 pi h^9) (h^2 - r^2)^3.
FORMULA float poly6(float r, float h) {
  float q = r / h;
  float s = max(1.0f - q * q, 0.0f);
  return 1.566681471060845f / (h * h * h) * s * s * s;
}

/// dW/dr of poly6, 1/m^4; <= 0.
FORMULA float poly6_slope(float r, float h) {
  float q = r / h;
  float s = max(1.0f - q * q, 0.0f);
  return -9.400088826365070f / (h * h * h * h) * q * s * s;
}

/// Wyvill's metaball as [Iwasaki2008] eq. 1 gives it, F = c (-4/9 a^6 + 17/9 a^4 - 22/9 a^2 + 1) with a = r / h.
/// The paper's constant 405 / (748 pi h) makes the integral over a line's length unitless; c here is that of
/// the integral over the ball: 4 pi (-4/81 + 17/63 - 22/45 + 1/3) h^3 = 4 pi (184/2835) h^3.
FORMULA float wyvill(float r, float h) {
  float q = r / h;
  float a2 = min(q * q, 1.0f);
  float shape = 1.0f + a2 * (-22.0f / 9.0f + a2 * (17.0f / 9.0f - a2 * (4.0f / 9.0f)));
  return 1.226098542569357f / (h * h * h) * max(shape, 0.0f);
}

/// dW/dr of Wyvill's metaball, 1/m^4; <= 0.
FORMULA float wyvill_slope(float r, float h) {
  float q = min(r / h, 1.0f);
  float a2 = q * q;
  return 1.226098542569357f / (h * h * h * h) * q * (-44.0f / 9.0f + a2 * (68.0f / 9.0f - a2 * (24.0f / 9.0f)));
}

/// Spiky [Muller2003] eq. 21: W = 15 / (pi h^6) (h - r)^3.
FORMULA float spiky(float r, float h) {
  float s = max(1.0f - r / h, 0.0f);
  return 4.774648292756860f / (h * h * h) * s * s * s;
}

/// dW/dr of the spiky kernel, 1/m^4: -45 / (pi h^6) (h - r)^2; <= 0.
FORMULA float spiky_slope(float r, float h) {
  float s = max(1.0f - r / h, 0.0f);
  return -14.32394487827058f / (h * h * h * h) * s * s;
}

/// Weight of the principal component analysis, [Xiao2017] below eq. 4: 1 - (r / R)^3; unitless, not normalised.
FORMULA float pca_weight(float r, float R) {
  float q = min(r / R, 1.0f);
  return 1.0f - q * q * q;
}

FORMULAS_END

#endif
