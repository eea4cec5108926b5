/// Sizes of a frame's particles, from their attributes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "meniscus/render.h"

namespace meniscus {

struct FrameSizes {
  std::vector<float> spacing;               ///< m, twice the radii; empty: all alike
  std::span<const float> smoothing_length;  ///< m, of the particles' attribute; empty: follows from the spacing

  ParticleSizes sizes() const { return {spacing, smoothing_length}; }
};

/// @throws Error  not_found: no such attribute, with those that there are; invalid_argument: one that is not a number a
///                particle
FrameSizes frame_sizes(const Particles& particles, const SizesBy& by);

/// What a user should be told who has not asked for sizes: that an attribute `radius` or `pscale` holds radii that
/// differ by more than a hundredth; none where there is no such attribute.
std::optional<std::string> note_on_radii(const Particles& particles);

}  // namespace meniscus
