#include "shading/caustics_light.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace meniscus {
namespace {

constexpr float kLowestSun = 0.05f;  ///< sine of its height
/// Tangent of half the largest angle in which a lamp sees water, 80 degrees; what lies beyond is not cast.
constexpr float kWidest = 5.7f;

vec3 corner_of(const Bounds& box, int i) {
  return {i & 1 ? box.high.x : box.low.x, i & 2 ? box.high.y : box.low.y, i & 4 ? box.high.z : box.low.z};
}

/// Height along `up` of the box's uppermost corner.
float top_of(const Bounds& box, vec3 up) {
  return glm::dot(box.centre(), up) + 0.5f * glm::dot(box.extent(), glm::abs(up));
}

float brightness(vec3 v) { return v.x + v.y + v.z; }

/// Sizes of a picture whose half extents at scale 1 are `half`, and its half height.
void fit(View& view, vec2 half, int size, int border) {
  const int inner = std::max(2, size - 2 * border);
  const float pixel = 2.0f * std::max({half.x, half.y, 1e-9f}) / static_cast<float>(inner);
  const auto pixels = [&](float h) { return std::max(2, static_cast<int>(std::ceil(2.0f * h / pixel - 1e-3f))); };
  view.width = std::min(inner, pixels(half.x)) + 2 * border;
  view.height = std::min(inner, pixels(half.y)) + 2 * border;
  view.half_height = 0.5f * pixel * static_cast<float>(view.height);
}

}  // namespace

vec3 LightSource::towards(vec3 point) const { return sun ? direction : glm::normalize(position - point); }

vec3 LightSource::irradiance(vec3 point) const {
  if (sun) return strength;
  const vec3 offset = position - point;
  return strength / std::max(glm::dot(offset, offset), 1e-12f);
}

std::vector<LightSource> caustics_lights(const Scene& scene, const Bounds& box, int most) {
  std::vector<LightSource> lights;
  const Environment& environment = scene.environment();
  const vec3 up = scene.ground().up;
  if (glm::dot(environment.sun_direction(), up) > kLowestSun && brightness(environment.sun_irradiance()) > 0)
    lights.push_back({true, environment.sun_direction(), vec3{0.0f}, environment.sun_irradiance()});
  const float top = top_of(box, up), size = std::max({box.extent().x, box.extent().y, box.extent().z});
  for (const PointLight& lamp : scene.lamps())
    if (brightness(lamp.intensity) > 0 && glm::dot(lamp.position, up) > top + 1e-3f * size)
      lights.push_back({false, up, lamp.position, lamp.intensity});
  std::stable_sort(lights.begin(), lights.end(), [&](const LightSource& a, const LightSource& b) {
    return brightness(a.irradiance(box.centre())) > brightness(b.irradiance(box.centre()));
  });
  if (lights.size() > static_cast<std::size_t>(std::max(most, 0))) lights.resize(static_cast<std::size_t>(most));
  return lights;
}

View view_along(vec3 forward, const Bounds& box, vec3 up, int size, float margin) {
  const float radius = std::max(0.5f * glm::length(box.extent()), 1e-6f);
  View view = orthographic_view(box.centre() - 2.0f * radius * forward, box.centre(), up, 1.0f, 1, 1);
  vec2 half{1e-9f};
  for (int i = 0; i < 8; ++i) {
    const vec3 offset = corner_of(box, i) - box.centre();
    half = glm::max(half, glm::abs(vec2{glm::dot(offset, view.right), glm::dot(offset, view.up)}));
  }
  half += vec2{margin * 2.0f * std::max(half.x, half.y)};
  fit(view, half, size, 0);
  return view;
}

View view_from_light(const LightSource& light, const Bounds& box, vec3 up, int size, int border) {
  if (light.sun) {
    View view = view_along(-light.direction, box, up, 64, 0.0f);
    vec2 half{1e-9f};
    for (int i = 0; i < 8; ++i) {
      const vec3 offset = corner_of(box, i) - box.centre();
      half = glm::max(half, glm::abs(vec2{glm::dot(offset, view.right), glm::dot(offset, view.up)}));
    }
    fit(view, half, size, border);
    return view;
  }
  // The axis goes to where the rays through the corners have their mean, so that a box beside the lamp is held too.
  vec3 mean{0.0f};
  for (int i = 0; i < 8; ++i) mean += glm::normalize(corner_of(box, i) - light.position);
  if (!(glm::length(mean) > 1e-3f)) mean = -up;
  View view = perspective_view(light.position, light.position + glm::normalize(mean), up, 1.0f, 1, 1);
  vec2 half{1e-6f};
  for (int i = 0; i < 8; ++i) {
    const vec3 offset = corner_of(box, i) - light.position;
    const float along = std::max(glm::dot(offset, view.forward), 1e-3f * glm::length(offset));
    half = glm::max(half, glm::abs(vec2{glm::dot(offset, view.right), glm::dot(offset, view.up)}) / along);
  }
  fit(view, glm::min(half, vec2{kWidest}), size, border);
  return view;
}

}  // namespace meniscus
