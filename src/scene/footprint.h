/// Where a beam falls on a plane.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "meniscus/base.h"

namespace meniscus {

/// Extent along a direction in a plane of the ellipse that a beam's cross-section of `width` becomes there: longer by
/// 1 / cos_in along the ray. Of a direction at a cosine `a` with the ray the part a / sin_in lies along it, so the
/// extent is width sqrt(1 + (1 / cos_in^2 - 1) a^2 / sin_in^2).
/// @param cos_in  cosine between the ray and the plane's normal, > 0
/// @param along   cosine between the ray and the direction in the plane
inline float footprint(float width, float cos_in, float along) {
  const float slope = along / cos_in;
  return width * std::sqrt(1.0f + slope * slope);
}

}  // namespace meniscus
