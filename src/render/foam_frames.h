/// The foam that belongs to a frame, from files beside those of the water.
#pragma once

#include "meniscus/render.h"

namespace meniscus {

/// Places of all foam particles of a frame, m, file after file. A file that is not there, or cannot be read, is told.
/// @param number   of the frame, for names with {}
/// @param reading  of the water's frames: units and origin are taken from it
std::vector<vec3> foam_of_frame(const FoamOptions& foam, std::int64_t number, const ReadOptions& reading,
                                std::vector<std::string>& notes);

/// Foam over a shaded picture.
/// @param buffers  of the water, of the view's size
/// @param solids   what is seen of the scene in the same view; null: found here
void draw_foam_over(const FrameSettings& settings, const View& view, const Scene& scene, const SurfaceBuffers& buffers,
                    const SceneBuffers* solids, Image<vec3>& radiance, StageTimes* times);

}  // namespace meniscus
