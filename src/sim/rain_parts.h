/// What Rain works out once.
#pragma once

#include <glm/vec3.hpp>

#include "base/field_axes.h"
#include "meniscus/sim.h"
#include "sim/rain_spectrum.h"

namespace meniscus {

/// Drops come in slots of time, numbered from the start of the rain on; what a slot holds depends on the seed and its
/// number only.
struct Rain::Parts {
  RainSpectrum spectrum;
  FieldAxes axes;
  double slot = 0;                    ///< s
  std::vector<double> number_below_;  ///< probability of at most i drops in a slot
  double ways_apart = 0.05;           ///< s between points of a way in gusts
  double step_length = 0;             ///< m, of a way through a field
  std::vector<RainDrop> single;       ///< beside the rain, in order of time

  /// Drops without the single ones, as arriving().
  std::vector<RainDrop> raining(const Rain& rain, double from, double until) const;
};

/// The wind at a drop less its fall, m/s: as fast as it would go after a while, and not slower downwards than a tenth
/// of its fall, so that it does come down.
glm::dvec3 drop_velocity(vec3 wind, double fall, const FieldAxes& axes);

}  // namespace meniscus
