/// The cells of the ground as its options have them: their number, materials and heights.
#pragma once

#include <vector>

#include "meniscus/sim.h"

namespace meniscus {

/// Cells along a and b that cover low .. high.
struct GroundSize {
  int width = 0, height = 0;
};

/// @throws Error  invalid_argument: an option outside its range; limit_exceeded: more than 2^26 cells
GroundSize checked_ground_size(const GroundOptions& options);

/// Material of each cell, i + width * j.
std::vector<GroundMaterial> ground_materials(const GroundOptions& options, GroundSize size);

/// m along up of each cell: level, picture and noise.
std::vector<float> ground_heights(const GroundOptions& options, GroundSize size,
                                  const std::vector<GroundMaterial>& materials);

/// Bumps of mean 0 and standard deviation 1 over the cells: octaves of value noise, each of half the length and half
/// the height of the one before, from `length` m down to the cell.
std::vector<float> ground_bumps(GroundSize size, double cell, double length, std::uint64_t seed);

}  // namespace meniscus
