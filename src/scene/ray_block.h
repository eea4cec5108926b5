/// Rays in batches: side by side, as vectorised loops take them.
#pragma once

#include <cstdint>

#include "meniscus/scene.h"

namespace meniscus {

/// Up to kRays rays. Those from `count` to the next multiple of 16 are copies of another, so that whole vectors can be
/// worked on.
struct RayBlock {
  static constexpr int kRays = 64;
  alignas(64) float origin[3][kRays];     ///< by axis
  alignas(64) float direction[3][kRays];  ///< by axis; unit vectors
  int count = 0;

  void set(int lane, const Ray& ray) {
    for (int axis = 0; axis < 3; ++axis) {
      origin[axis][lane] = ray.origin[axis];
      direction[axis][lane] = ray.direction[axis];
    }
  }
  Ray ray(int lane) const {
    return {{origin[0][lane], origin[1][lane], origin[2][lane]},
            {direction[0][lane], direction[1][lane], direction[2][lane]}};
  }
  vec3 direction_of(int lane) const { return {direction[0][lane], direction[1][lane], direction[2][lane]}; }
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
