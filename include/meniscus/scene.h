/// What surrounds the water: the sky or an environment map, the sun, the ground.
#pragma once

#include <memory>

#include "meniscus/base.h"

namespace meniscus {

/// The light that comes from infinitely far: an analytic sky, or a map read from a .hdr file.
struct EnvironmentOptions {
  std::string hdr_path;           ///< Radiance .hdr, equirectangular; empty: the analytic sky
  vec3 up{0, 1, 0};               ///< unit
  vec3 sun_direction{0.4f, 0.8f, 0.45f};  ///< towards the sun, world space; need not be unit
  float sun_radiance_scale = 1.0f;
  bool sun_visible = true;
};

class Environment {
 public:
  /// @throws Error not_found, malformed_file for the .hdr
  explicit Environment(const EnvironmentOptions& options);
  /// Linear radiance that arrives from `direction` (unit, away from the eye), without the sun's disc.
  vec3 radiance(vec3 direction) const;
  /// The same blurred over a cone: `roughness` 0 is radiance(), 1 nearly diffuse.
  vec3 radiance(vec3 direction, float roughness) const;
  /// Irradiance on a surface with this unit normal from the sky without the sun.
  vec3 irradiance(vec3 normal) const;
  /// Unit vector towards the sun; irradiance of the sun on a surface that faces it.
  vec3 sun_direction() const;
  vec3 sun_irradiance() const;

 private:
  struct Parts;
  std::shared_ptr<const Parts> parts_;
};

/// A horizontal plane, plain or chequered.
struct Ground {
  bool visible = true;
  vec3 up{0, 1, 0};           ///< unit normal
  float height = 0;           ///< of the plane along up, m
  vec3 albedo{0.5f};          ///< linear
  vec3 second_albedo{0.35f};  ///< of the other squares
  float square = 0;           ///< edge of a square, m; 0: plain
  vec3 centre{0};             ///< where the fading into the horizon is centred, m
  float fade_radius = 0;      ///< m from the centre at which the plane has faded into the horizon; 0: never
};

/// How much sun and sky light reaches the ground under and beside the water; made by shading/.
class GroundLight {
 public:
  virtual ~GroundLight() = default;
  /// Transmitted fraction of the sun and of the sky's light at a point of the ground, per channel, in [0, 1].
  virtual vec3 sun(vec3 point) const = 0;
  virtual vec3 sky(vec3 point) const = 0;
};

/// What is seen behind and around the water.
class Scene {
 public:
  Scene(Environment environment, Ground ground);
  void set_ground_light(std::shared_ptr<const GroundLight> light);
  const Environment& environment() const;
  const Ground& ground() const;
  /// Radiance along a ray, from the ground or the sky. `footprint`: width of the ray's beam per metre of its
  /// length, so that chequers far away average out instead of shimmering.
  vec3 radiance(const Ray& ray, float footprint) const;
  /// Distance to the ground along the ray; infinity if the ray misses it.
  float ground_distance(const Ray& ray) const;

 private:
  Environment environment_;
  Ground ground_;
  std::shared_ptr<const GroundLight> light_;
};

}  // namespace meniscus
