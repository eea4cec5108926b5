/// Tank and ground, which are planes, met by many rays at once.
#pragma once

#include "scene/ray_block.h"
#include "scene/tank_body.h"

namespace meniscus {

/// Sine of the angle under the horizon in which even an endless ground melts into the haze.
inline constexpr float kHorizonHaze = 0.012f;
/// A tank's floor that lies on the ground is seen, not the ground: it wins within this fraction of the distance.
inline constexpr float kTie = 1e-4f;

/// The planes of a scene; refers to what it is made of.
struct Planes {
  const TankBody* tank = nullptr;  ///< null: none
  const Ground& ground;
  vec3 u_axis, v_axis;  ///< along the ground's squares
};

/// Solids as far as a vectorised test asks for them.
struct SolidsBox {
  static constexpr std::size_t kMostParts = 16;
  Bounds box;  ///< empty: none
  vec3 centre{0.0f};
  float half_diagonal = 0;    ///< m
  std::vector<Bounds> parts;  ///< of each solid, if there are not too many; else empty
};

/// What of planes each ray meets first: distance, face, albedo, presence; and whether it meets a solid's box before.
/// The same as TankBody::hit() and Scene::Parts::ground_hit() to rounding.
/// @param tie      fraction of the distance within which the tank comes before the ground
/// @param colours  false: albedos are not asked for, and without a meaning
void plane_hits(const Planes& planes, const SolidsBox& solids, const RayBlock& rays, const BlockBeams& beams, float tie,
                bool colours, BlockHits& hits);

/// What is seen where there is nothing but an evenly lit ground and what is behind it.
/// @param light     what leaves a white ground
/// @param radiance  what is behind; becomes what is seen
void light_ground(const BlockHits& hits, vec3 light, int count, BlockVectors& radiance);

/// The sun as light on planes.
struct SunPath {
  vec3 direction{0, 1, 0};
  vec3 through_pane[3]{vec3{1}, vec3{1}, vec3{1}};  ///< transmittance of a pane of the tank, by its axis
  float cone = 0;                                   ///< see PlacedSolids::near()
  float grain = 0;                                  ///< m; see Scene::Parts::clearance()
};

/// What the tank leaves of the sun's light at points, and whether solids may be in its way.
/// The same as TankBody::light_transmittance() and PlacedSolids::near() to rounding.
void sun_past_planes(const Planes& planes, const SolidsBox& solids, const SunPath& sun, int count, BlockPoints& points);

}  // namespace meniscus
