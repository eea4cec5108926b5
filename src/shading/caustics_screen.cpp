#include "shading/caustics_screen.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace meniscus {
namespace {

constexpr int kDefaultSize = 512;
/// Dry points around the water, so that its border lies between points.
constexpr int kBorder = 2;
/// Cosine with the vertical from which on a screen counts as upright.
constexpr float kUpright = 0.15f;

}  // namespace

vec3 VirtualScreen::point(int x, int y) const {
  const Ray ray = this->ray(x, y);
  return ray.origin + seen.depth(x, y) * ray.direction;
}

vec3 VirtualScreen::beside(int x, int y, vec3 level) const {
  const Ray ray = this->ray(x, y);
  const vec3 normal = std::abs(glm::dot(view.forward, up)) > kUpright ? up : view.forward;
  const float along = glm::dot(ray.direction, normal);
  const float t = std::abs(along) > 1e-3f ? glm::dot(level - ray.origin, normal) / along
                                          : glm::dot(level - ray.origin, ray.direction);
  return ray.origin + t * ray.direction;
}

VirtualScreen see_screen(const Surface& surface, const LightSource& light, const Bounds& box, vec3 up,
                         const CausticsOptions& options, StageTimes* times) {
  VirtualScreen screen;
  screen.up = up;
  const int longest = std::max(options.screen_width, options.screen_height);
  const int size = longest > 0 ? longest : kDefaultSize;
  screen.view = options.screen == ScreenDirection::light
                    ? view_from_light(light, box, up, size, kBorder)
                    : view_along(-up, box, up, size, 2.0f / static_cast<float>(size));
  // A width alone gives square pixels: the longer side may be the height.
  if (options.screen_width > 0 && options.screen_height == 0 && screen.view.width < options.screen_width) {
    const float scale = static_cast<float>(options.screen_width) / static_cast<float>(screen.view.width);
    screen.view = screen.view.resized(
        options.screen_width,
        std::min(1 << 14, static_cast<int>(std::ceil(scale * static_cast<float>(screen.view.height) - 1e-3f))));
  }
  screen.width = options.screen_width > 0 ? options.screen_width : screen.view.width;
  screen.height = options.screen_height > 0 ? options.screen_height : screen.view.height;
  screen.step = {static_cast<float>(screen.view.width) / static_cast<float>(screen.width),
                 static_cast<float>(screen.view.height) / static_cast<float>(screen.height)};

  if (screen.width == screen.view.width && screen.height == screen.view.height) {
    screen.seen = surface.see(screen.view, {}, times);
  } else {
    std::vector<vec2> points;
    points.reserve(static_cast<std::size_t>(screen.width) * static_cast<std::size_t>(screen.height));
    for (int y = 0; y < screen.height; ++y)
      for (int x = 0; x < screen.width; ++x) points.push_back(screen.picture(x, y));
    screen.seen = surface.see(screen.view, points, times);
    const auto shaped = [&](auto& image) {
      if (image.empty()) return;
      auto whole = std::remove_reference_t<decltype(image)>(screen.width, screen.height);
      std::copy(image.begin(), image.end(), whole.begin());
      image = std::move(whole);
    };
    shaped(screen.seen.depth);
    shaped(screen.seen.normal);
    shaped(screen.seen.thickness);
    shaped(screen.seen.coverage);
  }
  // What a surface may say in other words: depths that are not finite, normals without length.
  for (std::size_t i = 0; i < screen.seen.depth.size(); ++i) {
    const vec3 normal = screen.seen.normal[i];
    const bool wet = screen.seen.coverage[i] > 0.5f && std::isfinite(screen.seen.depth[i]) &&
                     glm::dot(normal, normal) > 0.25f && !screen.seen.eye_in_water;
    screen.seen.coverage[i] = wet ? 1.0f : 0.0f;
    screen.wet += wet;
  }
  return screen;
}

}  // namespace meniscus
