/// A light that casts caustics, and the views that belong to it.
#pragma once

#include <vector>

#include "meniscus/scene.h"
#include "meniscus/shading.h"

namespace meniscus {

/// The sun or a lamp.
struct LightSource {
  bool sun = true;
  vec3 direction{0, 1, 0};  ///< sun: unit, towards it
  vec3 position{0.0f};      ///< lamp: m
  vec3 strength{0.0f};      ///< sun: irradiance on a surface that faces it; lamp: that times m^2

  /// Unit vector from a point to the light.
  vec3 towards(vec3 point) const;
  /// Irradiance at a point on a surface that faces the light.
  vec3 irradiance(vec3 point) const;
};

/// The lights of a scene that reach the water in `box` from above, the brightest there first, at most `most`.
/// A sun nearer to the horizon than 3 degrees and lamps not above the box cast none.
std::vector<LightSource> caustics_lights(const Scene& scene, const Bounds& box, int most);

/// What of the light's way `view` sees: the rays of the sun are parallel, those of a lamp start at it. It holds the
/// box with `border` px around; the longer side has `size` px.
View view_from_light(const LightSource& light, const Bounds& box, vec3 up, int size, int border);

/// Orthographic view along `forward` (unit) that holds the box, grown across by `margin` times its longer side there,
/// and starts before the box. The longer side has `size` px.
View view_along(vec3 forward, const Bounds& box, vec3 up, int size, float margin);

}  // namespace meniscus
