#include "render/water_surface.h"

#include <algorithm>

#include "render/frame_memory.h"
#include "render/frame_sizes.h"
#include "render/inside_solids.h"
#include "surface/slab_surface.h"

namespace meniscus {
namespace {

HeightFieldOptions height_field_options(const FrameSettings& settings, const RaycastOptions& raycast) {
  HeightFieldOptions options = settings.height_field;
  options.spacing = raycast.spacing;
  if (options.region.empty()) options.region = settings.tank.inside;
  return options;
}

/// The columns, before they are bent around objects.
HeightField columns_of(const Particles& particles, const FrameSettings& settings, const RaycastOptions& raycast,
                       const Scene& scene, std::span<const vec3> colours, StageTimes* times) {
  if (settings.heights) {
    const StageTimer timer(times, "surface");
    return settings.heights(particles.time.value_or(0));
  }
  HeightFieldOptions options = height_field_options(settings, raycast);
  const InsideSolids inside(scene);
  if (!inside.empty() && !options.in_solid) options.in_solid = [&inside](vec3 point) { return inside.holds(point); };
  return height_field(particles, options, colours, times);
}

/// Looks at other surfaces from above, as closely as virtual eyes need.
HeightField look_from_above(const Surface& surface, const FrameSettings& settings) {
  Bounds region = surface.bounds();
  if (!settings.water.empty()) {
    region.low = glm::max(region.low, settings.water.low);
    region.high = glm::min(region.high, settings.water.high);
  }
  const vec3 extent = region.extent();
  const float longest = std::max({extent.x, extent.y, extent.z});
  return height_field_of(surface, settings.height_field.up, region, std::max(surface.spacing(), longest / 512));
}

/// As a whole, or in slabs where that would take more memory than there is.
std::unique_ptr<Surface> raycast_surface(const Particles& particles, const FrameSettings& settings,
                                         const RaycastOptions& raycast, std::span<const vec3> colours,
                                         const ParticleSizes& sizes, StageTimes* times, bool& in_slabs) {
  const bool whole = settings.surface_memory == 0 || particles.empty();
  const std::uint64_t pixels = static_cast<std::uint64_t>(settings.view.width) *
                               static_cast<std::uint64_t>(settings.view.height) *
                               (settings.antialias == Antialias::full ? 4 : 1);
  const int slabs = whole ? 1
                          : slabs_within(settings.surface_memory, particles.size(), particles.bounds(), raycast, pixels,
                                         !colours.empty());
  const bool lit_through = settings.caustics && settings.shadow && !settings.colour;
  if (slabs == 1 || !sizes.empty() ||
      !can_be_cut(settings.method, settings.optics.refraction,
                  settings.material.transparent && settings.show == Show::water, lit_through, settings.rain != nullptr))
    return make_raycast_surface(particles, raycast, colours, times, sizes);
  in_slabs = true;
  return make_slab_surface(particles, raycast, colours, slabs == 0 ? kMostSlabs : slabs);
}

}  // namespace

SurfelOptions surfel_options(const FrameSettings& settings, const RaycastOptions& raycast) {
  SurfelOptions surfels = settings.surfels;
  surfels.spacing = raycast.spacing;
  surfels.smoothing_length = raycast.smoothing_length;
  surfels.iso = raycast.iso;
  surfels.keep_thin = raycast.keep_thin;
  return surfels;
}

WaterSurface water_surface(const Particles& particles, const FrameSettings& settings, const RaycastOptions& raycast,
                           const Scene& scene, std::span<const vec3> colours, StageTimes* times) {
  WaterSurface water;
  if (!settings.sizes.empty() && settings.method != SurfaceMethod::raycast)
    throw Error(ErrorCode::unsupported,
                {"only a ray-cast surface takes sizes of single particles", "--surface raycast", {}, {}, {}, {}, {}});
  const FrameSizes sizes = frame_sizes(particles, settings.sizes);
  const bool eyes = settings.optics.refraction == RefractionMethod::virtual_eye && settings.material.transparent;
  switch (settings.method) {
    case SurfaceMethod::spheres:
      water.surface = make_sphere_surface(particles, 0.5f * raycast.spacing, colours);
      break;
    case SurfaceMethod::raycast:
      water.surface = raycast_surface(particles, settings, raycast, colours, sizes.sizes(), times, water.in_slabs);
      break;
    case SurfaceMethod::surfels:
      water.surface = make_surfel_surface(particles, surfel_options(settings, raycast), colours, times);
      break;
    case SurfaceMethod::height_field: {
      HeightField field = columns_of(particles, settings, raycast, scene, colours, times);
      if (eyes && !field.empty()) {
        const StageTimer timer(times, "virtual eyes");
        water.objects = water_objects(field, scene, settings.optics.eyes);
        adapt(field, adaptations(water.objects, settings.optics.eyes));
      }
      water.surface = make_height_field_surface(std::move(field));
      return water;
    }
  }
  if (eyes && !water.surface->bounds().empty()) {
    const StageTimer timer(times, "virtual eyes");
    water.seen_from_above = look_from_above(*water.surface, settings);
    water.objects = water_objects(*water.seen_from_above, scene, settings.optics.eyes);
  }
  return water;
}

}  // namespace meniscus
