#include "render/rain_settings.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "base/field_axes.h"
#include "render/guessed.h"

namespace meniscus {
namespace {

constexpr float kAround = 2;        ///< m that it rains beyond what is there
constexpr float kBeforeCamera = 6;  ///< m around the eye where drops are seen
constexpr float kLandscape = 60;    ///< m: bodies larger than this are rained on only near water and eye
constexpr float kMostAcross = 200;  ///< m, of a region that nobody has said
constexpr float kAbove = 3;         ///< m above everything from where drops are followed
constexpr std::size_t kOrbitEyes = 256;
constexpr float kBelow = 0.01f;  ///< m under the lowest that they end

/// Where the camera goes.
Bounds eyes_of(const Survey& survey, const PictureOptions& options) {
  Bounds eyes;
  if (options.path)
    for (const CameraKey& key : options.path->keys()) eyes.add(key.eye);
  else if (options.camera.orbit_deg == 0)
    eyes.add(view_of(survey, options, 0, 1, 25).eye);
  return eyes;
}

/// Where it is at a time, s of the film. Pictures come at the rate of the rain's own frames where nothing else is
/// known.
std::function<vec3(double)> eye_over_time(const Survey& survey, const PictureOptions& options) {
  const double frames_per_second = options.rain->frames_per_second;
  if (options.path)
    return [path = *options.path, frames_per_second](double time) {
      return path.at(path.in_seconds() ? time : time * frames_per_second).eye;
    };
  const vec3 eye = view_of(survey, options, 0, 1, frames_per_second).eye;
  if (options.camera.orbit_deg == 0) return [eye](double) { return eye; };
  // Once round in as many pictures, by a finer orbit between which the eye goes straight.
  std::vector<vec3> orbit;
  for (std::size_t i = 0; i <= kOrbitEyes; ++i)
    orbit.push_back(view_of(survey, options, i, kOrbitEyes, frames_per_second).eye);
  const double seconds = static_cast<double>(options.rain->frames) / frames_per_second;
  return [orbit = std::move(orbit), seconds](double time) {
    const double place = std::clamp(time / seconds, 0.0, 1.0) * static_cast<double>(kOrbitEyes);
    const std::size_t i = std::min(static_cast<std::size_t>(place), kOrbitEyes - 1);
    return glm::mix(orbit[i], orbit[i + 1], static_cast<float>(place - static_cast<double>(i)));
  };
}

/// The name's body alone, where it stands in the first frame.
std::optional<Scene> scene_of_body(const Survey& survey, const PictureOptions& options) {
  const std::string& name = options.rain->ground.mesh;
  if (name.empty()) return std::nullopt;
  const auto body = std::find_if(options.bodies.begin(), options.bodies.end(),
                                 [&](const BodyOptions& other) { return other.name == name; });
  if (body == options.bodies.end())
    throw Error(ErrorCode::not_found, {"the rain's ground is a body that is not there",
                                       "a mesh of this name",
                                       name,
                                       {},
                                       {},
                                       {},
                                       "give one of the meshes this name"});
  BodyOptions alone = *body;
  alone.absent.clear();
  Ground nothing;
  nothing.visible = false;
  nothing.up = direction_of(survey.up.axis);
  Scene scene(Environment{EnvironmentOptions{}}, nothing);
  std::vector<std::string> notes;
  scene.set_solids(Bodies({alone}).at(0, 0, notes));
  return scene;
}

RainSettings rain_over(const Survey& survey, const PictureOptions& options, const Scene* body) {
  RainSettings settings = *options.rain;
  const Axis up = survey.up.axis;
  const FieldAxes axes(up);
  settings.rain.up = settings.ground.cells.up = settings.ripples.up = up;
  settings.splashes.up = direction_of(up);
  settings.splashes.gravity = -9.81f * direction_of(up);
  settings.splashes.seed = settings.rain.seed;
  settings.rain.wind.seed = settings.rain.seed;
  settings.ground.look.seed = settings.ground.cells.seed;
  if (settings.water.empty() && survey.most_particles + (options.heights ? 1 : 0) > 0)
    settings.water = survey.bounds.grown(0.02f * longest_of(survey.bounds.extent()));
  GroundOptions& cells = settings.ground.cells;
  if (settings.ground.there && cells.low == cells.high) {
    const Bounds from = body ? body->solid_bounds() : survey.bounds;
    if (from.empty())
      throw Error(ErrorCode::invalid_argument,
                  {"it is not known where the rain's ground is", "two corners, low and high", "none", {}, {}, {}, {}});
    cells.low = {from.low[axes.a], from.low[axes.b]};
    cells.high = {from.high[axes.a], from.high[axes.b]};
  }
  // Where it rains: over water, bodies, cells and around the eye.
  Bounds region = settings.water;
  const Bounds& bodies = options.bodies_bounds;
  if (!bodies.empty() && longest_of(bodies.extent()) < kLandscape) region.add(bodies);
  if (options.tank_inside && options.tank != TankStyle::none) region.add(*options.tank_inside);
  region = region.grown(kAround);
  if (settings.ground.there) {
    region.add(axes.place(cells.low.x, cells.low.y, cells.level));
    region.add(axes.place(cells.high.x, cells.high.y, cells.level));
  }
  const Bounds eyes = eyes_of(survey, options);
  Bounds with_eyes = region;
  with_eyes.add(eyes.grown(std::min(kBeforeCamera, settings.streak_reach)));
  if (region.empty() || longest_of(with_eyes.extent()) < kMostAcross) region = with_eyes;
  RainOptions& rain = settings.rain;
  if (rain.low == rain.high) {
    const vec3 middle = region.centre(), half = glm::min(0.5f * region.extent(), vec3(0.5f * kMostAcross));
    rain.low = {middle[axes.a] - half[axes.a], middle[axes.b] - half[axes.b]};
    rain.high = {middle[axes.a] + half[axes.a], middle[axes.b] + half[axes.b]};
  }
  // All drops near the eye; where a share is asked for, the same everywhere.
  if (rain.share == 0 && rain.whole_within > 0) rain.eye = eye_over_time(survey, options);
  // From above everything down to the ground.
  float highest = ground_height(survey, options);
  for (const Bounds& box : {settings.water, bodies, eyes})
    if (!box.empty()) highest = std::max(highest, box.high[axes.up]);
  rain.level = ground_height(survey, options) - kBelow;
  rain.top = std::max(rain.top, highest + kAbove - rain.level);
  return settings;
}

}  // namespace

bool has_rain_ground(const PictureOptions& options) { return options.rain && options.rain->ground.there; }

RainSettings rain_over(const Survey& survey, const PictureOptions& options) {
  const std::optional<Scene> body = scene_of_body(survey, options);
  return rain_over(survey, options, body ? &*body : nullptr);
}

std::shared_ptr<RainyScene> rain_of(const Survey& survey, const PictureOptions& options) {
  if (!options.rain) return nullptr;
  const std::optional<Scene> body = scene_of_body(survey, options);
  return std::make_shared<RainyScene>(rain_over(survey, options, body ? &*body : nullptr), body ? &*body : nullptr);
}

float plane_under(const RainyScene& rain) {
  const std::shared_ptr<const Solid> relief = rain.relief();
  return relief->bounds().low[static_cast<int>(rain.settings().rain.up)];
}

}  // namespace meniscus
