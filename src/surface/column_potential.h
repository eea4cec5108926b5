/// The potential of particles along vertical columns.
#pragma once

#include <vector>

#include "meniscus/surface.h"

namespace meniscus {

/// Options of height_field() with every default filled in.
struct ColumnOptions {
  float spacing, reach, iso;  ///< m, m, 1
  float drop;                 ///< m; water thinner than this over air is a drop
};

/// phi(x) = sum_i sqrt(1 - r_i^2 / h^2) over r_i < h                                     [Cords2008] eq. 5, 6
///
/// Particles near the region's sides and floor are mirrored there, so that walls take nothing away from it. Those more
/// than half a spacing outside are left out.
class ColumnPotential {
 public:
  ColumnPotential(const Particles& particles, Axis up, const Bounds& region, const ColumnOptions& options);

  /// The particles beside a column; memory for it is kept from column to column.
  struct Near {
    std::size_t count = 0;          ///< of them
    std::vector<float> weight;      ///< 1 - d^2 / h^2, d being the distance from the column; padded with -1
    std::vector<float> z;           ///< m
    std::vector<std::size_t> next;  ///< in each bin around
  };

  /// Height of the surface in a column; -infinity where there is none.
  /// @param in_solid  tells whether a solid stands at a height of this column
  float height(float a, float b, FunctionRef<bool(float)> in_solid, Near& near) const;
  /// Mean colour at a height, weighted by the potentials.
  vec3 colour(float a, float b, float z, std::span<const vec3> colours, Near& near) const;
  /// Plain sum in double precision over all particles, mirrored ones as well: what the search is checked against.
  double value(float a, float b, float z) const;

 private:
  struct Entry {
    float a, b, z;
    std::uint32_t index;
  };
  struct Bins {
    int i0, i1, j0, j1;
    int count() const { return (i1 - i0 + 1) * (j1 - j0 + 1); }
  };
  Bins bins_around(float a, float b) const;
  float highest(const Bins& bins, const Near& near) const;
  void gather(const Bins& bins, float a, float b, float down_to, Near& near) const;
  float potential(const Near& near, float z) const;
  float refined(const Near& near, float low, float high) const;

  ColumnOptions options_;
  float low_a_ = 0, low_b_ = 0, per_bin_ = 0, floor_ = 0;
  int bins_a_ = 0, bins_b_ = 0;
  std::vector<Entry> entries_;    ///< by bin, from above
  std::vector<float> a_, b_, z_;  ///< the same, apart, with some to spare
  std::vector<std::uint32_t> start_;
};

}  // namespace meniscus
