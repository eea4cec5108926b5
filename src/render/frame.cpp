#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "meniscus/render.h"
#include "particles/chosen.h"
#include "render/antialias.h"
#include "render/foam_frames.h"
#include "render/rainy_frame.h"
#include "render/show.h"
#include "render/water_surface.h"

namespace meniscus {
namespace {

/// What the water does to the light on the solids.
void light(Scene& scene, const Surface& surface, const FrameSettings& settings, StageTimes* times) {
  const bool has_solids = !scene.solid_bounds().empty();
  if ((!settings.ground.visible && !has_solids) || surface.bounds().empty()) return;
  if (settings.caustics && settings.shadow && settings.material.transparent && !settings.colour)
    scene.set_water_light(
        caustics(surface, scene, settings.material, settings.caustics_options, times, settings.water));
  else if (settings.shadow)
    scene.set_water_light(soft_shadow(surface, settings.environment, settings.ground, settings.material, times,
                                      settings.water, has_solids));
}

/// The particles without those too far away to be sorted together with the rest; nothing if there are none.
std::optional<Particles> without_far(const Particles& particles, const FrameSettings& settings) {
  const float reach = 4e5f * settings.surface.spacing;
  const vec3 extent = particles.bounds().extent();
  if (std::max({extent.x, extent.y, extent.z}) <= 2 * reach) return std::nullopt;
  const vec3 centre = robust_bounds(particles).centre();
  const auto is_near = [&](std::size_t i) {
    const vec3 off = particles.position(i) - centre;
    return std::max({std::abs(off.x), std::abs(off.y), std::abs(off.z)}) < reach;
  };
  std::vector<std::uint8_t> kept(particles.size());
  for (std::size_t i = 0; i < kept.size(); ++i) kept[i] = is_near(i);
  return chosen(particles, kept);
}

void draw_colour_bar(FramePicture& frame, const ColourBy& colour) {
  draw_legend(frame.picture, colour.attribute, frame.colour_range.first, frame.colour_range.second,
              [&](float t) { return colormap_at(colour.colormap, t); });
}

/// The particles that are drawn where they are not all of them: stray ones are drops, or nobody's.
/// @param far_away  how many are left out because they are
std::optional<Particles> kept_of(const Particles& all, const FrameSettings& settings, const RaycastOptions& surface,
                                 std::size_t& far_away, StageTimes* times) {
  std::optional<Particles> kept;
  if (settings.drop_isolated > 0) {
    const StageTimer timer(times, "particles");
    const float reach = surface.smoothing_length > 0 ? surface.smoothing_length : 2 * surface.spacing;
    kept = without_isolated(all, reach, settings.drop_isolated);
  }
  if (std::optional<Particles> near = without_far(kept ? *kept : all, settings)) {
    far_away = (kept ? *kept : all).size() - near->size();
    kept = std::move(near);
  }
  return kept;
}

}  // namespace

DryScene dry_scene(const FrameSettings& settings, StageTimes* times) {
  Scene bodies(settings.environment, settings.ground);
  if (!settings.solids.empty() || settings.tank.style != TankStyle::none) {
    const StageTimer timer(times, "scene");
    bodies.set_tank(settings.tank);
    bodies.set_solids(settings.solids);
  }
  bodies.set_lamps(settings.lamps);
  DryScene dry{bodies, bodies};
  const std::shared_ptr<const Solid> relief = settings.rain ? settings.rain->relief() : nullptr;
  if (relief) {
    const StageTimer timer(times, "scene");
    std::vector<PlacedSolid> solids = settings.solids;
    solids.push_back({relief, glm::mat4(1.0f), std::nullopt, true});
    dry.scene.set_solids(std::move(solids));
  }
  return dry;
}

void rain_through(const Particles& all, const FrameSettings& settings) {
  DryScene dry = dry_scene(settings, nullptr);
  std::size_t far_away = 0;
  const std::optional<Particles> kept = kept_of(all, settings, settings.surface, far_away, nullptr);
  const WaterSurface water = water_surface(kept ? *kept : all, settings, settings.surface, dry.bodies, {}, nullptr);
  settings.rain->advance(settings.time, dry.bodies, water.surface.get());
}

Antialias antialias_of(std::string_view name) {
  if (name == "off") return Antialias::off;
  if (name == "edges") return Antialias::edges;
  if (name == "2x2") return Antialias::full;
  throw Error(ErrorCode::invalid_argument,
              {"there is no such antialiasing", "off, edges or 2x2", std::string(name), {}, {}, {}, {}});
}

std::vector<Surfel> surfels_of(const Particles& particles, const FrameSettings& settings, StageTimes* times) {
  return extract_surfels(particles, surfel_options(settings, settings.surface), times);
}

FramePicture render_frame(const Particles& all, const FrameSettings& asked) {
  // A look at the buffers needs no light.
  std::optional<FrameSettings> plain;
  if (asked.show != Show::water) {
    plain = asked;
    plain->shadow = plain->caustics = false;
    plain->optics.refraction = RefractionMethod::thickness;
  }
  const FrameSettings& settings = plain ? *plain : asked;
  FramePicture frame;
  StageTimes* times = &frame.times;
  const bool full = settings.antialias == Antialias::full;
  const View view = full ? settings.view.resized(2 * settings.view.width, 2 * settings.view.height) : settings.view;
  RaycastOptions surface_options = settings.surface;
  if (full) surface_options.filter_radius *= 2;  // the same width in the picture

  const std::optional<Particles> kept = kept_of(all, settings, surface_options, frame.far_away, times);
  const Particles& particles = kept ? *kept : all;
  frame.particles = particles.size();

  // Each particle's colour, if they have any.
  std::vector<vec3> colours;
  if (settings.colour && !particles.empty()) {
    const StageTimer timer(times, "colours");
    colours = particle_colours(particles, *settings.colour, frame.colour_range);
  }

  // The surface, and what of it is seen.
  DryScene dry = dry_scene(settings, times);
  Scene& scene = dry.scene;
  WaterSurface water = water_surface(particles, settings, surface_options, dry.bodies, colours, times);
  // Puddles throw no caustics. Surfaces that rain is added to keep what they are made of, unless it is no water.
  const Surface* deep = water.surface->bounds().empty() ? nullptr : water.surface.get();
  if (settings.rain) rain_on(settings, dry, water.surface, times);
  const Surface* surface = water.surface.get();
  frame.buffers = surface->see(view, {}, times);

  // Light.
  if (deep) light(scene, *deep, settings, times);
  OpticsInputs optics{settings.optics, nullptr, surface, nullptr};
  if (!surface->can_march() && optics.options.refraction == RefractionMethod::ray_traced)
    optics.options.refraction = RefractionMethod::thickness;
  std::shared_ptr<const VirtualEyes> eyes;
  if (settings.optics.refraction == RefractionMethod::virtual_eye) {
    if (surface->bounds().empty() || !settings.material.transparent) {
      optics.options.refraction = RefractionMethod::thickness;  // nothing is refracted
    } else {
      eyes = make_virtual_eyes(view, water.columns(), scene, water.objects, settings.material, settings.optics.eyes,
                               times);
      optics.eyes = eyes.get();
    }
  }
  std::optional<SceneBuffers> behind;
  const bool edges_of_solids = settings.antialias == Antialias::edges && !scene.solid_bounds().empty();
  if (settings.optics.refraction == RefractionMethod::image_space || edges_of_solids) {
    behind = scene.see(view, {}, times);
    optics.behind = &*behind;
  }
  frame.radiance = shade(view, {}, frame.buffers, scene, settings.material, optics, times);

  // Outlines.
  if (settings.antialias == Antialias::edges) {
    const StageTimer timer(times, "antialias");
    const std::vector<std::uint32_t> pixels = with_wide_pixels(
        silhouette_pixels(view, frame.buffers, scene, surface_options.spacing, edges_of_solids ? &*behind : nullptr),
        *surface, view, frame.buffers);
    refine_pixels(*surface, view, scene, settings.material, optics, pixels, frame.buffers, frame.radiance,
                  water.in_slabs ? std::max(kPixelsAtOnce, frame.radiance.size() / 16) : kPixelsAtOnce);
  }
  if (!settings.foam.empty() && settings.show == Show::water)
    draw_foam_over(settings, view, scene, frame.buffers, behind ? &*behind : nullptr, frame.radiance, times);
  if (settings.rain && settings.show == Show::water)
    draw_rain_over(settings, view, scene, frame.buffers, behind ? &*behind : nullptr, frame.radiance, times);
  if (full) {
    const StageTimer timer(times, "antialias");
    frame.radiance = downsampled(frame.radiance, 2);
    frame.buffers = halved(frame.buffers);
  }

  // The picture.
  const StageTimer timer(times, "develop");
  if (settings.show != Show::water) frame.radiance = shown(settings.show, settings.view, frame.buffers);
  frame.picture =
      developed(frame.radiance, settings.show == Show::water ? settings.tone : ToneOptions{0, ToneCurve::linear});
  // A bar explains colours of a map: not those that particles bring along, nor those of a buffer.
  const Attribute* attribute = settings.colour ? all.find(settings.colour->attribute) : nullptr;
  const bool own_colours = attribute && attribute->components == 3 &&
                           (attribute->name == "color" || attribute->name == "colour" || attribute->name == "Cd");
  if (settings.legend && !colours.empty() && !own_colours && settings.show == Show::water)
    draw_colour_bar(frame, *settings.colour);
  return frame;
}

}  // namespace meniscus
