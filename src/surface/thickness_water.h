/// The particles of a grid as points, spheres and boxes of water.
#pragma once

#include "surface/splat_camera.h"
#include "surface/thickness_cells.h"

namespace meniscus {

/// Radius of the spheres that thickness is summed from, spacings (thickness_radius() of raycast_field.h).
constexpr float kThicknessRadius = 1.25f;

/// Of water of up to so many particles each is a sphere, and there are no points: spread as they are these reach a
/// little farther, which shows where opaque water casts a shadow.
constexpr std::size_t kAllSpheres = 50000;

/// What of a grid is summed, where it holds a part of the water.
struct WaterShare {
  std::size_t all;  ///< particles of the whole water
  int axis = 0;     ///< cells from `first` to before `end` along this axis
  int first = 0, end = 1 << 30;
};

/// Water along the rays of the camera's samples, m; points are not spread yet.
/// @param spacing  m
Image<float> summed_water(const CountedCells& counted, float spacing, const SplatCamera& camera,
                          const WaterShare& share);

}  // namespace meniscus
