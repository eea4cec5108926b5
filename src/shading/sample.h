/// The radiance of one point of the picture where there is water.
#pragma once

#include "meniscus/scene.h"
#include "meniscus/shading.h"

namespace meniscus {

/// One point of the picture with what is seen of the water there; all values valid.
struct Sample {
  Ray ray;
  float depth = 0;      ///< to the surface, m
  vec3 normal{0.0f};    ///< unit, towards the ray's origin
  float thickness = 0;  ///< m, >= 0
  Beam beam;            ///< of the ray at its origin
  float normal_variance = 0;
};

/// Water seen from the air: mirror image, sun, and what is seen through it.                 [Xiao2017] 3.4
vec3 transparent_radiance(const Sample& sample, const Scene& scene, const Material& material);
/// A diffuse body under a clear coat.
vec3 opaque_radiance(const Sample& sample, const Scene& scene, const Material& material);
/// The surface seen by an eye in the water: Snell's window, total reflection around it.
vec3 window_radiance(const Sample& sample, const Scene& scene, const Material& material);
/// Water without a surface in reach, seen by an eye in it: the ground or the deep.
vec3 deep_radiance(const Ray& ray, Beam beam, const Scene& scene, const Material& material);

/// The material where the particles have a colour of their own.
Material tinted(const Material& material, vec3 colour);

/// The unit normal, turned as little as needed to face the eye: by noise and interpolation normals near a silhouette
/// may look away. A degenerate one becomes the direction to the eye.
vec3 facing(vec3 normal, vec3 direction);

}  // namespace meniscus
