/// What surrounds the water: the sky or an environment map, the sun, the ground.
#pragma once

#include <memory>

#include "meniscus/base.h"

namespace meniscus {

/// The light that comes from infinitely far: an analytic sky, or a map read from a .hdr file.
///
/// The analytic sky is scaled so that a white diffuse plane that faces `up` has the radiance 1 in the sky's and
/// the sun's light together. The radiances of a map are taken as they are.
struct EnvironmentOptions {
  std::string hdr_path;  ///< Radiance .hdr, equirectangular; empty: the analytic sky
  vec3 up{0, 1, 0};      ///< the sky's zenith and the upper edge of a map; need not be unit
  /// Towards the sun, world space; need not be unit. A map that holds a sun overrides it.
  vec3 sun_direction{0.4f, 0.8f, 0.45f};
  float sun_radiance_scale = 1.0f;  ///< >= 0
  bool sun_visible = true;          ///< the disc itself in the background; its light comes in any case
};

/// Light from all directions. A cheap handle: copies share the tables.
class Environment {
 public:
  /// @throws Error not_found, malformed_file, unsupported, limit_exceeded for the .hdr;
  ///               invalid_argument: a direction without length, a negative scale
  explicit Environment(const EnvironmentOptions& options);
  /// Linear radiance that arrives from `direction` (unit, away from the eye), without the sun's disc.
  vec3 radiance(vec3 direction) const;
  /// The same blurred over a cone: `roughness` 0 is radiance(), 1 nearly diffuse. The cone is a Gaussian of
  /// standard deviation 0.8 roughness^2 radians.
  vec3 radiance(vec3 direction, float roughness) const;
  /// Irradiance on a surface with this unit normal from the sky without the sun.
  vec3 irradiance(vec3 normal) const;
  /// Unit vector towards the sun; irradiance of the sun on a surface that faces it. A map without a sun has a sun
  /// without light.
  vec3 sun_direction() const;
  vec3 sun_irradiance() const;
  /// Radiance of the sun's disc blurred into a Gaussian of `variance` rad^2 (the disc's own, 5e-6, is added): what a
  /// reflection shows whose normals vary. It integrates to sun_irradiance() over the sphere.
  vec3 sun_glare(vec3 direction, float variance) const;
  bool sun_visible() const;

 private:
  struct Parts;
  std::shared_ptr<const Parts> parts_;
};

/// A horizontal plane, plain or chequered; seen from above only.
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
  /// Fraction of the sun's light that arrives at a point of the ground, per channel: in [0, 1] in shadow, above 1
  /// where water gathers light.
  virtual vec3 sun(vec3 point) const = 0;
  /// Fraction of the sky's light, per channel, in [0, 1].
  virtual vec3 sky(vec3 point) const = 0;
  /// Both at once, which a table gives for the price of one.
  struct Fractions {
    vec3 sun;
    vec3 sky;
  };
  virtual Fractions at(vec3 point) const { return {sun(point), sky(point)}; }
};

/// A ray with a width: `width` m at its origin, growing by `spread` m per metre of its length.
struct Beam {
  float width = 0;
  float spread = 0;
};

/// What is seen behind and around the water.
class Scene {
 public:
  Scene(Environment environment, Ground ground);
  void set_ground_light(std::shared_ptr<const GroundLight> light);
  const Environment& environment() const;
  const Ground& ground() const;
  /// Radiance along a ray, from the ground or the sky, without the sun's disc. `footprint`: width of the ray's beam
  /// per metre of its length, so that chequers far away average out instead of shimmering.
  vec3 radiance(const Ray& ray, float footprint) const;
  /// The same for any beam, the sky blurred by `roughness` as in Environment::radiance.
  vec3 radiance(const Ray& ray, Beam beam, float roughness = 0) const;
  /// Distance to the ground along the ray; infinity if the ray misses it. Zero for a ray that starts below the
  /// ground and goes down.
  float ground_distance(const Ray& ray) const;
  /// Radiance of the ground itself at a point on it, without fading; `width_u`, `width_v`: edges of the averaged
  /// rectangle along the plane's axes, m.
  vec3 ground_radiance(vec3 point, float width_u, float width_v) const;

 private:
  Environment environment_;
  Ground ground_;
  std::shared_ptr<const GroundLight> light_;
  vec3 u_axis_, v_axis_;              ///< along the squares' edges
  vec3 sun_exitance_, sky_exitance_;  ///< radiance of a white ground in the sun alone and in the sky alone
};

}  // namespace meniscus
