/// Light at the interface of two clear dielectrics and inside an absorbing one.
///
/// eta is the index of refraction on the far side of the interface over that on the near side (from air into
/// water 1.333, out of it 1 / 1.333). Directions are unit vectors; normals are unit vectors on the near side.
#ifndef MENISCUS_FORMULAS_OPTICS_H
#define MENISCUS_FORMULAS_OPTICS_H

#include "meniscus/formulas/glsl_subset.h"

FORMULAS_BEGIN

/// Where light goes and how much of it is thrown back.
struct Interface {
  float reflectance_s;  // polarised perpendicular to the plane of incidence
  float reflectance_p;  // polarised parallel to it
  float reflectance;    // unpolarised: the mean of both; 1 at total reflection
  float cos_t;          // cosine of the refracted ray with the reversed normal; 0 at total reflection
};

/// Fresnel's equations for a dielectric. Born and Wolf, Principles of Optics, 1.5.2:
///   R_s = ((cos_i - eta cos_t) / (cos_i + eta cos_t))^2,   R_p = ((eta cos_i - cos_t) / (eta cos_i + cos_t))^2
/// @param cos_i  cosine of the angle of incidence; clamped to [0, 1]
/// @param eta    > 0
FORMULA Interface fresnel(float cos_i, float eta) {
  Interface result;
  float c = clamp(cos_i, 0.0f, 1.0f);
  float cos_t_squared = 1.0f - (1.0f - c * c) / (eta * eta);
  if (cos_t_squared <= 0.0f) {
    result.reflectance_s = 1.0f;
    result.reflectance_p = 1.0f;
    result.reflectance = 1.0f;
    result.cos_t = 0.0f;
  } else {
    float t = sqrt(cos_t_squared);
    float s_amplitude = (c - eta * t) / (c + eta * t);
    float p_amplitude = (eta * c - t) / (eta * c + t);
    result.reflectance_s = s_amplitude * s_amplitude;
    result.reflectance_p = p_amplitude * p_amplitude;
    result.reflectance = 0.5f * (result.reflectance_s + result.reflectance_p);
    result.cos_t = t;
  }
  return result;
}

/// Unpolarised reflectance alone, [0, 1].
FORMULA float fresnel_reflectance(float cos_i, float eta) { return fresnel(cos_i, eta).reflectance; }

/// Schlick's approximation of the unpolarised reflectance, [0, 1]:                                     [Schlick1994]
///   R = R_0 + (1 - R_0) (1 - c)^5,   R_0 = ((eta - 1) / (eta + 1))^2
/// with c the cosine on the side of the lower index, so that it meets total reflection where that begins.
/// @param cos_i  cosine of the angle of incidence; clamped to [0, 1]
/// @param eta    > 0
FORMULA float schlick_reflectance(float cos_i, float eta) {
  float c = clamp(cos_i, 0.0f, 1.0f);
  if (eta < 1.0f) {
    float cos_t_squared = 1.0f - (1.0f - c * c) / (eta * eta);
    c = cos_t_squared > 0.0f ? sqrt(cos_t_squared) : 0.0f;
  }
  float root = (eta - 1.0f) / (eta + 1.0f);
  float r_0 = root * root;
  float d = 1.0f - c;
  return r_0 + (1.0f - r_0) * d * d * d * d * d;
}

/// Fraction of light from all directions alike that an interface throws back, from the side of the lower index: the
/// mean of fresnel_reflectance() weighted by the cosine.                              [Duntley1942], [LeknerDorf1988]
/// @param eta  > 1
FORMULA float diffuse_reflectance(float eta) {
  float n = eta;
  float n2 = n * n;
  float n4 = n2 * n2;
  float plus = n2 + 1.0f;
  float minus = n2 - 1.0f;
  return 0.5f + (n - 1.0f) * (3.0f * n + 1.0f) / (6.0f * (n + 1.0f) * (n + 1.0f)) +
         n2 * minus * minus / (plus * plus * plus) * log((n - 1.0f) / (n + 1.0f)) -
         2.0f * n2 * n * (n2 + 2.0f * n - 1.0f) / (plus * (n4 - 1.0f)) +
         8.0f * n4 * (n4 + 1.0f) / (plus * (n4 - 1.0f) * (n4 - 1.0f)) * log(n);
}

/// Albedo of a rough body under water, of the light that comes out of the water again per light that came into it:
/// what the body scatters is thrown back to it by the inside of the water's surface, and is absorbed again.
///   A = (1 - p) a / (1 - p a),   p = 1 - (1 - R) / eta^2,   R = diffuse_reflectance(eta)          [LeknerDorf1988]
/// The mirror image in the water's surface is not in it. With a = 1 nothing is lost.
/// @param albedo  of the dry body, [0, 1]
/// @param eta     > 1, of the water
FORMULA float wet_albedo(float albedo, float eta) {
  float kept = 1.0f - (1.0f - diffuse_reflectance(eta)) / (eta * eta);
  return (1.0f - kept) * albedo / (1.0f - kept * albedo);
}

/// Mirror direction of `incident` (towards the interface).
FORMULA vec3 mirrored(vec3 incident, vec3 normal) { return incident - 2.0f * dot(incident, normal) * normal; }

/// Snell's law: direction behind the interface.
/// @param incident  towards the interface
/// @param cos_t     of fresnel(-dot(incident, normal), eta), > 0
FORMULA vec3 refracted(vec3 incident, vec3 normal, float eta, float cos_t) {
  float cos_i = -dot(incident, normal);
  return normalize(incident / eta + (cos_i / eta - cos_t) * normal);
}

/// Fraction that is left after `path` m through a medium of this extinction, 1/m, per channel.
FORMULA vec3 beer_lambert(vec3 extinction, float path) { return exp(-(path * extinction)); }

FORMULAS_END

#endif
