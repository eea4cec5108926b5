/// A plane in place of the water, and what is seen through it.                             [Cords2008] 2.1
#pragma once

#include <optional>

#include "meniscus/base.h"

namespace meniscus {

struct ApproximatingPlane {
  vec3 point{0.0f};      ///< m
  vec3 normal{0, 1, 0};  ///< unit, on the eye's side

  /// m; > 0 on the eye's side.
  float height(vec3 at) const;
  vec3 projected(vec3 at) const;
};

/// Eq. 1: where the eye's rays, mirrored by the plane, seem to come from.
vec3 reflected_eye(const ApproximatingPlane& plane, vec3 eye);

/// Eq. 3: the refracted direction; nothing at total reflection.
/// @param incident  unit, towards the plane
/// @param normal    unit, against it
/// @param ratio     index of refraction on the near side over that on the far one
std::optional<vec3> snell(vec3 incident, vec3 normal, float ratio);

/// The point of the plane through which the eye sees `target`, which lies behind the plane: Snell's law solved by
/// bisection in double precision.
vec3 refraction_point(const ApproximatingPlane& plane, vec3 eye, vec3 target, float ratio);

/// Eq. 2: where a ray that is refracted at `a` seems to come from, if its length up to there is kept; nothing at total
/// reflection.
std::optional<vec3> refracted_eye(const ApproximatingPlane& plane, vec3 eye, vec3 a, float ratio);

/// The point of the plane at which a ray from the eye is refracted into `direction`; nothing if there is none.
std::optional<vec3> entry_of(const ApproximatingPlane& plane, vec3 eye, vec3 direction, float ratio);

}  // namespace meniscus
