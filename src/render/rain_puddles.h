/// The surface of the water that stands on the ground's cells.
#pragma once

#include <span>
#include <vector>

#include "meniscus/render.h"
#include "sim/puddle_levels.h"

namespace meniscus {

/// Level water over all puddles, with the ripples on it, which die away where the water ends. Around a puddle its level
/// goes on under the ground, as PuddleLevels say.
/// @param ripples  on the ground's region, whose points the field then has; null: points are the cells' middles
HeightField puddle_field(const WetGround& ground, const Ripples* ripples);

/// Depth under each point of the ripples; 0 where there is no puddle.
std::vector<float> puddle_depths(const WetGround& ground, const Ripples& ripples);

}  // namespace meniscus
