/// Where a beam falls on a plane.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "meniscus/base.h"

namespace meniscus {

/// Extent along a direction in a plane of the ellipse that a beam's cross-section of `width` becomes there: longer by
/// 1 / cos_in along the ray.
/// @param cos_in  cosine between the ray and the plane's normal, > 0
/// @param along   cosine between the ray and the direction in the plane
inline float footprint(float width, float cos_in, float along) {
  const float stretch = 1.0f / (cos_in * cos_in) - 1.0f;
  const float sin_squared = std::max(1e-12f, 1.0f - cos_in * cos_in);
  return width * std::sqrt(1.0f + stretch * along * along / sin_squared);
}

}  // namespace meniscus
