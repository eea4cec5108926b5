/// The light map of [Cords2008] 2.4: how much of the sun each place of a plane under the water sees through it.
#pragma once

#include "shading/caustics_plane.h"

namespace meniscus {

/// A place q of the plane sees the sun in every point x of the surface where the ray from q to x, refracted out of the
/// water (eq. 3), ends in the sun's disc, which is blurred to the width of a texel. A point x that is hit is one whose
/// own refracted sunlight meets the plane within that width of q; each texel therefore gathers all points of the
/// surface that light it, folds included, and what enters the water is what the plane gets.
/// @param lit    of sunlit()
/// @param plane  m along up, below the water
/// @param size   texels along the longer side of the field, > 1
PlaneMap backward_map(const HeightField& field, const WaterLevel& level, const EnteringLight& light,
                      const Image<float>& lit, float plane, int size);

}  // namespace meniscus
