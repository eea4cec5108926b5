/// Everything that a scene holds; shared by its copies, copied before it is changed.
#pragma once

#include <array>

#include "meniscus/scene.h"
#include "scene/placed_solids.h"
#include "scene/tank_body.h"

namespace meniscus {

struct Scene::Parts {
  Environment environment;
  Ground ground;
  Tank tank{};
  std::vector<PointLight> lamps{};
  std::shared_ptr<const WaterLight> water_light{};
  std::vector<PlacedSolid> placed{};             ///< as given
  std::shared_ptr<const PlacedSolids> solids{};  ///< null: none
  std::shared_ptr<const TankBody> body{};        ///< of the tank; null: none
  vec3 u_axis{0}, v_axis{0};                     ///< along the ground's squares
  float grain = 0;                               ///< m; see clearance()
  /// Towards points of the sun's disc, and where these are in a disc of radius one around the sun's direction.
  std::array<vec3, 16> sun_points{}, sun_offsets{};

  /// Fills the places on the sun.
  void aim_at_sun();
  /// Distance to the visible plane, not the haze in front of it.
  float ground_distance(const Ray& ray) const;
  /// The ground alone. @param distance  ground_distance(ray)
  SolidHit ground_hit(const Ray& ray, float distance, Beam beam, float from, float limit) const;
  /// How far from a point on a solid, m, rays start that must not meet that solid again: what rounding may have moved
  /// the point by, many times over.
  float clearance(vec3 point) const;
  /// Whether a mesh or the ground is met.
  bool blocks(const Ray& ray, float from, float limit) const;
  /// Fraction of the sun's disc that is seen from a point, at what is left of its light behind glass panes.
  vec3 sun_seen(vec3 point, vec3 face_normal, float footprint) const;
  /// Irradiance from everything; `footprint` m is the width over which shadows' edges are averaged.
  vec3 irradiance(vec3 point, vec3 normal, vec3 face_normal, float footprint) const;
};

}  // namespace meniscus
