/// Height fields before they have heights.
#pragma once

#include "meniscus/surface.h"

namespace meniscus {

/// Points in one field at most.
inline constexpr std::size_t kMostColumns = std::size_t{1} << 24;

/// A field over a region, all holes: its border lies on the region's, steps are equal and no longer than asked for.
/// @param step  m, > 0
/// @throws Error invalid_argument: a region without extent along a or b or that is not finite; limit_exceeded
HeightField blank_field(Axis up, const Bounds& region, float step);

/// Both passes of a Gaussian over the heights, normalised over the water. A tap counts only together with the one
/// opposite, and none beyond a hole or the border: planes stay as they are, borders keep their level.
/// @param sigma  m, standard deviation; <= 0: nothing is done
void smooth_heights(HeightField& field, float sigma);

/// Heights for the columns marked `unknown`, from those around: a smooth sheet through the known ones. Where the known
/// ones around are mostly holes it is a hole.
void fill_unknown(Image<float>& height, const Image<std::uint8_t>& unknown);

}  // namespace meniscus
