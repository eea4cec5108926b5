/// The particles of a grid as points, spheres and boxes of water.
#pragma once

#include "particles/band_grid.h"
#include "surface/splat_camera.h"

namespace meniscus {

/// Radius of the spheres that thickness is summed from, spacings (thickness_radius() of raycast_field.h).
constexpr float kThicknessRadius = 1.25f;

/// Of up to so many particles each is a sphere, and there are no points: spread as they are these reach a little
/// farther, which shows where opaque water casts a shadow.
constexpr std::size_t kAllSpheres = 50000;

/// Water along the rays of the camera's samples, m; points are not spread yet.
/// @param spacing  m
Image<float> summed_water(const BandGrid& grid, float spacing, const SplatCamera& camera);

}  // namespace meniscus
