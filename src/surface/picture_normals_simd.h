/// Normals at chosen pixels of a picture.
#pragma once

#include "surface/raycast_field.h"

namespace meniscus {

struct Pixel {
  int x, y;
};

/// Sets buffers.normal at pixels with finite depth. They should lie near each other, sixteen consecutive ones nearest.
void normals_of_pixels(const RaycastField& field, const View& view, std::span<const Pixel> pixels,
                       SurfaceBuffers& buffers);

/// Pixels cut into tiles; of each tile every second pixel of every second row may be found first.
constexpr int kNormalTileWidth = 32, kNormalTileHeight = 16;
/// Fewer normals are found and the rest interpolated from this size of a spacing on, px.
constexpr float kLeastInterpolated = 4.0f;
/// Interpolated are normals between those that differ by less than acos(1 - this), 6 degrees, and whose depths differ
/// by less than this many spacings.
constexpr float kNormalsAlike = 0.0055f, kDepthsAlike = 2.0f;

/// Normals of pixels (2 i, 2 j) at (i, j), zero where none is known; as wide as whole vectors beyond the picture need.
Image<vec3> known_normals(const View& view);

/// Sets buffers.normal of the tile's pixels amidst known ones to the mean of these, where they are alike, and appends
/// the others that have a finite depth to `left`.
/// @param x0, y0  first pixel of the tile, even
/// @param reach   m: depths that differ more belong to different places
void interpolate_normals(const Image<vec3>& known, int x0, int y0, float reach, SurfaceBuffers& buffers,
                         std::vector<Pixel>& left);

}  // namespace meniscus
