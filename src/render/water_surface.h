/// The water of one frame as its settings want it.
#pragma once

#include <memory>
#include <vector>

#include "meniscus/render.h"

namespace meniscus {

/// A surface, with what virtual eyes need to know of it.
struct WaterSurface {
  std::unique_ptr<Surface> surface;
  bool in_slabs = false;                       ///< drawn in parts: it does much work for each question
  std::optional<HeightField> seen_from_above;  ///< of surfaces that are none, for virtual eyes
  std::vector<WaterObject> objects;            ///< in Scene::solids(); only for virtual eyes

  /// The columns for virtual eyes.
  const HeightField& columns() const { return seen_from_above ? *seen_from_above : *surface->height_field(); }
};

/// @param scene    its solids stand in the water
/// @param raycast  settings.surface, fitted to the picture's resolution
/// @param colours  one linear colour a particle, or empty
WaterSurface water_surface(const Particles& particles, const FrameSettings& settings, const RaycastOptions& raycast,
                           const Scene& scene, std::span<const vec3> colours, StageTimes* times);

/// The options of a frame's surfels, with what they share with the ray-cast surface.
SurfelOptions surfel_options(const FrameSettings& settings, const RaycastOptions& raycast);

}  // namespace meniscus
