/// The surface of the water that stands on the ground's cells.
#pragma once

#include <span>
#include <vector>

#include "meniscus/render.h"

namespace meniscus {

/// Water of this depth, m, is a puddle with a surface of its own; less is a film on the ground.
constexpr double kPuddle = 1e-3;

/// Level water over all puddles, with the ripples on it. Around a puddle its level goes on for a few cells, under the
/// ground, so that the shore is where level water meets the ground and not the edge of a cell.
/// @param ripples  on the ground's region, whose points the field then has; null: points are the cells' middles
HeightField puddle_field(const WetGround& ground, const Ripples* ripples);

/// Depth under each point of the ripples; 0 where there is no puddle.
std::vector<float> puddle_depths(const WetGround& ground, const Ripples& ripples);

}  // namespace meniscus
