#include "render/rainy_frame.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "base/field_axes.h"
#include "render/solid_depths.h"

namespace meniscus {
namespace {

constexpr float kAboveGround = 1;  ///< m, where splashes see their surroundings from
constexpr float kAhead = 4;        ///< m before the eye

/// What the sky shows a little above the horizon: the light that distant rain scatters.
vec3 horizon(const Environment& environment, Axis up) {
  constexpr int kAround = 8;
  constexpr float kSine = 0.15f;
  const FieldAxes axes(up);
  vec3 sum{0.0f};
  for (int i = 0; i < kAround; ++i) {
    const float angle = 2 * std::numbers::pi_v<float> * static_cast<float>(i) / kAround;
    sum += environment.radiance(glm::normalize(axes.place(std::cos(angle), std::sin(angle), kSine)), 0.3f);
  }
  return sum / static_cast<float>(kAround);
}

/// Above the ground in the middle of what is seen near the eye.
vec3 middle_of(const View& view, const Ground& ground) {
  const vec3 ahead = view.eye + kAhead * view.forward;
  return ahead + ground.up * (ground.height + kAboveGround - glm::dot(ahead, ground.up));
}

/// Distances to what is nearer, water or solid.
Image<float> depths(const View& view, const Scene& scene, const SurfaceBuffers& buffers, const SceneBuffers* solids) {
  Image<float> depth = solid_depths(view, scene, solids);
  for (std::size_t i = 0; i < depth.size(); ++i)
    if (buffers.coverage[i] > 0) depth[i] = std::min(depth[i], buffers.depth[i]);
  return depth;
}

}  // namespace

void rain_on(const FrameSettings& settings, DryScene& dry, std::unique_ptr<Surface>& water, StageTimes* times) {
  RainyScene& rain = *settings.rain;
  rain.advance(settings.time, dry.bodies, water.get(), times);
  const StageTimer timer(times, "wet ground");
  dry.scene.set_ground_cover(rain.cover());
  if (HeightField rings = rain.rings(); !rings.empty())
    water = make_rippled_surface(std::move(water), std::move(rings));
  if (HeightField puddles = rain.puddles(); !puddles.empty())
    water = make_joint_surface(std::move(water), std::move(puddles));
}

void draw_rain_over(const FrameSettings& settings, const View& view, const Scene& scene, const SurfaceBuffers& buffers,
                    const SceneBuffers* solids, Image<vec3>& radiance, StageTimes* times) {
  const RainyScene& rain = *settings.rain;
  std::vector<WaterPiece> pieces;
  RainLook look = rain.settings().look;
  {
    const StageTimer timer(times, "pieces");
    if (!buffers.eye_in_water) pieces = rain.pieces(view);  // from below, the surface hides them
  }
  const RainShown shown = rain.settings().shown;
  if ((shown == RainShown::all || shown == RainShown::streaks) && !buffers.eye_in_water)
    look.haze_radiance =
        look.haze_radiance == vec3(0.0f) ? horizon(settings.environment, rain.settings().rain.up) : look.haze_radiance;
  else
    look.haze = 0;
  if (pieces.empty() && !(look.haze > 0)) return;
  const Surroundings surroundings(scene, middle_of(view, settings.ground), 64, times);
  draw_rain(view, pieces, surroundings, look, depths(view, scene, buffers, solids), radiance, times);
}

}  // namespace meniscus
