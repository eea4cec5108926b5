/// Distances to the solids of a picture.
#pragma once

#include "meniscus/scene.h"

namespace meniscus {

/// Distance along each pixel's ray, m; infinity: nothing.
/// @param seen  what is seen of the scene in this view; null: found here
Image<float> solid_depths(const View& view, const Scene& scene, const SceneBuffers* seen);

}  // namespace meniscus
