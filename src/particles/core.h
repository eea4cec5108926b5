/// Where nearly all particles are.
#pragma once

#include "meniscus/base.h"

namespace meniscus {

/// The box with at most 0.3 % of the particles beyond each of its sides; none for fewer than 334 particles. From at
/// most 2^18 particles, every so many-th. Empty for no particles.
Bounds core_bounds(const Particles& particles);

}  // namespace meniscus
