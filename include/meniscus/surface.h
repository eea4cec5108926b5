/// Water surfaces: whatever represents the water, it answers what of it is seen through a view.
#pragma once

#include <memory>

#include "meniscus/base.h"

namespace meniscus {

/// What of the water is seen through a view. All images have the view's size, or N x 1 when a list of N
/// picture points was asked for.
struct SurfaceBuffers {
  Image<float> depth;      ///< distance along the ray to the surface, m; +infinity where there is no water
  Image<vec3> normal;      ///< unit, world space, out of the water; zero where there is no water
  Image<float> thickness;  ///< water along the ray, m; >= 0, may be > 0 beside the surface's silhouette
  Image<vec3> colour;      ///< linear; an empty image unless the particles carry colours
  Image<float> coverage;   ///< 1 where there is water, 0 elsewhere; fractions only after averaging
  bool eye_in_water = false;  ///< rays start inside: depth is where they leave the water
};

/// A water surface.
class Surface {
 public:
  virtual ~Surface() = default;

  /// What is seen through the view: at the pixel centres, or at `points` (picture coordinates, px), when the
  /// list is not empty. Sixteen consecutive points are cheapest when they lie close together.
  virtual SurfaceBuffers see(const View& view, std::span<const vec2> points = {}, StageTimes* times = nullptr) const = 0;

  /// Only the thickness of what see() returns: water along the ray, m.
  virtual Image<float> thickness(const View& view, std::span<const vec2> points = {}, StageTimes* times = nullptr) const = 0;

  /// A box that holds all of the surface; empty when there is no water.
  virtual Bounds bounds() const = 0;
};

}  // namespace meniscus
