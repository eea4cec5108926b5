/// How deep the water is that rings run on.
#pragma once

#include <vector>

#include "meniscus/scene.h"
#include "meniscus/sim.h"
#include "meniscus/surface.h"

namespace meniscus {

/// Depth under each point of the ripples, m: from the water's surface down to a solid, `deepest` at most; 0 where a
/// solid stands through the surface, so that rings come back from it. Where there is no water now it may come yet: it
/// counts as `deepest` deep. Looked at no closer than every 2 cm.
/// @param water  can_march(), not empty
std::vector<float> water_depths(const Ripples& ripples, const Surface& water, const Scene& scene, float deepest);

}  // namespace meniscus
