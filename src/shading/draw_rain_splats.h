/// Pieces of water as what is drawn of them in a picture.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "shading/draw_rain_light.h"

namespace meniscus {

/// One piece in the picture. Not initialised: there are many.
struct Splat {
  enum class Kind : std::uint8_t {
    dot,      ///< an upright square around (x, y), w0 px wide
    line,     ///< from (x, y) on along (ux, uy), `length` px; its width goes from w0 to w1 px
    ball,     ///< pixel by pixel, from the piece
    pyramid,  ///< so, too
    disk,     ///< so, too
  } kind;
  bool round;           ///< a line with an elliptic profile instead of an even one
  float x, y;           ///< px
  float ux, uy;         ///< unit
  float length;         ///< px
  float w0, w1;         ///< px
  float alpha;          ///< where a pixel is covered wholly
  float t0, t1;         ///< distance along the rays at both ends, m
  float soft;           ///< m around that within which it goes behind what is solid
  vec3 colour;          ///< linear
  std::uint32_t piece;  ///< index
};

/// Tiles that a splat may touch, [x0, x1] x [y0, y1].
struct TileRange {
  std::int16_t x0, y0, x1, y1;
};

/// Edge of a tile, px.
constexpr int kRainTile = 32;
/// How far splats reach beyond their shape, px: half the width of the filter.
constexpr float kRainFilter = 1.5f;

/// The splats of all pieces that are seen, in the order of the pieces, with gaps between fixed runs of pieces.
struct Splats {
  static constexpr std::size_t kRun = 1024;
  std::unique_ptr<Splat[]> splats;
  std::unique_ptr<TileRange[]> ranges;
  std::vector<std::size_t> counts;  ///< used ones of each run, which starts at kRun times its number
  bool looks_behind = false;        ///< some of them look up the picture behind them
};

Splats make_splats(const View& view, std::span<const WaterPiece> pieces, const RainLight& light, const RainLook& look);

}  // namespace meniscus
