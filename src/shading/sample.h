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
  FresnelFormula fresnel = FresnelFormula::exact;
};

/// Water seen from the air: mirror image, sun, and what is seen through it: one interface, the far side guessed from
/// the thickness.                                                                            [Xiao2017] 3.4
vec3 transparent_radiance(const Sample& sample, const Scene& scene, const Material& material);
/// A diffuse body under a clear coat.
vec3 opaque_radiance(const Sample& sample, const Scene& scene, const Material& material);
/// The surface seen by an eye in the water: Snell's window, total reflection around it.
vec3 window_radiance(const Sample& sample, const Scene& scene, const Material& material);
/// Water without a surface in reach, seen by an eye in it: the ground or the deep.
vec3 deep_radiance(const Ray& ray, Beam beam, const Scene& scene, const Material& material);

/// The refracted ray of a sample, and the water that it runs through.
struct Refraction {
  vec3 point{0.0f};       ///< on the surface
  vec3 direction{0.0f};   ///< unit, in the water
  float reflectance = 0;  ///< with the material's specular factor
  float cos_i = 0, cos_t = 0;
  float slopes = 0;  ///< radians by which the directions within a pixel differ

  /// Water along the refracted ray if it meets a solid after `to_solid` m: between two parallel faces it takes a
  /// shorter way than the straight one along which the thickness was measured. A sample whose thickness is not known
  /// has water up to the solid.
  float water_path(const Sample& sample, float to_solid) const;
  Beam beam(const Sample& sample, float path) const;
};
Refraction refraction_of(const Sample& sample, const Material& material);

/// Light that a small volume or a diffuse surface of albedo one throws back, by sky and sun.
/// @param wrap  0: a surface; more: light comes round into the shadow, as in a scattering medium
vec3 diffuse_light(const Environment& environment, vec3 normal, float wrap);
/// Light of `behind` that is left after `path` m of the medium, with what the medium scatters into the way.
vec3 through_medium(vec3 behind, float path, const Material& material, vec3 light);
/// The sun in a mirror of the sun's own and this variance, rad^2; not brighter than pictures can bear.
vec3 glare(const Environment& environment, vec3 direction, float variance);

/// What the sample's mirror shows: direction and width of its rays.
struct Mirror {
  Ray ray;
  Beam beam;
  float roughness = 0;  ///< of the environment that it shows
  float variance = 0;   ///< rad^2, of the directions
};
Mirror mirror_of(const Sample& sample, const Material& material);
/// The sun in the mirror; nothing where the surface looks away from it.
vec3 mirrored_sun(const Sample& sample, const Mirror& mirror, const Scene& scene);

/// How far a sample belongs to the lower edge of a body that stands on a floor. The surface of a body of particles
/// is round there, and its underside bends rays up that in truth reach the floor: the water goes on to the floor along
/// the straight ray, and so does the look.
struct Contact {
  float weight = 0;    ///< 0 .. 1: undersides that lean by 10 to 25 degrees, 3 to 1 thicknesses from the floor
  float straight = 0;  ///< m to the floor along the straight ray
};
Contact contact_of(const Sample& sample, const Scene& scene);
/// The floor through the water at such a place.
vec3 floor_radiance(const Sample& sample, const Contact& contact, const Scene& scene, const Material& material);

/// The material where the particles have a colour of their own.
Material tinted(const Material& material, vec3 colour);

/// The unit normal, turned as little as needed to face the eye: by noise and interpolation normals near a silhouette
/// may look away. A degenerate one becomes the direction to the eye.
vec3 facing(vec3 normal, vec3 direction);

}  // namespace meniscus
