/// One inner step of the waves, by rows of a tile.
#pragma once

#include <cstddef>
#include <cstdint>

namespace meniscus {

/// Points that are stepped or left alone together.
constexpr int kTileWidth = 128, kTileHeight = 16;

/// States of a tile. From one less than kTileMoves on it has moved in the last two steps; with kTileStill and less,
/// what is left is nothing to be seen, and is cleared from both arrays one after the other.
constexpr std::uint8_t kTileMoves = 4, kTileStill = 2, kTileCleared = 0;

/// A run of points of one row: pointers to its first point. The arrays reach one point farther on both sides.
struct RippleRow {
  const float *now, *above, *below;  ///< this row, the next and the one before; m
  const float* faces_a;              ///< between a point and the one before it; the last point's next is [count]
  const float *faces_above, *faces_below;
  const float* keeps;
  float* before;  ///< one step ago; becomes one step on
  float decay;    ///< of heights in a step
  float scale;    ///< (step / points)^2, s^2/m^2
  std::size_t count;
};

/// @return  the largest of the new heights' amounts, m
float step_row(const RippleRow& row);

}  // namespace meniscus
