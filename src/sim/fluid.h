/// The water as the solvers keep it.
#pragma once

#include <memory>
#include <vector>

#include "meniscus/sim.h"
#include "sim/boundary.h"

namespace meniscus {

/// Structure of arrays, in the order in which the particles were made.
struct Fluid {
  std::vector<float> x, y, z;     ///< m
  std::vector<float> vx, vy, vz;  ///< m/s
  std::size_t size() const { return x.size(); }
  void add(vec3 position, vec3 velocity);
};

/// The same options with every default in its place: what the solvers go by.
/// @throws Error invalid_argument: an option outside its range
FluidOptions with_defaults(FluidOptions options);

/// The longest step that is stable with these options, s: of what is set and of the defaults of what is not.
/// @throws Error invalid_argument: an option outside its range
float longest_stable_step(const FluidOptions& options);

/// Moves the water by one step.
class FluidSolver {
 public:
  virtual ~FluidSolver() = default;
  /// Longer steps than longest_step() are taken in equal parts.
  /// @param forces    acceleration of each particle besides gravity, m/s^2; empty: none
  /// @param impulses  one for each body of the boundary: what the water does to it in this step is added; summed in a
  ///                  fixed order
  virtual void step(Fluid& fluid, const Boundary& boundary, vec3 gravity, std::span<const vec3> forces, float dt,
                    std::span<Impulse> impulses, StageTimes* times) = 0;
  /// Neighbours of a particle within the smoothing length in the last step, itself not counted.
  virtual float mean_neighbours() const = 0;
  /// The longest step that is stable with these options, s.
  virtual float longest_step() const = 0;
};

/// @throws Error invalid_argument: an option outside its range
std::unique_ptr<FluidSolver> make_sph_solver(const FluidOptions& options);
std::unique_ptr<FluidSolver> make_pbf_solver(const FluidOptions& options);

}  // namespace meniscus
