/// Entry and exit distances of a small square of the picture, by instruction set.
#pragma once

#include <cstddef>
#include <cstdint>

#include "surface/splat.h"
#include "surface/splat_camera.h"

namespace meniscus {

/// A square of 32 x 32 pixels as 8 x 8 blocks of 4 x 4 pixels, each block one vector of sixteen values; and what is
/// known of its quads of 2 x 2 blocks.
struct DepthTile {
  static constexpr int kSide = 32;
  static constexpr int kBlock = 4, kBlocks = kSide / kBlock;
  static constexpr int kQuad = 8, kQuads = kSide / kQuad;

  alignas(64) float entry[kSide * kSide];
  alignas(64) float exit[kSide * kSide];
  alignas(64) float inverse_length[kSide * kSide];  ///< perspective: 1 / |(u, v, 1)|
  alignas(64) float lane_u[kBlock * kBlock];        ///< of the pixels of a block, from its first one on
  alignas(64) float lane_v[kBlock * kBlock];
  float full[kQuads * kQuads];  ///< largest entry in the quad: what begins behind it is not seen there first
  /// Exact exits: the smallest in the quad. Else the largest of what was not drawn in it: no exit is to be nearer.
  float least[kQuads * kQuads];
  float farthest;  ///< entry in the tile
  bool exact_exit;
  float u0, v0;       ///< of the tile's first pixel
  int width, height;  ///< of its pixels that lie in the picture; others count as covered
};

/// Empties the tile; x, y: its first pixel.
void start_depth_tile(const SplatCamera& camera, int x, int y, bool exact_exit, DepthTile& tile);

/// Draws the spheres begin .. end (not included).
void splat_into_depth_tile(const SplatCamera& camera, const Spheres& spheres, std::size_t begin, std::size_t end,
                           DepthTile& tile);

}  // namespace meniscus
