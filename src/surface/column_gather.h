/// The particles beside a column, out of vertical bins; compiled once for each instruction set.
#pragma once

#include <cstddef>
#include <cstdint>

namespace meniscus {

/// Particles sorted into bins, in each from above. Behind the last one 16 more can be read.
struct ColumnBins {
  const float *a, *b, *z;      ///< m
  const std::uint32_t* start;  ///< of each bin, and of one behind the last
  int bins_a;
};

/// A block of bins around a column.
struct ColumnSearch {
  int i0, i1, j0, j1;
  float a, b;         ///< m, of the column
  float per_reach2;   ///< 1/m^2
  float down_to;      ///< m; only what lies higher is wanted
  std::size_t* next;  ///< of each bin of the block, row by row: the first that has not been looked at; moved on
};

/// Appends weight 1 - d^2 / h^2 and height of the particles less than the reach h from the column, bin by bin.
/// @param count  values in the lists before; there must be room for all that is left in the bins and 16 more
/// @return       and after
std::size_t gather_column(const ColumnBins& bins, const ColumnSearch& search, float* weights, float* places,
                          std::size_t count);

}  // namespace meniscus
