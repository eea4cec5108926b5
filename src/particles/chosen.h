/// Some of the particles of a frame.
#pragma once

#include "meniscus/base.h"

namespace meniscus {

/// The particles whose entry in `kept` is not zero, in their order, with their attributes and all that the frame tells.
/// @param kept  one entry a particle
Particles chosen(const Particles& particles, const std::vector<std::uint8_t>& kept);

}  // namespace meniscus
