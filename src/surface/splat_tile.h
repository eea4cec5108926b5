/// The innermost loops of the splatting, by instruction set.
#pragma once

#include <cstddef>
#include <cstdint>

namespace meniscus {

/// A block of pixels small enough for the nearest cache; its rows are kTileWidth values apart.
constexpr int kTileWidth = 64;
constexpr int kTileHeight = 32;

/// Rays of a tile in camera space (x right, y up, z forward). Perspective: pixel (i, j) looks along
/// (u0 + i du, v0 + j dv, 1) / length. Orthographic: it starts at (u0 + i du, v0 + j dv, 0) along z.
struct TileRays {
  bool perspective;
  float u0, du, v0, dv;
  const float* inverse_length;  ///< perspective: 1 / |(u, v, 1)| for each pixel of the tile
};

/// A sphere in camera space and the pixels of the tile (both ends included) that it may cover.
struct TileSphere {
  float x, y, z, radius;
  int x0, x1, y0, y1;
};

/// sum += length of the ray inside of the sphere and before the eye.
void splat_chord_into_tile(const TileRays& rays, const TileSphere& sphere, float* sum);

}  // namespace meniscus
