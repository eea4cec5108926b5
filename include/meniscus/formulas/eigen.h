/// Eigenvectors of symmetric 3 x 3 matrices by Jacobi's iteration.
#ifndef MENISCUS_FORMULAS_EIGEN_H
#define MENISCUS_FORMULAS_EIGEN_H

#include "meniscus/formulas/glsl_subset.h"

FORMULAS_BEGIN

/// A symmetric matrix by its six entries.
struct Symmetric3 {
  float xx;
  float yy;
  float zz;
  float xy;
  float xz;
  float yz;
};

struct LeastEigen {
  vec3 direction;  // unit eigenvector of the smallest eigenvalue
  float least;     // the smallest eigenvalue
  float middle;
  float largest;
};

struct JacobiRotation {
  float c;
  float s;
  float t;
};

/// The rotation that makes the off-diagonal entry a_pq vanish; the identity where it vanishes already.
FORMULA JacobiRotation jacobi_rotation(float a_pp, float a_qq, float a_pq) {
  JacobiRotation rotation;
  rotation.c = 1.0f;
  rotation.s = 0.0f;
  rotation.t = 0.0f;
  if (abs(a_pq) > 1e-30f) {
    float theta = 0.5f * (a_qq - a_pp) / a_pq;
    float size = 1.0f / (abs(theta) + sqrt(theta * theta + 1.0f));
    rotation.t = theta < 0.0f ? -size : size;
    rotation.c = 1.0f / sqrt(rotation.t * rotation.t + 1.0f);
    rotation.s = rotation.t * rotation.c;
  }
  return rotation;
}

/// Five cyclic sweeps, enough for float precision: the off-diagonal shrinks quadratically from the second on.
/// Entries must be small enough for their squares to be finite; scale the matrix by its trace if they are not.
FORMULA LeastEigen least_eigen(Symmetric3 a) {
  vec3 vx = vec3(1.0f, 0.0f, 0.0f);
  vec3 vy = vec3(0.0f, 1.0f, 0.0f);
  vec3 vz = vec3(0.0f, 0.0f, 1.0f);
  for (int sweep = 0; sweep < 5; ++sweep) {
    JacobiRotation r = jacobi_rotation(a.xx, a.yy, a.xy);
    a.xx = a.xx - r.t * a.xy;
    a.yy = a.yy + r.t * a.xy;
    a.xy = 0.0f;
    float keep = a.xz;
    a.xz = r.c * keep - r.s * a.yz;
    a.yz = r.s * keep + r.c * a.yz;
    vec3 v = vx;
    vx = r.c * v - r.s * vy;
    vy = r.s * v + r.c * vy;

    r = jacobi_rotation(a.xx, a.zz, a.xz);
    a.xx = a.xx - r.t * a.xz;
    a.zz = a.zz + r.t * a.xz;
    a.xz = 0.0f;
    keep = a.xy;
    a.xy = r.c * keep - r.s * a.yz;
    a.yz = r.s * keep + r.c * a.yz;
    v = vx;
    vx = r.c * v - r.s * vz;
    vz = r.s * v + r.c * vz;

    r = jacobi_rotation(a.yy, a.zz, a.yz);
    a.yy = a.yy - r.t * a.yz;
    a.zz = a.zz + r.t * a.yz;
    a.yz = 0.0f;
    keep = a.xy;
    a.xy = r.c * keep - r.s * a.xz;
    a.xz = r.s * keep + r.c * a.xz;
    v = vy;
    vy = r.c * v - r.s * vz;
    vz = r.s * v + r.c * vz;
  }
  LeastEigen result;
  result.direction = vz;
  result.least = a.zz;
  if (a.xx < result.least) {
    result.least = a.xx;
    result.direction = vx;
  }
  if (a.yy < result.least) {
    result.least = a.yy;
    result.direction = vy;
  }
  float sum = a.xx + a.yy + a.zz;
  result.largest = max(max(a.xx, a.yy), a.zz);
  result.middle = sum - result.least - result.largest;
  return result;
}

FORMULAS_END

#endif
