/// What a liquid of smoothed particles adds to the kernels: the operators of viscosity and surface tension, and the
/// kernels' integrals over a half space of solid, the wall of a tank.
///
/// r >= 0 and h > 0 are metres. `distance` is that of the particle from the wall, m, negative inside the solid. The
/// solid is everything beyond the wall's plane; integrals are taken over the part of it within the support.
#ifndef MENISCUS_FORMULAS_FLUIDS_H
#define MENISCUS_FORMULAS_FLUIDS_H

#include "meniscus/formulas/glsl_subset.h"

FORMULAS_BEGIN

/// Laplacian of the viscosity kernel [Muller2003] eq. 22, 1/m^5: 45 / (pi h^6) (h - r); >= 0.
FORMULA float viscosity_laplacian(float r, float h) {
  return 14.32394487827058f / (h * h * h * h * h) * max(1.0f - r / h, 0.0f);
}

/// Laplacian of poly6, 1/m^5: -945 / (32 pi h^9) (h^2 - r^2) (3 h^2 - 7 r^2).
FORMULA float poly6_laplacian(float r, float h) {
  float q = r / h;
  float s = max(1.0f - q * q, 0.0f);
  return -9.400088826365070f / (h * h * h * h * h) * s * (3.0f - 7.0f * q * q);
}

/// Integral of poly6 over the plane at `distance` from its centre, 1/m: 315 / (256 h) (1 - q^2)^4.
/// The integral of the gradient over the solid is this along the wall's normal, reversed.
FORMULA float poly6_over_plane(float distance, float h) {
  float q = distance / h;
  float s = max(1.0f - q * q, 0.0f);
  return 1.23046875f / h * s * s * s * s;
}

/// Part of poly6 beyond the wall, 0 .. 1: 1/2 at the wall. The integral of poly6_over_plane from `distance` to h.
FORMULA float poly6_beyond(float distance, float h) {
  float q = clamp(distance / h, -1.0f, 1.0f);
  float t = q * q;
  float inner = 1.0f + t * (-4.0f / 3.0f + t * (6.0f / 5.0f + t * (-4.0f / 7.0f + t / 9.0f)));
  return 0.5f - 1.23046875f * q * inner;
}

/// Integral of poly6's laplacian over the solid, 1/m^2: minus the slope of poly6_over_plane.
FORMULA float poly6_laplacian_beyond(float distance, float h) {
  float q = distance / h;
  float s = max(1.0f - q * q, 0.0f);
  return 9.84375f / (h * h) * q * s * s * s;
}

/// Integral of the spiky kernel over the plane at `distance`, 1/m: 30 / h (v^4 / 4 - v^5 / 5) with v = 1 - |q|.
FORMULA float spiky_over_plane(float distance, float h) {
  float v = max(1.0f - abs(distance) / h, 0.0f);
  return v * v * v * v * (7.5f - 6.0f * v) / h;
}

/// Part of the spiky kernel beyond the wall, 0 .. 1: 3 / 2 v^5 - v^6 outside. The integral of spiky_over_plane.
FORMULA float spiky_beyond(float distance, float h) {
  float v = max(1.0f - abs(distance) / h, 0.0f);
  float outside = v * v * v * v * v * (1.5f - v);
  return distance < 0.0f ? 1.0f - outside : outside;
}

/// Integral of viscosity_laplacian over the solid, 1/m^2: 15 / h^2 (v^3 - v^4 / 2) with v = 1 - |q|, of 15 / h^2 over
/// the whole support.
FORMULA float viscosity_laplacian_beyond(float distance, float h) {
  float v = max(1.0f - abs(distance) / h, 0.0f);
  float outside = v * v * v * (1.0f - 0.5f * v);
  return 15.0f / (h * h) * (distance < 0.0f ? 1.0f - outside : outside);
}

/// Part of the support that lies beyond two walls at once.
///
/// Exact for a particle in the edge of two walls at any angle, and for walls that are parallel; between those as if
/// the parts a and b of perpendicular walls were independent of each other.
/// @param a, b      parts beyond either wall, 0 .. 1
/// @param cosine    of the angle between their normals
FORMULA float beyond_both(float a, float b, float cosine) {
  float towards = 0.6366197723675814f * asin(clamp(cosine, -1.0f, 1.0f));
  float limit = towards > 0.0f ? min(a, b) : max(a + b - 1.0f, 0.0f);
  return mix(a * b, limit, abs(towards));
}

/// d beyond_both / d a, 0 .. 1.
FORMULA float beyond_both_slope(float a, float b, float cosine) {
  float towards = 0.6366197723675814f * asin(clamp(cosine, -1.0f, 1.0f));
  float limit = towards > 0.0f ? (a < b ? 1.0f : (a > b ? 0.0f : 0.5f)) : (a + b > 1.0f ? 1.0f : 0.0f);
  return mix(b, limit, abs(towards));
}

FORMULAS_END

#endif
