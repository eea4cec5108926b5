/// What an obstacle may be.
#pragma once

#include "meniscus/sim.h"

namespace meniscus {

/// @throws Error  invalid_argument, naming the option; the shape itself is looked at where it is made
void check_obstacle(const ObstacleOptions& options);
void check_pose(const Pose& pose);

}  // namespace meniscus
