/// Cells of blocks as bits, and what holds for all cells around one.
#pragma once

#include <array>

#include "meniscus/base.h"

namespace meniscus {

/// The 8 x 8 x 8 cells of a block: word z, bit 8 y + x.
using BandBits = std::array<std::uint64_t, 8>;

/// The blocks on either side of each block, by axis: x - 1, x + 1, y - 1 ...; -1 where there is none.
using BandSides = std::array<std::int32_t, 6>;

/// Keeps the bits of cells within `reach` of which, along every axis, all bits are set.
/// @param missing  whether the bits of blocks that do not exist count as set
void erode(std::vector<BandBits>& bits, const std::vector<BandSides>& sides, int reach, bool missing);

}  // namespace meniscus
