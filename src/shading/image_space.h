/// Where a ray meets the scene as far as a geometry map shows it.
#pragma once

#include "meniscus/base.h"

namespace meniscus {

/// The scene as seen through a view: the distance along each pixel's ray to what is seen there.
struct GeometryMap {
  View view;
  const Image<float>* depth;  ///< m along view.ray(pixel centre), of the view's size; +infinity: nothing is there
};

/// Distance along the view's ray through a picture point to the scene, m: between the pixel centres around it where
/// those belong to one surface, else that of the nearest. Points beside the picture take its border.
float depth_at(const GeometryMap& map, vec2 picture_point);

struct ImageSpaceHit {
  float distance = 0;       ///< m along the ray to `point`, >= 0; always finite
  vec3 point{0.0f};         ///< on the ray
  vec2 picture{0.0f};       ///< where the point lies in the map's picture, px; never NaN
  bool met = false;         ///< the scene is less than the threshold from the point
  bool in_picture = false;  ///< the picture point lies within the picture
  int iterations = 0;       ///< projections onto the ray that were made
};

/// The iteration of [Iwasaki2008] 5.1.2. With P1 what the map shows where the ray starts, P2 its projection onto the
/// ray, and P3 what the map shows where P2 is seen: the ray has met the scene when P2 and P3 are nearer to each other
/// than the threshold; else P3 takes the place of P1.
///
/// P3 lies on the view's ray v through P2, f = |P2 P3| from it with a sign, so that the projection moves the point by
/// f (v . d) along the ray d. On a plane seen at a grazing angle these steps grow without bound. The sign of f tells
/// points before the scene from points behind it: steps that leave what lies between such two are replaced by those of
/// the secant, or of bisection.
///
/// @param ray         from a point on the water; direction unit
/// @param start       picture point at which the ray's origin is seen, px
/// @param threshold   m; 0: the size of a pixel of the map at the point
/// @param iterations  projections at most, >= 0; 0 looks at the start only
ImageSpaceHit image_space_hit(const GeometryMap& map, const Ray& ray, vec2 start, float threshold, int iterations);

}  // namespace meniscus
