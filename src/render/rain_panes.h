/// The panes of a glass tank, as rain meets them.
#pragma once

#include <vector>

#include "meniscus/scene.h"

namespace meniscus {

/// Sight goes through the walls of a glass tank, drops do not: its upright panes as solids, as thick as its walls. None
/// for other tanks, whose walls are solids already.
std::vector<PlacedSolid> glass_panes(const Tank& tank);

/// The scene with more solids behind its own.
Scene with_solids(const Scene& scene, const std::vector<PlacedSolid>& more);

}  // namespace meniscus
