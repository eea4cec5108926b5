/// Position based fluids [Macklin2013].
#pragma once

#include "sim/neighbours.h"

namespace meniscus {

/// Puts defaults in the place of what is not set: step, viscosity, vorticity.
void fill_pbf_defaults(FluidOptions& options);
/// The longest step, s, of options without gaps.
float longest_pbf_step(const FluidOptions& options);

}  // namespace meniscus
