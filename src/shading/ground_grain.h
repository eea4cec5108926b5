/// The grain of dry ground: what makes concrete, asphalt and steel look like it from near.
#pragma once

#include "meniscus/base.h"

namespace meniscus {

/// The grain at a place of a plane.
struct Grain {
  float shade = 1;          ///< factor of the albedo; its mean over the plane is one
  vec2 slope{0.0f};         ///< of the bumps that the beam resolves, along the plane's axes
  float hidden_slopes = 0;  ///< variance of the slope along one axis of the bumps that it does not
  float relief = 0;         ///< -1 .. 1: how much the place stands out; water goes from it
};

/// @param p      m, on the plane
/// @param width  m, of the beam
Grain concrete_grain(vec2 p, float width, std::uint64_t seed);
Grain asphalt_grain(vec2 p, float width, std::uint64_t seed);
Grain steel_grain(vec2 p, float width, std::uint64_t seed);

}  // namespace meniscus
