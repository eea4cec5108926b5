#include "shading/caustics_screen.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <iterator>

namespace meniscus {
namespace {

constexpr int kDefaultSize = 512;
/// Dry points around the water, so that its border lies between points.
constexpr int kBorder = 2;
/// Cosine with the vertical from which on a screen counts as upright.
constexpr float kUpright = 0.15f;
/// Where the squares of points at the water's border are looked at, in steps from the point: a turned square, so that
/// upright and level edges count finely too.
constexpr vec2 kPlaces[] = {{-0.375f, -0.125f}, {0.125f, -0.375f}, {0.375f, 0.125f}, {-0.125f, 0.375f}};
constexpr int kTile = 8;  ///< points
constexpr std::size_t kPlaceCount = std::size(kPlaces);

/// What a surface may say in other words: depths that are not finite, normals without length.
bool has_water(const SurfaceBuffers& seen, std::size_t i) {
  const vec3 normal = seen.normal[i];
  return seen.coverage[i] > 0.5f && std::isfinite(seen.depth[i]) && glm::dot(normal, normal) > 0.25f &&
         !seen.eye_in_water;
}

/// Counts how much of the squares of points at the water's border has water, where the points are the view's pixels.
void look_at_border(const Surface& surface, VirtualScreen& screen) {
  std::vector<std::size_t> border;
  std::vector<vec2> places;
  Image<float>& coverage = screen.seen.coverage;
  const auto add = [&](int x, int y) {
    const float here = coverage(x, y);
    bool differs = false;
    for (int v = std::max(y - 1, 0); v <= std::min(y + 1, screen.height - 1); ++v)
      for (int u = std::max(x - 1, 0); u <= std::min(x + 1, screen.width - 1); ++u)
        differs = differs || coverage(u, v) != here;
    if (!differs) return;
    border.push_back(static_cast<std::size_t>(y) * static_cast<std::size_t>(screen.width) +
                     static_cast<std::size_t>(x));
    for (const vec2 place : kPlaces) places.push_back(screen.picture(x, y) + place * screen.step);
  };
  // Tile by tile, so that places that follow each other lie close together.
  for (int top = 0; top < screen.height; top += kTile)
    for (int left = 0; left < screen.width; left += kTile)
      for (int y = top; y < std::min(top + kTile, screen.height); ++y)
        for (int x = left; x < std::min(left + kTile, screen.width); ++x) add(x, y);
  if (border.empty()) return;
  const SurfaceBuffers fine = surface.refine(screen.view, screen.seen, places);
  const bool thick = fine.thickness.size() == places.size() && !screen.seen.thickness.empty();
  for (std::size_t b = 0; b < border.size(); ++b) {
    float wet = 0, depth = 0, thickness = 0;
    vec3 normal{0.0f};
    for (std::size_t k = b * kPlaceCount; k < (b + 1) * kPlaceCount; ++k) {
      if (!has_water(fine, k)) continue;
      wet += 1;
      depth += fine.depth[k];
      normal += glm::normalize(fine.normal[k]);
      if (thick) thickness += fine.thickness[k];
    }
    const std::size_t i = border[b];
    const bool was_wet = coverage[i] > 0;
    coverage[i] = wet / static_cast<float>(kPlaceCount);
    if (was_wet || !(wet > 0)) continue;
    const float length = glm::length(normal);
    if (!(length > 0.1f * wet)) {
      coverage[i] = 0;
      continue;
    }
    screen.seen.depth[i] = depth / wet;
    screen.seen.normal[i] = normal / length;
    if (thick) screen.seen.thickness[i] = thickness / wet;
  }
}

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
  SurfaceBuffers& seen = screen.seen;
  for (std::size_t i = 0; i < seen.depth.size(); ++i) seen.coverage[i] = has_water(seen, i) ? 1.0f : 0.0f;
  if (!seen.eye_in_water && screen.step == vec2{1.0f}) look_at_border(surface, screen);
  for (const float coverage : seen.coverage) screen.wet += coverage > 0;
  return screen;
}

}  // namespace meniscus
