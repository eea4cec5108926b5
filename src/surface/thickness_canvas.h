/// A rectangle of the picture's samples that water is added to, by instruction set.
#pragma once

#include <cstddef>
#include <vector>

#include "surface/splat_camera.h"

namespace meniscus {

/// Sums of water along the rays of some of a picture's samples, m. One is written by one thread.
struct ThicknessCanvas {
  SampleRect rect;            ///< of the samples that it holds
  int pitch = 0;              ///< values from row to row: one more sample on each side, which takes what falls beside
  std::vector<float> values;  ///< (height + 2) rows

  void start(const SampleRect& samples);
  int width() const { return rect.x1 - rect.x0 + 1; }
  int height() const { return rect.y1 - rect.y0 + 1; }
  const float* row(int y) const { return values.data() + static_cast<std::ptrdiff_t>(y + 1) * pitch + 1; }
  float* row(int y) { return values.data() + static_cast<std::ptrdiff_t>(y + 1) * pitch + 1; }
};

/// Sums of water of points that lie near each other, by which of the four samples around a point gets it: a point
/// changes one vector of four that no other point's overlaps in part.
struct PointCanvas {
  SampleRect rect;            ///< of the samples that it holds
  int pitch = 0;              ///< fours of values from row to row: samples from one before the first to the last
  std::vector<float> values;  ///< (height + 1) rows; of each sample what it gets, and those right, below and across

  void start(const SampleRect& samples);
  int width() const { return rect.x1 - rect.x0 + 1; }
  int height() const { return rect.y1 - rect.y0 + 1; }
};
/// Adds all of it to a canvas that holds its samples.
void add_sums(const PointCanvas& points, ThicknessCanvas& canvas);

/// Adds `volume` m^3 of water at each of the points, spread over the four samples around it.
/// @param x, y, z  `count` values, world space, m, and readable memory for 16 more
/// @param shares   of `volume` by point, the same; null: all of it
void add_points(const SplatCamera& camera, const float* x, const float* y, const float* z, const float* shares,
                std::size_t count, float volume, PointCanvas& canvas);

/// Adds `weight` times the part of each ray that lies inside the sphere and before the eye.
void add_sphere(const SplatCamera& camera, vec3 centre, float radius, float weight, ThicknessCanvas& canvas);

/// The same for a box along the axes of the world.
/// @param edge  m, 0 or more: where rays run nearly along some sides these fall off over so much, at least a sample
void add_box(const SplatCamera& camera, const SplatBox& box, float weight, float edge, ThicknessCanvas& canvas);

}  // namespace meniscus
