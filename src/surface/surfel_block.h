/// Surfels of one block of the grid.
#pragma once

#include "surface/raycast_field.h"

namespace meniscus {

/// Points of a block's own along each axis: an edge belongs to the block of its lower end. Their density takes one
/// more point on either side, 32 x 16 x 16 in all, which stay in the nearest cache.
constexpr int kBlockX = 30, kBlockY = 14, kBlockZ = 14;

/// How an extraction samples the field.
struct SurfelGrid {
  vec3 low{0};              ///< m, of the first block's first own point
  float step = 0;           ///< m
  float gap_threshold = 0;  ///< m
};

/// Appends the surfels of block (x, y, z).
void add_block_surfels(const RaycastField& field, const SurfelGrid& grid, int x, int y, int z,
                       std::vector<Surfel>& surfels);

}  // namespace meniscus
