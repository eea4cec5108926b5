/// Rays in batches: side by side, as vectorised loops take them.
#pragma once

#include <cstdint>

#include "meniscus/scene.h"

namespace meniscus {

/// Vectors (or colours) of a block: by axis (or channel), then by lane.
struct BlockVectors {
  static constexpr int kLanes = 64;
  alignas(64) float at[3][kLanes];

  float* operator[](int axis) { return at[axis]; }
  const float* operator[](int axis) const { return at[axis]; }
  vec3 get(int lane) const { return {at[0][lane], at[1][lane], at[2][lane]}; }
  void set(int lane, vec3 v) {
    for (int axis = 0; axis < 3; ++axis) at[axis][lane] = v[axis];
  }
};

/// Up to kRays rays. Those from `count` to the next multiple of 16 are copies of another, so that whole vectors can be
/// worked on.
struct RayBlock {
  static constexpr int kRays = BlockVectors::kLanes;
  BlockVectors origin;
  BlockVectors direction;  ///< unit
  int count = 0;

  void set(int lane, const Ray& ray) {
    origin.set(lane, ray.origin);
    direction.set(lane, ray.direction);
  }
  Ray ray(int lane) const { return {origin.get(lane), direction.get(lane)}; }
  vec3 direction_of(int lane) const { return direction.get(lane); }
  vec3 point(int lane, float distance) const {
    const Ray r = ray(lane);
    return r.origin + distance * r.direction;
  }
  /// Says how many rays there are, 1 .. kRays, and fills up with copies.
  void close(int rays) {
    count = rays;
    const Ray last = ray(rays - 1);
    for (int lane = rays; lane % 16 != 0; ++lane) set(lane, last);
  }
};

/// The beams of a block's rays, padded as those are.
struct BlockBeams {
  alignas(64) float width[RayBlock::kRays];      ///< see Beam
  alignas(64) float spread[RayBlock::kRays];     ///< see Beam
  alignas(64) float roughness[RayBlock::kRays];  ///< of the environment where a ray meets nothing

  /// All the same, the environment sharp.
  void fill(Beam beam) {
    for (int lane = 0; lane < RayBlock::kRays; ++lane) {
      width[lane] = beam.width;
      spread[lane] = beam.spread;
      roughness[lane] = 0.0f;
    }
  }
  Beam of(int lane) const { return {width[lane], spread[lane]}; }
};

/// What a ray meets: a plane with one of seven normals, or a solid.
enum Face : std::int32_t {
  kNothing = -1,
  kTankFace = 0,  ///< 0 .. 5: twice the axis of the normal, and one more where the normal points along it
  kGroundFace = 6,
  kSolidFace = 7,
};

/// What the rays of a block meet first.
struct BlockHits {
  alignas(64) float distance[RayBlock::kRays];  ///< m; infinity: nothing
  alignas(64) float albedo[3][RayBlock::kRays];
  alignas(64) float presence[RayBlock::kRays];
  alignas(64) std::int32_t face[RayBlock::kRays];         ///< a Face
  alignas(64) std::int32_t near_solids[RayBlock::kRays];  ///< not zero: the ray meets the solids' box before that
  SolidHit solids[RayBlock::kRays];                       ///< valid where `face` is kSolidFace
};

/// Points in the sun, or not.
struct BlockPoints {
  alignas(64) float at[3][RayBlock::kRays];               ///< m, by axis
  alignas(64) float face_normal[3][RayBlock::kRays];      ///< unit, by axis
  alignas(64) float width[RayBlock::kRays];               ///< m over which shadows' edges are averaged
  alignas(64) float light[3][RayBlock::kRays];            ///< result: what the tank leaves of the sun's light
  alignas(64) std::int32_t near_solids[RayBlock::kRays];  ///< result: not zero: solids may take some of it
};

}  // namespace meniscus
