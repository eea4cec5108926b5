/// The passes over all particles that a BandGrid is made by; vectorised.
#pragma once

#include "meniscus/base.h"

namespace meniscus {

/// Particles that are counted together: 256 that follow each other in the given order.
constexpr std::size_t kBandPiece = 256;
/// Particles that share a box: few, so that the boxes of a cloud in rows seldom reach from one row's end to the next.
constexpr std::size_t kBandBox = 64;

/// Boxes of pieces of 64 particles, m. The last one may hold fewer than 64.
/// @param boxes  (count + 63) / 64 of them
void find_piece_boxes(const float* x, const float* y, const float* z, std::size_t count, Bounds* boxes);

/// Cells from the low corner of the grid.
struct BandCells {
  vec3 low{0.0f};      ///< m
  float per_cell = 0;  ///< 1/m
  int blocks_x = 0, blocks_y = 0;
};

/// A cell's 4 x 4 x 4 sub-cubes make up eight patches: sub-cube (i, j, k) belongs to patch (i + 2 j + 3 k) mod 8.
/// Particles in one point lie in one patch; those of a lattice whose planes are half a cell apart in at least three,
/// even of 2 x 2 of them, and to whichever sides planes between sub-cubes are rounded.
inline std::uint32_t band_patch(std::uint32_t i, std::uint32_t j, std::uint32_t k) { return (i + 2 * j + 3 * k) & 7u; }
/// A counter of particles has a bit for each patch that they lie in, from this one on, and their number below.
constexpr std::uint32_t kBandCountBits = 24, kBandCount = (1u << kBandCountBits) - 1;

/// Keys of at most 256 particles: 512 block + cell of the block, with the block's place in a dense table of fewer than
/// 2^22 blocks, x fastest.
void find_dense_keys(const BandCells& cells, const float* x, const float* y, const float* z, std::size_t count,
                     std::uint32_t* keys);
/// The same, and the bits of their patches in counters.
void find_dense_keys(const BandCells& cells, const float* x, const float* y, const float* z, std::size_t count,
                     std::uint32_t* keys, std::uint32_t* patches);

/// Those of at most 256 particles that do not lie in cells that are left out, in the given order.
/// @param left_out  bit `key` (from the lowest of each word on) tells whether the cell of that key is
/// @param keys      as by find_dense_keys(); count + kBandLanes values
/// @param places    from 0 on, among the particles; count + kBandLanes values
/// @return          how many there are
std::size_t find_kept_keys(const BandCells& cells, const float* x, const float* y, const float* z, std::size_t count,
                           const std::uint32_t* left_out, std::uint32_t* keys, std::uint32_t* places);
constexpr std::size_t kBandLanes = 16;  ///< values beyond the last that may be written

/// Which of 512 cells are well filled, a bit each from the lowest of each word on.
/// @param counts   particles; at least `least`
/// @param patches  a bit each, from the lowest on; at least `fewest` of them set, 1 or more
void find_well_filled(const std::uint32_t* counts, std::uint32_t least, const std::uint32_t* patches,
                      std::uint32_t fewest, std::uint64_t* bits);

/// Four times the cell coordinates of at most 256 values along one axis, rounded down: those of sub-cubes.
void find_quarters(float low, float per_cell, const float* values, std::size_t count, std::int32_t* quarters);

}  // namespace meniscus
