/// The cells of one cube of a MarchCells tree, found on their own: 16 x 16 x 16 of them.
#pragma once

#include <array>
#include <cmath>

#include "surface/raycast_field.h"

namespace meniscus {

constexpr int kMarchCube = 16;  ///< cells along an edge

/// A bit for each cell: row z * 16 + y, bit x.
using MarchRows = std::array<std::uint16_t, kMarchCube * kMarchCube>;

/// Where a cube lies: its first cell's coordinates, of cells of `size` m from `low` on.
struct MarchCubePlace {
  vec3 low;
  float size;
  glm::ivec3 first;
};

/// Coordinate of the cell that a place lies in, along an axis: not exactly rounded, but never falling.
inline double march_cell(float at, float low, float size) {
  return std::floor((static_cast<double>(at) - static_cast<double>(low)) / static_cast<double>(size));
}

/// Cells of the cube that an entry sphere of any level's particles touches or whose particles are not all known.
MarchRows reached_cells(const RaycastField& field, const MarchCubePlace& place);

/// Reached cells all of whose corners are well inside of the water.
MarchRows inside_cells(const RaycastField& field, const MarchCubePlace& place, const MarchRows& reached);

/// Whether all cells lie where the density is one since no particle near them is kept.
bool all_full(const RaycastField& field, const MarchCubePlace& place);

}  // namespace meniscus
