/// Steps of the sheet flow over a row of cells or of the sides between them.                     [Bates2010]
#pragma once

#include <cstddef>

namespace meniscus {

/// Sides between cells of row a and of row b.
struct SidesRow {
  const float *bed_a, *bed_b;             ///< m
  const double *depth_a, *depth_b;        ///< m
  const double *laminar_a, *laminar_b;    ///< K nu / 8, m^2/s
  const double *friction_a, *friction_b;  ///< f / 8
  double* flow;                           ///< m^2/s, positive from a to b
  std::size_t count;
  double dt;    ///< s
  double over;  ///< dt by the cell's edge, s/m
};
/// New flow through the sides:
///   q' = (q + g h_f dt S) / (1 + dt (K nu / (8 h^2) + f |q| / (8 h_f h)))
/// in water that is h deep over the higher bed and of which h_f = h - kHeldFilm flows, with the slope S of the level.
void step_flow(const SidesRow& row);

/// A row of cells; `flow_a` has count + 1 sides along the row, `flow_b` and `flow_b_next` the sides before and after
/// it.
struct CellsRow {
  const double *flow_a, *flow_b, *flow_b_next;  ///< m^2/s
  double* part;  ///< of what flows out of a cell; entries before and after it and in the rows beside are looked at
  std::size_t stride;  ///< from a row of `part` to the next
  double* depth;       ///< m
  std::size_t count;
  double over;  ///< dt by the cell's edge, s/m
};
/// Finds the part of the flow out of each cell that the water over its film can give.
void limit_flow(const CellsRow& row);
/// Moves the water; `moved` gets the sum of what flows through the sides of each cell, m^2/s. Returns the largest
/// depth.
double move_water(const CellsRow& row, double* moved);

}  // namespace meniscus
