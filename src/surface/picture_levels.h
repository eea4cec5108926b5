/// Depths of a picture foretold from those of every second pixel.
#pragma once

#include "surface/raycast_field.h"

namespace meniscus {

/// Pixels of one tile of a level.
struct TilePixels {
  std::int16_t x[256], y[256];
  int count = 0;
  void add(int i, int j) {
    x[count] = static_cast<std::int16_t>(i);
    y[count++] = static_cast<std::int16_t>(j);
  }
};

/// Every how many pixels across and down a picture is marched first, 1, 2 or 4: as many as leave most of these pixels
/// no farther apart than a spacing of the particles.
int first_stride(const RaycastField& field, const View& view, const SurfaceBuffers& buffers);

/// Where the surface is smooth the depth between known pixels follows from theirs: by cubic interpolation where that
/// and linear interpolation agree, else as a first guess for a correction. It is foretold only where nothing can come
/// before it: where the ray meets its first sphere about as far before the surface as its neighbours' do, less than
/// kFarthestEntry spacings, and the known pixels around are no farther apart than a spacing.
class Foretelling {
 public:
  /// @param known   depths at every 2 `stride`-th pixel across and down
  Foretelling(const RaycastField& field, const View& view, const SurfaceBuffers& buffers, const Image<float>& known,
              int stride);

  /// Fills `depth` in the pixels [x0, x1) x [y0, y1) of the level, x0 and y0 even, at most 16 x 16, as far as it is
  /// known or foretold well; `open` are those with a depth that has to be corrected, `unknown` those to be marched.
  void tile(int x0, int y0, int x1, int y1, Image<float>& depth, TilePixels& open, TilePixels& unknown) const;

 private:
  const SurfaceBuffers& buffers_;
  const Image<float>& known_;
  int stride_;
  float spacing_;
  float size_at_zero_, size_per_metre_;  ///< of pixels, m, by their distance
};

}  // namespace meniscus
