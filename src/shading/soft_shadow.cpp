#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "meniscus/formulas/optics.h"
#include "meniscus/shading.h"
#include "shading/light_map.h"

namespace meniscus {
namespace {

/// Texels along the longer edge, and the part of it that is left free around the water for the blur.
constexpr int kTexels = 400;
constexpr int kSkyTexels = 128;  ///< where only the sky's light is asked for
constexpr float kMargin = 0.16f;
/// Standard deviations of the blurs, as parts of the longer edge of the water: the slopes that bend light, the sun's
/// penumbra, the shadow in the sky's light.
constexpr float kSlopeBlur = 0.008f;
constexpr float kPenumbra = 0.0045f;
constexpr float kSkyBlur = 0.045f;
/// Part of a texel, down from the waterline, over which the light above the water becomes that under it.
constexpr float kSoftLine = 0.25f;
/// Light is bent by no more than arriving along the surface: tan(90 deg - 48.6 deg).
constexpr float kLargestBend = 0.88f;
/// Real focal points are brighter than this; the slopes of a particle surface are not true enough to draw them.
constexpr float kBrightest = 4.0f;
/// The part of the sky's light that a dark body on the ground takes away under it.
constexpr float kMostSkyTaken = 0.8f;

/// Orthographic view along the sun's rays that holds the water.
View view_from_sun(const Bounds& bounds, vec3 sun, vec3 up, int texels, float& extent) {
  const float radius = std::max(0.5f * glm::length(bounds.extent()), 1e-6f);
  View view = orthographic_view(bounds.centre() + 2.0f * radius * sun, bounds.centre(), up, 1.0f, 1, 1);
  vec2 half{1e-6f};
  for (int corner = 0; corner < 8; ++corner) {
    const vec3 point{corner & 1 ? bounds.high.x : bounds.low.x, corner & 2 ? bounds.high.y : bounds.low.y,
                     corner & 4 ? bounds.high.z : bounds.low.z};
    const vec3 offset = point - bounds.centre();
    half = glm::max(half, glm::abs(vec2{glm::dot(offset, view.right), glm::dot(offset, view.up)}));
  }
  extent = 2.0f * std::max(half.x, half.y);
  half += vec2{kMargin * extent};
  const float texel = 2.0f * std::max(half.x, half.y) / static_cast<float>(texels);
  view.width = std::max(8, static_cast<int>(std::ceil(2.0f * half.x / texel)));
  view.height = std::max(8, static_cast<int>(std::ceil(2.0f * half.y / texel)));
  view.half_height = 0.5f * texel * static_cast<float>(view.height);
  return view;
}

/// Adds `light` at a place between texels.
void deposit(Image<vec3>& image, float x, float y, vec3 light) {
  x = std::clamp(x, 0.0f, static_cast<float>(image.width() - 1) - 1e-3f);
  y = std::clamp(y, 0.0f, static_cast<float>(image.height() - 1) - 1e-3f);
  const int i = static_cast<int>(x), j = static_cast<int>(y);
  const float s = x - static_cast<float>(i), t = y - static_cast<float>(j);
  image(i, j) += (1.0f - s) * (1.0f - t) * light;
  image(i + 1, j) += s * (1.0f - t) * light;
  image(i, j + 1) += (1.0f - s) * t * light;
  image(i + 1, j + 1) += s * t * light;
}

/// Sends every texel's light to where the slopes of the water bend it.
/// @param smooth  thickness that the slopes are taken from, m; texel: edge, m
Image<vec3> gathered(const Image<vec3>& arriving, const Image<float>& smooth, float texel, float ior) {
  Image<vec3> result(arriving.width(), arriving.height());
  for (int y = 0; y < arriving.height(); ++y)
    for (int x = 0; x < arriving.width(); ++x) {
      const int left = std::max(x - 1, 0), right = std::min(x + 1, arriving.width() - 1);
      const int above = std::max(y - 1, 0), below = std::min(y + 1, arriving.height() - 1);
      vec2 bend{(smooth(right, y) - smooth(left, y)) / (texel * static_cast<float>(right - left)),
                (smooth(x, below) - smooth(x, above)) / (texel * static_cast<float>(below - above))};
      // Small slopes turn light by (1 - 1 / n) of their angle towards the thick side, over the water's depth.
      bend *= 1.0f - 1.0f / ior;
      bend *= smooth(x, y) / texel / std::sqrt(1.0f + glm::dot(bend, bend) / (kLargestBend * kLargestBend));
      deposit(result, static_cast<float>(x) + bend.x, static_cast<float>(y) + bend.y, arriving(x, y));
    }
  return result;
}

/// The greatest of the values within `reach` of each.
Image<float> greatest(Image<float> image, int reach) {
  // Of a row's neighbours, then of a column's.
  for (const bool rows : {true, false}) {
    const Image<float> before = image;
    parallel_for(static_cast<std::size_t>(image.height()), 16, [&](std::size_t begin, std::size_t end) {
      for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
        for (int x = 0; x < image.width(); ++x)
          for (int k = -reach; k <= reach; ++k) {
            const int u = std::clamp(rows ? x + k : x, 0, image.width() - 1);
            const int v = std::clamp(rows ? y : y + k, 0, image.height() - 1);
            image(x, y) = std::max(image(x, y), before(u, v));
          }
    });
  }
  return image;
}

/// Height of the water along `up` that each texel sees, m; beside it, of the highest water within `reach`, and of all
/// of it farther off. Heights, not depths along the view: level water that the view sees aslant has one height, which
/// its texels need not be fine to tell.
Image<float> levels(const Surface& surface, const View& view, vec3 up, int reach) {
  const Image<float> depth = surface.see(view).depth;
  const float falls = glm::dot(view.forward, up);
  constexpr float kNone = -std::numeric_limits<float>::infinity();
  Image<float> level(view.width, view.height, kNone);
  float highest = kNone;
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x) {
      if (!(depth(x, y) < 1e30f)) continue;
      const vec3 origin = view.ray({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f}).origin;
      level(x, y) = glm::dot(origin, up) + depth(x, y) * falls;
      highest = std::max(highest, level(x, y));
    }
  if (!(highest > kNone)) return {};
  const Image<float> near = greatest(level, 1), beside = greatest(level, reach);
  for (std::size_t i = 0; i < level.size(); ++i) {
    if (level[i] > kNone) continue;
    level[i] = near[i] > kNone ? near[i] : beside[i] > kNone ? beside[i] : highest;
  }
  return level;
}

/// No water: all light everywhere.
class Unshadowed : public WaterLight {
 public:
  Light at(vec3, vec3) const override { return {}; }
};

/// @param sun_too    false: the sky's part alone
/// @param on_bodies  leave what stands out of the water in full light
std::shared_ptr<const WaterLight> shadow(const Surface& surface, const Environment& environment, const Ground& ground,
                                         const Material& material, const Bounds& region, bool sun_too, bool on_bodies) {
  Bounds bounds = surface.bounds();
  if (!region.empty() && !bounds.empty()) {
    const Bounds common{glm::max(bounds.low, region.low), glm::min(bounds.high, region.high)};
    if (!common.empty()) bounds = common;
  }
  if (bounds.empty()) return std::make_shared<Unshadowed>();

  // A sun below or at the horizon throws no shadow that could be drawn; what is left is the sky's, from above.
  vec3 sun = environment.sun_direction();
  const bool sun_shines = glm::dot(sun, ground.up) > 0.05f;
  if (!sun_shines) sun = ground.up;
  float extent = 0;
  const View view = view_from_sun(bounds, sun, ground.up, sun_too ? kTexels : kSkyTexels, extent);
  const float texel = view.pixel_size(0.0f), texels = extent / texel;
  const Image<float> thickness = surface.thickness(view);

  // What passes the water, and how much of the sky it covers.
  const float through_surfaces =
      1.0f - 2.0f * std::min(0.5f, formulas::fresnel_reflectance(1.0f, material.ior) * material.specular);
  const vec3 lost = material.extinction + 0.35f * material.scattering;
  Image<vec3> sunlight(view.width, view.height, vec3{1.0f});
  Image<vec3> skylight = sunlight;
  Image<float> smooth(view.width, view.height), cover(view.width, view.height);
  for (std::size_t i = 0; i < thickness.size(); ++i) {
    const float t = thickness[i] > 0 && thickness[i] < 1e30f ? thickness[i] : 0.0f;
    smooth[i] = t;
    cover[i] = 1.0f - std::exp(-t / (0.02f * extent));
    if (!material.transparent) {
      sunlight[i] = vec3{std::exp(-t / (0.5f * texel))};
      skylight[i] = vec3{1.0f};
    } else {
      // Thin spray loses less at its surfaces than a body, of which both are seen.
      const vec3 left = formulas::beer_lambert(lost, t);
      sunlight[i] = left * glm::mix(1.0f, through_surfaces, std::min(1.0f, t / texel));
      skylight[i] = left;
    }
  }
  if (sun_too) {
    blur(smooth, std::max(1.0f, kSlopeBlur * texels));
    if (material.transparent) sunlight = gathered(sunlight, smooth, texel, material.ior);
    blur(sunlight, std::max(1.0f, kPenumbra * texels));
  }
  blur(cover, kSkyBlur * texels);
  blur(skylight, kSkyBlur * texels);

  // Out to the edge everything becomes one.
  Image<LightMap::Fractions> map(view.width, view.height);
  const float border = 0.25f * kMargin * texels;
  const float sky_taken = material.transparent ? 0.30f : kMostSkyTaken;
  for (int y = 0; y < map.height(); ++y)
    for (int x = 0; x < map.width(); ++x) {
      const int inwards = std::min(std::min(x, map.width() - 1 - x), std::min(y, map.height() - 1 - y));
      const float presence = std::clamp(static_cast<float>(inwards) / border, 0.0f, 1.0f);
      const vec3 sun_part =
          sun_shines && sun_too ? glm::clamp(sunlight(x, y), vec3{0.0f}, vec3{kBrightest}) : vec3{1.0f};
      // Sky light comes from all around: even beside black ink most of it arrives, and some under it.
      const vec3 held_back = glm::mix(vec3{kMostSkyTaken}, vec3{sky_taken}, skylight(x, y));
      const vec3 sky_part = glm::clamp(1.0f - held_back * cover(x, y), vec3{0.0f}, vec3{1.0f});
      map(x, y) = {glm::mix(vec3{1.0f}, sun_part, presence), glm::mix(vec3{1.0f}, sky_part, presence)};
    }
  Image<float> level;
  if (on_bodies) level = levels(surface, view, ground.up, std::max(2, static_cast<int>(3.0f * kSkyBlur * texels)));
  return std::make_shared<LightMap>(view, std::move(map), ground.up, std::move(level), kSoftLine * texel);
}

}  // namespace

std::shared_ptr<const WaterLight> soft_shadow(const Surface& surface, const Environment& environment,
                                              const Ground& ground, const Material& material, StageTimes* times,
                                              const Bounds& region, bool on_bodies) {
  const StageTimer timer(times, "shadow");
  return shadow(surface, environment, ground, material, region, true, on_bodies);
}

std::shared_ptr<const WaterLight> sky_shadow(const Surface& surface, const Environment& environment,
                                             const Ground& ground, const Material& material, const Bounds& region,
                                             bool on_bodies) {
  return shadow(surface, environment, ground, material, region, false, on_bodies);
}

}  // namespace meniscus
