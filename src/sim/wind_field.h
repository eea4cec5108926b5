/// Wind between points where it is known.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "meniscus/base.h"

namespace meniscus {

/// Velocities at points, which are returned exactly there. Points that fill a regular lattice along the axes, in any
/// order, are interpolated trilinearly; of others the eight nearest count by inverse distances, cut off where the next
/// one stands [FrankeNielson1980]. Places outside of all points take the nearest place of their box.
class WindField {
 public:
  /// @throws Error  invalid_argument: no points, no attribute "velocity" of three components, values not finite
  explicit WindField(const Particles& points);
  vec3 at(vec3 place) const;  ///< m/s
  vec3 mean() const { return mean_; }
  float pitch() const { return pitch_; }  ///< m between neighbouring points, roughly; infinity for one point

 private:
  bool fill_lattice(const Particles& points);
  void fill_cells(const Particles& points);
  vec3 in_lattice(vec3 place) const;
  vec3 among_nearest(vec3 place) const;
  std::uint32_t cell_along(int axis, float coordinate) const;

  Bounds bounds_;
  vec3 mean_{0.0f};
  float pitch_ = 0;
  bool lattice_ = false;
  std::array<std::uint32_t, 3> count_{1, 1, 1};  ///< of lattice points, or of cells
  vec3 step_{1.0f};                              ///< m between lattice points, or of a cell
  std::vector<std::uint32_t> starts_;            ///< of each cell's points; one more than cells
  std::vector<vec3> places_;                     ///< by cell
  std::vector<vec3> velocities_;                 ///< by lattice point, x first, or by cell
};

}  // namespace meniscus
