/// Entry and exit distances of a small square of the picture, by instruction set.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "surface/splat.h"
#include "surface/splat_camera.h"

namespace meniscus {

/// A square of 64 x 64 pixels as 16 x 16 blocks of 4 x 4 pixels, each block one vector of sixteen values; and what is
/// known of its quads of 2 x 2 blocks.
struct DepthTile {
  static constexpr int kSide = 64;
  static constexpr int kBlock = 4, kBlocks = kSide / kBlock;
  static constexpr int kQuad = 8, kQuads = kSide / kQuad;

  alignas(64) float entry[kSide * kSide];
  alignas(64) float inverse_length[kSide * kSide];  ///< perspective: 1 / |(u, v, 1)|
  alignas(64) float lane_u[kBlock * kBlock];        ///< of the pixels of a block, from its first one on
  alignas(64) float lane_v[kBlock * kBlock];
  alignas(64) float full[kQuads * kQuads];          ///< largest entry in the quad: what begins
                                                    ///< behind it is not seen there first
  alignas(64) float exit[kQuads * kQuads];          ///< m: no ray of the quad leaves one
                                                    ///< of the runs there behind
  alignas(64) float full_block[kBlocks * kBlocks];  ///< the same in the block
  float farthest;                                   ///< entry in the tile
  float u0, v0;                                     ///< of the tile's first pixel
  int width, height;                                ///< of its pixels that lie in the picture; others count as
                                                    ///< covered
};

/// Empties the tile; x, y: its first pixel.
void start_depth_tile(const SplatCamera& camera, int x, int y, DepthTile& tile);

/// A run of spheres of a cluster in a tile.
struct TileRun {
  float near, far;  ///< m: no ray enters its box before, or leaves it behind
  const Spheres* spheres;
  std::uint32_t begin;
  std::uint8_t count;
  std::uint8_t x0, x1, y0, y1;  ///< quads that it touches, both ends included
};

/// Adds the runs of a cluster that the tile may show to the list.
void list_runs(const SplatCamera& camera, const Spheres& spheres, const SphereGroups::Cluster& cluster, DepthTile& tile,
               std::vector<TileRun>& runs);

/// Draws what may be seen of the runs, one after another.
void draw_runs(const SplatCamera& camera, std::span<const TileRun> runs, DepthTile& tile);

/// Writes the tile into the pictures, where x, y is its first pixel.
void copy_depth_tile(const DepthTile& tile, int x, int y, Image<float>& entry, Image<float>& exit);

}  // namespace meniscus
