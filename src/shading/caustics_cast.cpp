#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "meniscus/formulas/optics.h"
#include "shading/caustics_map.h"
#include "shading/light_map.h"

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr int kMapSize = 1024, kSolidsSize = 512, kLeastSize = 128;
/// Part of the box's longer side that is left around it for light that slopes bend outwards.
constexpr float kMargin = 0.25f;
/// Receivers that the first map sees at a smaller cosine are looked for by maps along the horizon.
constexpr float kSteepReceiver = 0.3f;
/// Half of the sun's angular radius: the standard deviation of what comes near a Gaussian of its disc, rad.
constexpr float kSunSpread = 0.00236f;
/// Standard deviation of the smoothing across the facets of the triangles, in points of the screen.
constexpr float kFacets = 0.4f;

/// The box, and where the light below it goes: straight on and bent, down to the lowest floor.
Bounds reach(const Bounds& box, const Scene& scene, vec3 up, vec3 bent, vec3 straight) {
  float floor = kInfinity;
  const Bounds solids = scene.solid_bounds();
  if (scene.ground().visible)
    floor = scene.ground().height;
  else if (!solids.empty())
    floor = glm::dot(solids.centre(), up) - 0.5f * glm::dot(solids.extent(), glm::abs(up));
  Bounds result = box;
  if (!(floor < kInfinity)) return result;
  for (int i = 0; i < 8; ++i) {
    const vec3 corner{i & 1 ? box.high.x : box.low.x, i & 2 ? box.high.y : box.low.y, i & 4 ? box.high.z : box.low.z};
    const float above = glm::dot(corner, up) - floor;
    if (!(above > 0)) continue;
    result.add(corner + bent * (above / std::max(-glm::dot(bent, up), 0.05f)));
    result.add(corner + straight * std::min(above / std::max(-glm::dot(straight, up), 0.05f),
                                            4.0f * glm::length(box.extent()) + above));
  }
  return result;
}

/// The part of an orthographic view that holds what lands, at a resolution of its own.
/// @return  false if nothing lands there
bool fit_to(const Image<Landing>& landings, const View& whole, int size, View& view) {
  vec2 low{kInfinity}, high{-kInfinity};
  for (const Landing& landing : landings) {
    if (landing.state != LandingState::landed || -glm::dot(landing.normal, whole.forward) < kGrazingCosine) continue;
    const vec3 at = whole.project(landing.point);
    low = glm::min(low, vec2{at.x, at.y});
    high = glm::max(high, vec2{at.x, at.y});
  }
  low = glm::max(low, vec2{0.0f});
  high = glm::min(high, vec2{static_cast<float>(whole.width), static_cast<float>(whole.height)});
  if (!(low.x < high.x && low.y < high.y)) return false;
  // Room for the blur and for what bilinear lookups reach.
  const float pixel = whole.pixel_size(0.0f);
  const vec2 extent = (high - low) * pixel;
  const float texel = 1.02f * std::max(extent.x, extent.y) / static_cast<float>(std::max(8, size - 8));
  const vec2 middle = 0.5f * (low + high);
  view = whole;
  view.width = std::clamp(static_cast<int>(std::ceil(extent.x / texel)) + 8, 8, size);
  view.height = std::clamp(static_cast<int>(std::ceil(extent.y / texel)) + 8, 8, size);
  view.half_height = 0.5f * texel * static_cast<float>(view.height);
  view.eye += whole.right * (pixel * (middle.x - 0.5f * static_cast<float>(whole.width))) -
              whole.up * (pixel * (middle.y - 0.5f * static_cast<float>(whole.height)));
  return true;
}

/// Mean length of the ways in the water, m.
float mean_path(const Image<Landing>& landings) {
  double sum = 0;
  std::size_t count = 0;
  for (const Landing& landing : landings)
    if (landing.state == LandingState::landed) {
      sum += static_cast<double>(landing.path);
      ++count;
    }
  return count ? static_cast<float>(sum / static_cast<double>(count)) : 0.0f;
}

/// Depths of the water as the light sees it.
UnbentLight unbent_of(const VirtualScreen& screen, const LightSource& light, const Bounds& box, bool from_light,
                      StageTimes* times) {
  static_cast<void>(times);
  if (from_light && screen.step == vec2{1.0f}) {
    Image<float> depth(screen.width, screen.height, kInfinity);
    for (std::size_t i = 0; i < depth.size(); ++i)
      if (screen.seen.coverage[i] > 0.5f) depth[i] = screen.seen.depth[i];
    return {screen.view, std::move(depth)};
  }
  // The water's triangles drawn as the light sees them: what they cover, and how far it is.
  View view = view_from_light(light, box, screen.up, std::max(screen.view.width, screen.view.height), 2);
  Image<float> depth(view.width, view.height, kInfinity);
  std::vector<std::vector<LightPolygon>> lists(1);
  const auto vertex = [&](int x, int y) {
    const vec3 at = view.project(screen.point(x, y));
    return at;
  };
  const auto add = [&](vec3 a, vec3 b, vec3 c) {
    LightPolygon polygon;
    polygon.corner[0] = {a.x, a.y};
    polygon.corner[1] = {b.x, b.y};
    polygon.corner[2] = {c.x, c.y};
    const float area = 0.5f * std::abs(doubled_area(polygon));
    const bool far = view.projection == Projection::perspective;
    const float z = (a.z + b.z + c.z) / 3.0f;
    static_cast<void>(far);
    polygon.flux = vec3{area, area * z, 0.0f};
    if (a.z > 0 && b.z > 0 && c.z > 0) lists[0].push_back(polygon);
  };
  for (int y = 0; y + 1 < screen.height; ++y)
    for (int x = 0; x + 1 < screen.width; ++x) {
      const bool a = screen.is_wet(x, y), b = screen.is_wet(x + 1, y), c = screen.is_wet(x, y + 1),
                 d = screen.is_wet(x + 1, y + 1);
      if (a && b && c) add(vertex(x, y), vertex(x + 1, y), vertex(x, y + 1));
      if (b && c && d) add(vertex(x + 1, y + 1), vertex(x, y + 1), vertex(x + 1, y));
    }
  Image<vec3> covered(view.width, view.height);
  draw_polygons(lists, covered);
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x) {
      const vec3 texel = covered(x, y);
      if (!(texel.x > 0.5f)) continue;
      const float z = texel.y / texel.x;
      const Ray ray = view.ray({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
      depth(x, y) = z / std::max(glm::dot(ray.direction, view.forward), 1e-3f);
    }
  return {view, std::move(depth)};
}

/// Draws the landings that a view sees.
void add_map(LightCast& cast, const Image<Landing>& landings, const View& whole, SceneMap solids, int size,
             const LightSource& light, bool first) {
  View view;
  if (!fit_to(landings, whole, size, view)) return;
  const TrianglesOfView triangles =
      caustics_triangles(cast.screen, light, landings, view, solids, first ? &cast.balance : nullptr);
  // The sun's disc, and the facets of the triangles.
  const float texel = view.pixel_size(0.0f);
  const float sun = light.sun ? kSunSpread * mean_path(landings) : 0.0f;
  const float facets = kFacets * cast.spacing;
  const float smooth = std::sqrt(sun * sun + facets * facets) / texel;
  if (first) cast.smooth_px = smooth;
  const auto drawn = [&](const PolygonLists& lists) {
    Image<vec3> power(view.width, view.height);
    draw_polygons(lists, power);
    blur(power, smooth);
    return power;
  };
  Image<vec3> seen = drawn(triangles.seen);
  cast.maps.emplace_back(view, std::move(seen), triangles.any_behind ? drawn(triangles.behind) : Image<vec3>{},
                         std::move(solids));
}

}  // namespace

LightCast cast_light(const Surface& surface, const LightSource& light, const Bounds& box, const Scene& scene,
                     const Material& material, const CausticsOptions& options, StageTimes* times, bool keep) {
  LightCast cast;
  cast.light = light;
  const vec3 up = scene.ground().up;
  {
    const StageTimer timer(times, "caustics surface");
    cast.screen = see_screen(surface, light, box, up, options);
  }
  const vec3 to_light = light.towards(box.centre());
  cast.spacing = cast.screen.view.pixel_size(glm::length(box.centre() - cast.screen.view.eye)) *
                 std::sqrt(cast.screen.step.x * cast.screen.step.y);
  const float cos_i = std::max(glm::dot(to_light, up), 0.02f);
  const vec3 bent = formulas::refracted(-to_light, up, material.ior, formulas::fresnel(cos_i, material.ior).cos_t);
  const int points = std::max(cast.screen.width, cast.screen.height);
  const int size = options.map_size > 0 ? options.map_size : std::clamp(2 * points, kLeastSize, kMapSize);
  const int solids_size = std::clamp(points, 2 * kLeastSize, kSolidsSize);

  // The solids as they are seen from the water's highest level on.
  const View whole = view_along(bent, reach(box, scene, up, bent, -to_light), up, solids_size, kMargin);
  const float top = glm::dot(box.centre(), up) + 0.5f * glm::dot(box.extent(), glm::abs(up));
  SceneMap solids;
  Image<Landing> landings;
  {
    const StageTimer timer(times, "caustics intersect");
    if (material.transparent)
      solids = see_solids(whole, scene, [&](const Ray& ray) {
        return (top - glm::dot(ray.origin, up)) / std::min(glm::dot(ray.direction, up), -0.02f);
      });
    landings = land(cast.screen, surface, light, scene, material, options.exact_hits ? nullptr : &solids, options);
  }
  const StageTimer timer(times, "caustics draw");
  cast.unbent.push_back(unbent_of(cast.screen, light, box, options.screen == ScreenDirection::light, times));
  if (!material.transparent) return cast;
  add_map(cast, landings, whole, std::move(solids), size, light, true);

  // Walls that the first view sees at a grazing angle, from the middle of the water.
  vec3 east = glm::cross(up, std::abs(up.x) < 0.9f ? vec3{1, 0, 0} : vec3{0, 0, 1});
  east = glm::normalize(east);
  const vec3 north = glm::cross(up, east);
  for (const vec3 side : {east, -east, north, -north}) {
    bool needed = false;
    for (const Landing& landing : landings)
      needed = needed || (landing.state == LandingState::landed && -glm::dot(landing.normal, side) > kSteepReceiver &&
                          -glm::dot(landing.normal, bent) < kSteepReceiver && landing.passed != vec3{0.0f});
    if (!needed) continue;
    const View level = view_along(side, box, up, std::max(solids_size / 2, kLeastSize), kMargin);
    const float begin =
        2.0f * std::max(0.5f * glm::length(box.extent()), 1e-6f) - 0.5f * glm::dot(box.extent(), glm::abs(side));
    SceneMap walls = see_solids(level, scene, [&](const Ray&) { return begin; });
    add_map(cast, landings, level, std::move(walls), size / 2, light, false);
  }
  if (keep) cast.landings = std::move(landings);
  return cast;
}

}  // namespace meniscus
