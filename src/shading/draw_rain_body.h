/// What pieces that are drawn pixel by pixel share.
#pragma once

#include <algorithm>
#include <cmath>

#include "shading/draw_rain_tile.h"

namespace meniscus {

/// Least variance of highlights, rad^2: narrower ones fall between pixels.
inline constexpr float kLeastVariance = 3e-4f;
/// Points along the edge of a pixel where small pieces are drawn whole.
inline constexpr int kFine = 16;

/// Those of a tile that a rectangle touches.
struct Pixels {
  int x0, y0, x1, y1;
  Pixels(const Tile& tile, vec2 low, vec2 high)
      : x0(std::max(tile.x0, static_cast<int>(std::floor(std::max(low.x, -1.0f))))),
        y0(std::max(tile.y0, static_cast<int>(std::floor(std::max(low.y, -1.0f))))),
        x1(std::min(tile.x1, static_cast<int>(std::ceil(std::min(high.x, 1e6f))))),
        y1(std::min(tile.y1, static_cast<int>(std::ceil(std::min(high.y, 1e6f))))) {}
};

/// What the refracted ray shows: the picture behind where it goes on nearly as the ray of a pixel, else what is around.
/// @param straight  cosine between it and the viewing ray
/// @param t         m from the eye to the point
/// @param behind    m from the eye to what is seen behind the point
vec3 refracted_light(const RainPicture& picture, vec3 point, vec3 exit, float straight, float t, float behind,
                     float cone);

/// A pyramid with the faces that it has and the light of a round jet.
void draw_pile(const RainPicture& picture, const Tile& tile, const Splat& splat);

}  // namespace meniscus
