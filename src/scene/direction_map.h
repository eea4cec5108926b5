/// A function of direction as a table.
#pragma once

#include <cmath>

#include "meniscus/base.h"

namespace meniscus {

/// Turns world directions so that the environment's up is z.
struct UpFrame {
  vec3 east, north, up;
  vec3 local(vec3 world) const;
  vec3 world(vec3 local) const;
};

/// @param up  any length but zero
UpFrame up_frame(vec3 up);

/// Radiance over the sphere on an octahedral map [Engelhardt2008]: the sphere is projected to |x|+|y|+|z| = 1 and
/// unfolded to a square, without the trigonometry and the poles of longitude and latitude. Nodes stand on the
/// square's edges too, where those that are folded together hold the same value, so linear interpolation is
/// continuous everywhere.
class DirectionMap {
 public:
  DirectionMap() = default;
  /// Fills the table from function(direction), in parallel.
  DirectionMap(int cells, FunctionRef<vec3(vec3)> function);

  /// The table, row by row; one more row of any values follows it.
  const vec3* nodes() const { return nodes_.data(); }
  int cells() const { return cells_; }

  /// Interpolated value; `direction` need not be unit, but not zero.
  vec3 at(vec3 direction) const {
    const float scale = 1.0f / (std::abs(direction.x) + std::abs(direction.y) + std::abs(direction.z));
    float x = direction.x * scale, y = direction.y * scale;
    if (direction.z < 0) {
      const float folded_x = (1.0f - std::abs(y)) * (x < 0 ? -1.0f : 1.0f);
      y = (1.0f - std::abs(x)) * (y < 0 ? -1.0f : 1.0f);
      x = folded_x;
    }
    const float half = 0.5f * static_cast<float>(cells_);
    x = half * x + half;
    y = half * y + half;
    const int i = clamped(x), j = clamped(y);
    const float s = x - static_cast<float>(i), t = y - static_cast<float>(j);
    const vec3* low = nodes_.row(j) + i;
    const vec3* high = nodes_.row(j + 1) + i;
    return (1.0f - t) * ((1.0f - s) * low[0] + s * low[1]) + t * ((1.0f - s) * high[0] + s * high[1]);
  }

 private:
  int clamped(float x) const {
    const int i = static_cast<int>(x);
    return i < 0 ? 0 : (i >= cells_ ? cells_ - 1 : i);
  }

  int cells_ = 0;
  Image<vec3> nodes_;
};

/// Point of the octahedron |x|+|y|+|z| = 1 at map coordinates in [-1, 1]^2. Its distance r from the origin gives the
/// solid angle of a map cell, proportional to 1 / r^3.
vec3 on_octahedron(float x, float y);

/// The map blurred by a Gaussian of standard deviation `sigma` radians.
DirectionMap blurred(const DirectionMap& map, float sigma, int cells);

/// Irradiance of surfaces from the radiance in `map`, by normal.
DirectionMap convolved_with_cosine(const DirectionMap& map, int cells);

}  // namespace meniscus
