/// Water and its solver as the tests of both take them.
#pragma once

#include <cmath>

#include "box_boundary.h"

namespace meniscus {

struct Case {
  FluidOptions options;
  Fluid fluid;
  std::unique_ptr<FluidSolver> solver;
  double mass = 0;  ///< kg, of a particle

  Case(FluidOptions given, Fluid water) : options(with_defaults(given)), fluid(std::move(water)) {
    solver = options.solver == Solver::sph ? make_sph_solver(options) : make_pbf_solver(options);
    mass = options.rest_density * std::pow(static_cast<double>(options.spacing), 3);
  }
  void step(const Boundary& boundary, std::span<Impulse> impulses = {}) {
    solver->step(fluid, boundary, options.gravity, {}, options.step, impulses, nullptr);
  }
  double energy() const { return kinetic_energy(fluid, mass) + potential_energy(fluid, mass); }
  double kinetic() const { return kinetic_energy(fluid, mass); }
  /// Mean height, in spacings.
  double mean_height_rel() const {
    double sum = 0;
    for (const float y : fluid.y) sum += y;
    return sum / static_cast<double>(fluid.size()) / options.spacing;
  }
  bool within(const Bounds& box) const {
    for (std::size_t i = 0; i < fluid.size(); ++i)
      if (!(fluid.x[i] > box.low.x && fluid.x[i] < box.high.x && fluid.y[i] > box.low.y && fluid.y[i] < box.high.y &&
            fluid.z[i] > box.low.z && fluid.z[i] < box.high.z))
        return false;
    return true;
  }
};

inline FluidOptions fluid_of(Solver solver, float spacing) {
  FluidOptions options;
  options.solver = solver;
  options.spacing = spacing;
  return options;
}

inline Bounds box(vec3 size) {
  Bounds bounds;
  bounds.low = vec3{0.0f};
  bounds.high = size;
  return bounds;
}

}  // namespace meniscus
