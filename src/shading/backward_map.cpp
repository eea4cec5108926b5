#include "shading/backward_map.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "meniscus/formulas/optics.h"
#include "shading/caustics_cells.h"
#include "shading/light_map.h"

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Part of the field's longer side that the map reaches beyond the field at most, for light that waves send there.
constexpr float kMostMargin = 0.1f;
/// Standard deviation of the sun's disc, rad, as in caustics_cast.cpp.
constexpr float kSunSpread = 0.00236f;
/// Variance of the spline that samples are gathered with, texels^2.
constexpr float kSplineVariance = 0.25f;
/// Light that goes down less steeply than this is left out: sine of its angle.
constexpr float kFlattest = 0.05f;

}  // namespace

PlaneMap backward_map(const HeightField& field, const WaterLevel& level, const EnteringLight& light,
                      const Image<float>& lit, float plane, int size) {
  const FieldFrame& frame = level.frame();
  PlaneMap map;
  const float texel = frame.longer_side() / static_cast<float>(size);
  if (!level.any() || !(texel > 0)) return map;
  const float still = std::max(level.mean() - plane, 0.0f);

  // Where the light of each point of the field meets the plane, less what still water would move it by.
  Image<LightPoint> points(frame.width, frame.height);
  std::vector<float> farthest(static_cast<std::size_t>(frame.height), 0.0f);
  parallel_for(static_cast<std::size_t>(frame.height), 8, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
      for (int x = 0; x < frame.width; ++x) {
        const vec2 place = frame.place(x, y);
        LightPoint& point = points(x, y);
        point.at = place;
        const float height = field.height(x, y);
        if (!(height > -kInfinity)) continue;
        point.flux = 0;
        const vec3 normal = field.normal(x, y);
        const float cosine = glm::dot(normal, light.sun);
        if (!(cosine > 0 && normal[frame.up] > 0.01f)) continue;
        const formulas::Interface interface = formulas::fresnel(cosine, light.ior);
        const vec3 bent = formulas::refracted(-light.sun, normal, light.ior, interface.cos_t);
        if (!(-bent[frame.up] > kFlattest)) continue;
        const float transmittance = 1.0f - std::min(1.0f, interface.reflectance * light.specular);
        point.flux = transmittance * cosine / (normal[frame.up] * light.cos_sun);
        if (!lit.empty()) point.flux *= lit(x, y);
        const float down = std::max(height - plane, 0.0f) / -bent[frame.up];
        const vec2 moved = frame.across(bent) * down - light.bent_slide * still;
        point.at += moved;
        float& far = farthest[static_cast<std::size_t>(y)];
        far = std::max({far, std::abs(moved.x), std::abs(moved.y)});
      }
  });
  const float far = *std::max_element(farthest.begin(), farthest.end());
  const int margin = 2 + static_cast<int>(std::ceil(std::min(far, kMostMargin * frame.longer_side()) / texel));
  const vec2 extent = frame.high() - frame.low;
  const int width = static_cast<int>(std::ceil(extent.x / texel - 1e-3f)) + 2 * margin;
  const int height = static_cast<int>(std::ceil(extent.y / texel - 1e-3f)) + 2 * margin;
  map.texel = vec2{texel};
  map.low = frame.low + (0.5f - static_cast<float>(margin)) * texel;
  map.value = Image<float>(width, height, 0.0f);
  for (LightPoint& point : points) point.at = (point.at - map.low) / texel;
  gather_cells(points, frame.step.x * frame.step.y / (texel * texel), vec2{-kInfinity}, vec2{kInfinity}, map.value);

  // The sun's disc, over the way in still water, as far as the spline has not blurred already.
  const float disc = kSunSpread / light.ior * still / (light.cos_bent * light.cos_bent) / texel;
  if (disc * disc > kSplineVariance) blur_finely(map.value, std::sqrt(disc * disc - kSplineVariance));
  return map;
}

}  // namespace meniscus
