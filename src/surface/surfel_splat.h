/// Surfels drawn into a picture.
#pragma once

#include "meniscus/surface.h"

namespace meniscus {

/// What a picture (perspective or orthographic) sees of the surfels, at the pixel centres or at `points`: depth,
/// normal, coverage; entry and exit are the nearest and farthest surfel that faces the eye.  [Iwasaki2008] 5.1.1 eq.
/// 2, 5.2
/// @param epsilon      m; surfels this far behind the nearest one are blended with it
/// @param normals      what is blended instead of the surfels' own normals: one each, or empty
/// @param from_inside  rays start in the water and see the surface from behind
SurfaceBuffers splat_surfels(const View& view, std::span<const Surfel> surfels, std::span<const vec3> normals,
                             float epsilon, bool from_inside, std::span<const vec2> points);

}  // namespace meniscus
