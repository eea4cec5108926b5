/// Where a march along a ray need not look: cells without water, and cells in the midst of it.
#pragma once

#include "surface/raycast_field.h"

namespace meniscus {

/// A table of cells, one spacing wide (more for water that is spread very thinly), over the box of the surface.
///
/// Outside: no particle's entry sphere reaches into the cell, so that the surface is not there, as see() takes it.
/// Inside: the density at all corners is well above the iso-value; it cannot fall below it in between, as it changes
/// over a smoothing length. What is left is unknown.
class MarchCells {
 public:
  enum Kind : std::uint8_t { outside = 0, unknown = 1, inside = 2 };

  explicit MarchCells(const RaycastField& field);

  /// m along the ray, `t` or more, to the first cell that is not of this kind; what lies beyond the table is outside.
  /// More than `limit`, up to infinity, where there is none.
  float leave(const Ray& ray, float t, float limit, Kind kind) const;
  Kind at(vec3 point) const;
  float cell_size() const { return size_; }

 private:
  std::size_t index(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(n_[1]) + static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(n_[0]) +
           static_cast<std::size_t>(x);
  }
  void mark_reached(const RaycastField& field);
  void mark_inside(const RaycastField& field);

  vec3 low_{0.0f};
  float size_ = 0, per_size_ = 0;  ///< m, 1/m
  int n_[3] = {0, 0, 0};
  std::vector<std::uint8_t> kind_;
};

}  // namespace meniscus
