/// Splats drawn into one tile of a picture.
#pragma once

#include "shading/draw_rain_splats.h"

namespace meniscus {

/// What all tiles share.
struct RainPicture {
  const View& view;
  std::span<const WaterPiece> pieces;
  const RainLight& light;
  const RainLook& look;
  const Image<float>& depth;  ///< m along the rays
  const Image<vec3>& behind;  ///< the picture without pieces
};

/// Pixels of a tile, without x1 and y1, and where their radiances stand.
struct Tile {
  int x0, y0, x1, y1;
  vec3* pixels;           ///< of (x0, y0)
  std::ptrdiff_t stride;  ///< from row to row
  /// To be indexed by the picture's x.
  vec3* row(int y) const { return pixels + (y - y0) * stride - x0; }
};

/// How much of a piece at the distance t is before what is solid at a pixel: half where both are at one place, soft
/// around it. A pixel's depth is that of its middle only; what may lie within the pixel does not hide it.
float visible_part(const Image<float>& depth, int x, int y, float t, float soft);

/// Blends a splat into the tile.
void draw_splat(const RainPicture& picture, const Tile& tile, const Splat& splat);
/// Balls, pyramids and disks, pixel by pixel.
void draw_body(const RainPicture& picture, const Tile& tile, const Splat& splat);

inline void blend(vec3& radiance, vec3 colour, float alpha) { radiance += alpha * (colour - radiance); }

}  // namespace meniscus
