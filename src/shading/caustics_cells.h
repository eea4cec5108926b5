/// Light of the cells of a grid on a plane, gathered in texels.
#pragma once

#include "meniscus/base.h"

namespace meniscus {

/// What goes through a point of the water's grid.
struct LightPoint {
  vec2 at{0.0f};    ///< on the plane, in texels: the centre of the first is (0, 0)
  float flux = -1;  ///< per horizontal area; negative: there is no water
};

/// Adds the light of all cells between four points: each cell is as many samples as keep half a texel from each other,
/// and a sample counts in the 3 x 3 texels around it by a quadratic B-spline. What is added, in all, is the flux of all
/// cells times `cell`, as far as it lies within the limits and the map.
/// @param cell       area of a cell over that of a texel
/// @param low, high  texels; samples beyond are left out
void gather_cells(const Image<LightPoint>& points, float cell, vec2 low, vec2 high, Image<float>& map);

}  // namespace meniscus
