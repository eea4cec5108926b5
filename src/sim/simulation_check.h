/// What a simulation may be asked for.
#pragma once

#include "meniscus/sim.h"

namespace meniscus {

// All of them: @throws Error invalid_argument, naming the option and its range.

/// Tank, limits, and that the tank has room for a particle; `fluid` has passed its own check.
void check_tank(const SimulationOptions& options);
/// Water lies within the tank's walls and over its floor.
void check_block(const Bounds& block, const Bounds& tank, Axis up);
/// Blocks of which there is nothing, where no jet brings water either.
/// @param particles  that have been made of the blocks
void check_water(const SimulationOptions& options, std::size_t particles);
void check_pour(const Pour& pour, const Bounds& tank, Axis up);
void check_stir(const Stir& stir);
void check_tilt(const Tilt& tilt);
/// There is an obstacle of this index.
void check_obstacle_index(std::size_t index, std::size_t obstacles);
void check_drag(const Drag& drag, std::size_t obstacles);

}  // namespace meniscus
