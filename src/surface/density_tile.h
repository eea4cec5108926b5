/// Metaballs of particles splatted into a box of grid points; compiled once for each instruction set.
#pragma once

#include <type_traits>

#include "surface/raycast_field.h"

namespace meniscus {

/// A box of points of a regular grid: point (i, j, k) is low + (i, j, k) * step, its density
/// values[i + j * row_pitch + k * plane_pitch].
struct DensityTile {
  float* values = nullptr;
  vec3 low{0};   ///< m
  vec3 step{0};  ///< m, > 0
  int nx = 0, ny = 0, nz = 0;
  std::size_t row_pitch = 0, plane_pitch = 0;  ///< values; up to 15 behind a row's nx are overwritten

  /// A row pitch for rows of nx values, with room for a vector more: an odd number of cache lines, because rows whose
  /// distance is a power of two share few sets of the cache and wait for each other's stores.
  static std::size_t pitch_of(int nx) { return ((static_cast<std::size_t>(nx) + 31) / 16 | 1) * 16; }
};

/// Sets the box to the density of the field's particles. Each point's sum runs in the sorted order of the particles,
/// whatever the box that it is computed in.
void splat_into_tile(const RaycastField& field, const DensityTile& tile);

}  // namespace meniscus
