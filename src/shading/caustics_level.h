/// The water as the plane methods see it: heights over a horizontal grid.
#pragma once

#include "meniscus/surface.h"

namespace meniscus {

/// Where the points of a height field lie: components of world points along its axes.
struct FieldFrame {
  int a = 0, b = 2, up = 1;  ///< components of a vec3
  vec2 low{0.0f}, step{1.0f};
  int width = 0, height = 0;  ///< points

  FieldFrame() = default;
  explicit FieldFrame(const HeightField& field);
  /// m along a and b.
  vec2 across(vec3 v) const { return {v[a], v[b]}; }
  vec3 world(vec2 across, float level) const {
    vec3 v{0.0f};
    v[a] = across.x;
    v[b] = across.y;
    v[up] = level;
    return v;
  }
  /// The place of point (i, j), m.
  vec2 place(int i, int j) const { return low + step * vec2{static_cast<float>(i), static_cast<float>(j)}; }
  vec2 high() const { return place(width - 1, height - 1); }
  float longer_side() const;
};

/// Heights of the water, for looking up what lies under it.
class WaterLevel {
 public:
  explicit WaterLevel(const HeightField& field);
  const FieldFrame& frame() const { return frame_; }
  /// Mean of the heights, m; the plane that stands for still water.
  float mean() const { return mean_; }
  float lowest() const { return lowest_; }
  float highest() const { return highest_; }
  bool any() const { return lowest_ <= highest_; }
  /// m by which a point lies under the water above it, negative over it; beside the field by its mean height.
  /// Where the field has no water: -infinity.
  float depth(vec3 point) const;
  /// How much of the place is water, [0, 1], linear between points; 0 beside the field.
  float cover(vec2 place) const;

 private:
  FieldFrame frame_;
  Image<float> height_;
  float mean_ = 0;
  float lowest_ = std::numeric_limits<float>::infinity(), highest_ = -std::numeric_limits<float>::infinity();
  bool closed_ = true;  ///< there are no holes
};

/// An image's value between its points; (0, 0) is the first. The point must lie within.
inline float between(const Image<float>& image, float x, float y) {
  const int i = x < static_cast<float>(image.width() - 1) ? static_cast<int>(x) : image.width() - 2;
  const int j = y < static_cast<float>(image.height() - 1) ? static_cast<int>(y) : image.height() - 2;
  const float s = x - static_cast<float>(i), t = y - static_cast<float>(j);
  const float *here = image.row(j) + i, *next = image.row(j + 1) + i;
  return (1.0f - t) * ((1.0f - s) * here[0] + s * here[1]) + t * ((1.0f - s) * next[0] + s * next[1]);
}

}  // namespace meniscus
