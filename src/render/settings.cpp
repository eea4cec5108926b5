#include <algorithm>
#include <cmath>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>

#include "meniscus/render.h"
#include "render/guessed.h"
#include "render/rain_settings.h"

namespace meniscus {
namespace {

/// 1, 2 or 5 times a power of ten, the nearest on a logarithmic scale.
float round_length(float length) {
  const float power = std::pow(10.0f, std::floor(std::log10(length)));
  const float mantissa = length / power;
  return power * (mantissa < 1.42f ? 1.0f : mantissa < 3.17f ? 2.0f : mantissa < 7.08f ? 5.0f : 10.0f);
}

Material material_of(const Survey& survey, const PictureOptions& options) {
  const float scale = depth_scale(survey, options);
  Material material = material_preset(material_name(options), scale);
  if (options.tint) {
    const vec3 tint = *options.tint;
    if (!(std::min({tint.x, tint.y, tint.z}) > 0 && longest_of(tint) <= 1))
      throw Error(ErrorCode::invalid_argument, "a tint needs three numbers above 0 and up to 1");
    material.extinction = -glm::log(tint) / scale;
  }
  if (options.ior) material.ior = *options.ior;
  if (options.roughness) material.roughness = *options.roughness;
  if (options.extinction) {
    const vec3 extinction = *options.extinction;
    if (!(std::min({extinction.x, extinction.y, extinction.z}) >= 0 && std::isfinite(longest_of(extinction))))
      throw Error(ErrorCode::invalid_argument, "an extinction needs three numbers from 0 up, in 1/m");
    material.extinction = extinction;
  }
  return material;
}

/// Fitted around the water of all frames, open above it.
Tank tank_of(const Survey& survey, const PictureOptions& options) {
  Tank tank;
  tank.style = options.tank;
  tank.up = direction_of(survey.up.axis);
  if (options.tank_albedo) tank.albedo = *options.tank_albedo;
  tank.inside = options.tank_inside.value_or(survey.bounds.grown(0.5f * spacing_of(survey, options)));
  if (tank.inside.empty()) tank.style = TankStyle::none;
  if (!options.tank_inside && tank.style != TankStyle::none) {
    // It stands on the ground, and its rim is above the highest drop.
    const vec3 across = vec3{1.0f} - tank.up;
    tank.inside.low = tank.inside.low * across + tank.up * ground_height(survey, options);
    tank.inside.high += tank.up * (0.05f * longest_of(tank.inside.extent()));
  }
  return tank;
}

/// Tank and bodies.
Bounds solids_bounds(const Survey& survey, const PictureOptions& options) {
  Bounds solids = options.bodies_bounds;
  const Tank tank = tank_of(survey, options);
  if (tank.style != TankStyle::none) solids.add(tank.inside);
  return solids;
}

Ground ground_of(const Survey& survey, const PictureOptions& options) {
  Ground ground;
  const vec3 up = direction_of(survey.up.axis);
  const vec3 centre = survey.bounds.centre();
  const vec3 extent = survey.bounds.extent();
  const float across = longest_of(extent - up * glm::dot(extent, up));
  const float solids = longest_of(solids_bounds(survey, options).extent());
  const float size = std::max({across, longest_of(extent) * 0.25f, 4 * spacing_of(survey, options)});
  ground.visible = options.ground != GroundStyle::none;
  ground.up = up;
  ground.height = ground_height(survey, options);
  if (options.ground_albedo) {
    ground.albedo = *options.ground_albedo;
    ground.second_albedo = 0.7f * ground.albedo;
  }
  const bool plain = options.ground != GroundStyle::chequer || has_rain_ground(options);
  ground.square = plain ? 0.0f : round_length(size / 8);
  ground.centre = centre + up * (ground.height - glm::dot(centre, up));
  ground.fade_radius = 12 * std::max(size, solids);
  return ground;
}

}  // namespace

std::string material_name(const PictureOptions& options) {
  if (!options.material.empty()) return options.material;
  return options.colour || options.method == SurfaceMethod::spheres ? "plastic" : "water";
}

float spacing_of(const Survey& survey, const PictureOptions& options) {
  if (options.surface.spacing > 0) return options.surface.spacing;
  return survey.spacing.spacing > 0 ? survey.spacing.spacing : 1.0f;  // no particles: nothing is drawn by it
}

float depth_scale(const Survey& survey, const PictureOptions& options) {
  const vec3 extent = survey.bounds.extent();
  return std::max(std::min({extent.x, extent.y, extent.z}), 10 * spacing_of(survey, options));
}

float ground_height(const Survey& survey, const PictureOptions& options) {
  if (options.ground_height) return *options.ground_height;
  if (options.tank != TankStyle::none && options.tank_inside)  // it stands on the ground
    return glm::dot(options.tank_inside->low, direction_of(survey.up.axis));
  if (survey.bounds.empty()) return 0;
  const float lowest = glm::dot(survey.bounds.low, direction_of(survey.up.axis));
  // A few drops stand on no floor: the ground touches them from below.
  const float above = survey.most_particles < kFewParticles ? -0.65f : 0.25f;
  return lowest + above * spacing_of(survey, options);
}

vec2 sun_deg(const Survey& survey, const PictureOptions& options) {
  if (options.sun_deg) return *options.sun_deg;
  const float camera = options.camera.azimuth_deg.value_or(default_azimuth_deg(survey.bounds, survey.up.axis));
  return {camera + 110.0f, 42.0f};
}

SurfaceMethod surface_method_of(std::string_view name) {
  if (name == "raycast") return SurfaceMethod::raycast;
  if (name == "surfels") return SurfaceMethod::surfels;
  if (name == "height_field") return SurfaceMethod::height_field;
  if (name == "spheres") return SurfaceMethod::spheres;
  throw Error(
      ErrorCode::invalid_argument,
      {"there is no such surface", "raycast, surfels, height_field or spheres", std::string(name), {}, {}, {}, {}});
}

GroundStyle ground_style_of(std::string_view name) {
  if (name == "chequer") return GroundStyle::chequer;
  if (name == "plain") return GroundStyle::plain;
  if (name == "none") return GroundStyle::none;
  throw Error(ErrorCode::invalid_argument,
              {"there is no such ground", "chequer, plain or none", std::string(name), {}, {}, {}, {}});
}

FrameSettings settings_of(const Survey& survey, const PictureOptions& options) {
  FrameSettings settings;
  settings.view = view_of(survey, options, 0, 1, 25);
  settings.method = options.method;
  settings.show = options.show;
  settings.surface = options.surface;
  settings.surface.spacing = spacing_of(survey, options);
  if (!(settings.surface.smoothing_length > 0)) settings.surface.smoothing_length = 2 * settings.surface.spacing;
  settings.sizes = options.sizes;
  settings.colour = options.colour;
  if (settings.colour && !settings.colour->range) settings.colour->range = survey.colour_range;
  settings.material = material_of(survey, options);
  EnvironmentOptions environment;
  environment.hdr_path = options.environment_hdr;
  environment.up = direction_of(survey.up.axis);
  const vec2 sun = sun_deg(survey, options);
  environment.sun_direction = direction_towards(survey.up.axis, sun.x, sun.y);
  environment.sun_radiance_scale = options.sun_scale;
  environment.cloud_cover = options.cloud_cover.value_or(options.rain ? 1.0f : 0.0f);
  environment.radiance_scale = options.sky_scale;
  settings.environment = Environment(environment);
  settings.ground = ground_of(survey, options);
  settings.tank = tank_of(survey, options);
  settings.lamps = options.lamps;
  settings.optics = options.optics;
  settings.caustics = options.caustics;
  settings.caustics_options = options.caustics_options;
  settings.surfels = options.surfels;
  settings.height_field = options.height_field;
  settings.height_field.up = survey.up.axis;
  settings.water = survey.bounds.grown(2 * settings.surface.spacing);
  settings.shadow = options.shadow;
  settings.tone = options.tone;
  settings.antialias = options.antialias;
  settings.legend = options.legend;
  settings.drop_isolated = options.drop_isolated;
  settings.foam_look = options.foam.look;
  settings.rain = rain_of(survey, options);
  if (has_rain_ground(options)) {
    const float plane = plane_under(*settings.rain);
    settings.ground.height = options.ground_height ? std::min(*options.ground_height, plane) : plane;
  }
  return settings;
}

View view_of(const Survey& survey, const PictureOptions& options, std::size_t index, std::size_t count,
             double frames_per_second) {
  if (options.path) {
    const double place = static_cast<double>(index) / (options.path->in_seconds() ? frames_per_second : 1.0);
    const CameraKey key = options.path->at(place);
    return perspective_view(key.eye, key.target, direction_of(survey.up.axis), key.fov_deg * 3.14159265f / 180,
                            options.width, options.height);
  }
  // A particle reaches about its spacing beyond its centre.
  Bounds seen = survey.bounds.grown(spacing_of(survey, options));
  // Tank and bodies, unless they are a landscape that the water is only a part of.
  const Bounds solids = solids_bounds(survey, options);
  if (!solids.empty() && (seen.empty() || longest_of(solids.extent()) < 4 * longest_of(seen.extent())))
    seen.add(solids);
  const float turned =
      options.camera.orbit_deg * static_cast<float>(index) / static_cast<float>(std::max<std::size_t>(count, 1));
  return fitted_view(seen, survey.up.axis, options.camera, turned, options.width, options.height);
}

}  // namespace meniscus
