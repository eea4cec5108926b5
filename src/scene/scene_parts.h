/// Everything that a scene holds; shared by its copies, copied before it is changed.
#pragma once

#include <array>

#include "meniscus/scene.h"
#include "scene/placed_solids.h"
#include "scene/planes.h"
#include "scene/tank_body.h"

namespace meniscus {

struct Scene::Parts {
  Environment environment;
  Ground ground;
  Tank tank{};
  std::vector<PointLight> lamps{};
  std::shared_ptr<const WaterLight> water_light{};
  std::shared_ptr<const GroundCover> cover{};    ///< null: none
  std::vector<PlacedSolid> placed{};             ///< as given
  std::shared_ptr<const PlacedSolids> solids{};  ///< null: none
  std::shared_ptr<const TankBody> body{};        ///< of the tank; null: none
  vec3 u_axis{0}, v_axis{0};                     ///< along the ground's squares
  float grain = 0;                               ///< m; see clearance()
  /// Towards points of the sun's disc, and where these are in a disc of radius one around the sun's direction.
  std::array<vec3, 16> sun_points{}, sun_offsets{};

  SunPath sun_path{};
  /// By Face, but for solids: normals, cosines of the sun's light, irradiance of the sky.
  std::array<vec3, 8> plane_normals{}, plane_skies{};
  std::array<float, 8> plane_cosines{};

  /// Fills the places on the sun and what planes get of sun and sky.
  void aim_at_sun();
  /// See Scene::hit(), Scene::lit().
  SolidHit hit(const Ray& ray, Beam beam, float from, float limit) const;
  vec3 lit(const SolidHit& hit, const Ray& ray, Beam beam) const;
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
  /// One of 16 rays to the sun; `start` is a clearance() above the point. They start beside each other in the face.
  Ray sun_ray(vec3 start, vec3 face_normal, float footprint, std::size_t number) const;
  /// Irradiance from the point lights of which `fraction` passes the water.
  vec3 lamp_irradiance(vec3 point, vec3 normal, vec3 face_normal, vec3 fraction) const;
  /// Mirror image of the point lights in a coat, seen along a unit direction: its reflectance is in it.
  vec3 lamp_glare(vec3 point, const SolidHit& hit, vec3 direction, Beam beam) const;
  /// Irradiance from everything; `footprint` m is the width over which shadows' edges are averaged.
  vec3 irradiance(vec3 point, vec3 normal, vec3 face_normal, float footprint) const;

  /// Lays the cover on what was hit, where it is ground.
  void cover_hit(const Ray& ray, Beam beam, SolidHit& hit) const;

  // The same for the rays of a block.
  /// @param distances_only  as in Scene::distance(): without albedos
  void meet(const RayBlock& rays, const BlockBeams& beams, bool distances_only, BlockHits& hits) const;
  /// Covered ground is a solid from then on, whose normal and coat are its own.
  void cover_hits(const RayBlock& rays, const BlockBeams& beams, BlockHits& hits) const;
  SolidHit hit_of(const BlockHits& hits, int lane) const;
  vec3 normal_of(int face) const;
  /// Radiance along each ray: what is met in its light, or the environment.
  void shade(const RayBlock& rays, const BlockBeams& beams, const BlockHits& hits, BlockVectors& radiance) const;
  /// Takes away what solids keep of the sun's light. @param cosines  of that light, one a point; only > 0 are looked at
  void sun_past_solids(const float* cosines, int count, BlockPoints& points) const;
  /// Draws the rays of some pixels. @param hits  overwritten
  void see(const RayBlock& rays, const BlockBeams& beams, const std::size_t* pixels, BlockHits& hits,
           SceneBuffers& seen) const;
};

}  // namespace meniscus
