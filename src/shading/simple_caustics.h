/// Brightness under the water made up from its heights and gradients.                              [Cords2008] eq. 4
#pragma once

#include "shading/caustics_plane.h"

namespace meniscus {

/// I = a (z - z_min) / (z_max - z_min) + b |n_x + n_y| + c at the points of the field, times what still water lets
/// through; with options.simple_keeps_mean scaled so that its mean over the water is 1 before that. The first term is
/// a / 2 where all heights are the same.
/// @param lit  of sunlit()
PlaneMap simple_caustics(const HeightField& field, const WaterLevel& level, const EnteringLight& light,
                         const Image<float>& lit, const CausticsOptions& options);

}  // namespace meniscus
