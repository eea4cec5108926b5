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

/// A run of points of one row, and of the rows around it: pointers to the first of them. One point more on both sides
/// is read.
struct RippleRow {
  const float* now[3];      ///< m; of the row before, this one and the next
  const float* speeds2[3];  ///< m^2/s^2; no wave goes to or from where it is 0
  const float* keeps;       ///< P of u+ - u- = P (what it would be without damping at this point); null: 1
  float* before;            ///< one step ago; becomes one step on
  float decay;              ///< of heights in a step
  float scale;              ///< (step / points)^2, s^2/m^2
  std::size_t count;
};

/// @return  the largest of the new heights' amounts, m
float step_row(const RippleRow& row);

}  // namespace meniscus
