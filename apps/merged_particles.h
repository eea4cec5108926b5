/// Particles of different sizes, made of equal ones.
#pragma once

#include <vector>

#include "meniscus/base.h"

namespace meniscus::apps {

struct MergedParticles {
  Particles particles;
  std::vector<float> spacing;  ///< m, one a particle
};

/// In every other slab of space, 12 `range` spacings thick along x, all particles within a cube of `range` spacings
/// become one at their middle that stands for the water of them all: its spacing is theirs times the cube root of
/// their number, at most `range`. What is left of the water stays where it is.
/// @param range  >= 1
MergedParticles merged_particles(const Particles& particles, float spacing, int range);

}  // namespace meniscus::apps
