/// What a user does to the water: jets, stirring, tilting.
#pragma once

#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "sim/fluid.h"
#include "sim/obstacles.h"

namespace meniscus {

/// A jet as layers of particles, one behind the other.
class Jet {
 public:
  Jet(const Pour& pour, float spacing);
  /// Adds the layers that have left the mouth after `time` and up to dt s later, as far from it as they have come by
  /// then. Particles that would stand too close to others, in an obstacle or outside of the tank are left out, and so
  /// is what goes beyond `most` particles.
  void emit(Fluid& fluid, double time, double dt, const Obstacles& obstacles, std::size_t most) const;
  const Pour& pour() const { return pour_; }

 private:
  Pour pour_;
  float spacing_;
  vec3 direction_;
  double speed_;             ///< m/s
  double gap_;               ///< m, between layers: so that the flux is that of the disc
  std::vector<vec3> layer_;  ///< m, against the centre of the mouth
};

/// Gravity in the tank's own space: turned against the way that the tank leans.
vec3 tilted(vec3 gravity, std::span<const Tilt> tilts, double time);

/// Adds to each particle's acceleration what draws it towards the speed of a wheel that turns about the axis.
/// @param forces  m/s^2, one a particle
void stir_water(const Fluid& fluid, const Stir& stir, std::span<vec3> forces);

}  // namespace meniscus
