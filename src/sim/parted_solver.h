/// What both solvers share: steps that are taken in stable parts.
#pragma once

#include <algorithm>
#include <cmath>

#include "sim/fluid.h"
#include "sim/neighbours.h"

namespace meniscus {

class PartedSolver : public FluidSolver {
 public:
  void step(Fluid& fluid, const Boundary& boundary, vec3 gravity, std::span<const vec3> forces, float dt,
            std::span<Impulse> impulses, StageTimes* times) final {
    if (fluid.size() == 0) return;
    const int parts = std::max(1, static_cast<int>(std::ceil(dt / longest_ * 0.999f)));
    for (int part = 0; part < parts; ++part)
      part_step(fluid, boundary, gravity, forces, dt / static_cast<float>(parts), impulses, times);
  }
  float mean_neighbours() const final { return neighbours_.mean(); }
  float longest_step() const final { return longest_; }

 protected:
  /// @param longest  stable step, s
  explicit PartedSolver(float longest) : longest_(longest) {}
  virtual void part_step(Fluid& fluid, const Boundary& boundary, vec3 gravity, std::span<const vec3> forces, float dt,
                         std::span<Impulse> impulses, StageTimes* times) = 0;

  /// A velocity no faster than `fastest`, m/s; none where it is not finite.
  static vec3 slowed(vec3 velocity, float fastest) {
    const float speed = length(velocity);
    if (speed <= fastest) return velocity;
    return std::isfinite(speed) ? velocity * (fastest / speed) : vec3(0.0f);
  }

  Neighbours neighbours_;

 private:
  float longest_;
};

}  // namespace meniscus
