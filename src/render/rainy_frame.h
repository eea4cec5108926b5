/// Rain in the order of a frame's stages.
#pragma once

#include "meniscus/render.h"

namespace meniscus {

/// The scene's solids without the ground that rain falls on, and with it.
struct DryScene {
  Scene bodies;
  Scene scene;
};
DryScene dry_scene(const FrameSettings& settings, StageTimes* times);

/// The rain goes on to settings.time; what of it lies on ground and water comes into the scene and the surface.
void rain_on(const FrameSettings& settings, DryScene& dry, std::unique_ptr<Surface>& water, StageTimes* times);

/// Splashes and streaks over a shaded picture.
/// @param buffers  of the water, of the view's size
/// @param solids   what is seen of the scene in the same view; null: found here
void draw_rain_over(const FrameSettings& settings, const View& view, const Scene& scene, const SurfaceBuffers& buffers,
                    const SceneBuffers* solids, Image<vec3>& radiance, StageTimes* times);

/// Only the rain of a frame that is not drawn, so that the next one finds it as if it had been.
void rain_through(const Particles& particles, const FrameSettings& settings);

}  // namespace meniscus
