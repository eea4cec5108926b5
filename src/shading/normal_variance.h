/// How much normals change over one pixel.
#pragma once

#include "meniscus/base.h"

namespace meniscus {

/// Squared change of the normal per pixel between neighbouring samples. Highlights and mirror images are widened by
/// it, so that they do not sparkle where a pixel sees many slopes.
///
/// For pixel centres the neighbours are the four next pixels; for a list of points each pixel is represented by the
/// first point in it, so a list of all pixel centres gives the same values.
class NormalVariance {
 public:
  /// The arguments must outlive this.
  NormalVariance(const View& view, std::span<const vec2> points, const Image<vec3>& normals);
  /// Of the sample `i` (row-major for pixel centres); at most 0.25.
  float at(std::size_t i) const;

 private:
  void include(std::size_t i, int x, int y, float& largest) const;

  std::span<const vec2> points_;
  const Image<vec3>& normals_;
  int width_, height_;
  Image<int> first_;  ///< index of the first point in a pixel, or -1; empty for pixel centres
};

}  // namespace meniscus
