#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "meniscus/formulas/optics.h"
#include "shading/caustics_map.h"
#include "shading/light_map.h"

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr int kMapSize = 1024, kSolidsSize = 384, kLeastSize = 128;
/// Where there is nothing but the ground its rays need no picture of it.
constexpr int kGroundSize = 32;
/// Part of the box's longer side that is left around it for light that slopes bend outwards.
constexpr float kMargin = 0.25f;
/// Receivers that the first map sees at a smaller cosine are looked for by maps along the horizon.
constexpr float kSteepReceiver = 0.3f;
/// Half of the sun's angular radius: the standard deviation of what comes near a Gaussian of its disc, rad.
constexpr float kSunSpread = 0.00236f;
/// Standard deviation of the smoothing across the facets of the triangles, in points of the screen.
constexpr float kFacets = 0.5f;

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

/// What lands, at a glance.
struct Overview {
  vec2 low{kInfinity}, high{-kInfinity};          ///< in the picture of a view, px: of light that stays in the water
  vec2 far_low{kInfinity}, far_high{-kInfinity};  ///< and of other light
  double path = 0;                                ///< sum of the ways in the water, m
  std::size_t landed = 0;
  bool walls[4] = {};  ///< whether each of four directions sees light that the view hardly sees

  void add(const Overview& other) {
    low = glm::min(low, other.low);
    high = glm::max(high, other.high);
    far_low = glm::min(far_low, other.far_low);
    far_high = glm::max(far_high, other.far_high);
    path += other.path;
    landed += other.landed;
    for (int i = 0; i < 4; ++i) walls[i] = walls[i] || other.walls[i];
  }
};

Overview overview_of(const Image<LightLanding>& landings, const View& view, std::span<const vec3> sides) {
  constexpr int kRows = 16;
  std::vector<Overview> parts(static_cast<std::size_t>((landings.height() + kRows - 1) / kRows));
  parallel_for(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p)
      for (int y = static_cast<int>(p) * kRows; y < std::min(static_cast<int>(p + 1) * kRows, landings.height()); ++y)
        for (int x = 0; x < landings.width(); ++x) {
          const LightLanding& landing = landings(x, y);
          if (landing.state != LandingState::landed) continue;
          Overview& part = parts[p];
          part.path += static_cast<double>(landing.path);
          ++part.landed;
          const float facing = -glm::dot(landing.normal, view.forward);
          if (facing < kSteepReceiver && landing.passed != vec3{0.0f})
            for (std::size_t i = 0; i < sides.size(); ++i)
              part.walls[i] = part.walls[i] || -glm::dot(landing.normal, sides[i]) > kSteepReceiver;
          if (facing < kGrazingCosine) continue;
          const vec3 at = view.project(landing.point);
          vec2& low = landing.way ? part.far_low : part.low;
          vec2& high = landing.way ? part.far_high : part.high;
          low = glm::min(low, vec2{at.x, at.y});
          high = glm::max(high, vec2{at.x, at.y});
        }
  });
  Overview all;
  for (const Overview& part : parts) all.add(part);
  return all;
}

/// The part of an orthographic view that holds what lands, at a resolution of its own.
/// @param room  m that are left free around it
/// @return  false if nothing lands there
bool fit_to(const Overview& overview, const View& whole, int size, float room, View& view) {
  vec2 low = overview.low, high = overview.high;
  // A few rays that leave the water sideways do not make the map coarse.
  if (low.x <= high.x) {
    const vec2 margin{0.2f * std::max(high.x - low.x, high.y - low.y)};
    const vec2 inner_low = low, inner_high = high;
    low = glm::min(low, glm::max(overview.far_low, inner_low - margin));
    high = glm::max(high, glm::min(overview.far_high, inner_high + margin));
  } else {
    low = overview.far_low;
    high = overview.far_high;
  }
  low = glm::max(low, vec2{0.0f});
  high = glm::min(high, vec2{static_cast<float>(whole.width), static_cast<float>(whole.height)});
  if (!(low.x < high.x && low.y < high.y)) return false;
  // Room for the smoothing and for what bilinear lookups reach.
  const float pixel = whole.pixel_size(0.0f);
  const vec2 extent = (high - low) * pixel + 2.0f * room;
  const float texel = 1.02f * std::max(extent.x, extent.y) / static_cast<float>(std::max(8, size - 4));
  const vec2 middle = 0.5f * (low + high);
  view = whole;
  view.width = std::clamp(static_cast<int>(std::ceil(extent.x / texel)) + 4, 8, size);
  view.height = std::clamp(static_cast<int>(std::ceil(extent.y / texel)) + 4, 8, size);
  view.half_height = 0.5f * texel * static_cast<float>(view.height);
  view.eye += whole.right * (pixel * (middle.x - 0.5f * static_cast<float>(whole.width))) -
              whole.up * (pixel * (middle.y - 0.5f * static_cast<float>(whole.height)));
  return true;
}

/// Depths of the water as the light sees it.
UnbentLight unbent_of(const VirtualScreen& screen, const LightSource& light, const Bounds& box, bool from_light) {
  if (from_light && screen.step == vec2{1.0f}) return {screen.view, screen.seen.depth, screen.seen.coverage};
  // The water's triangles drawn as the light sees them: what they cover, and how far it is.
  const View view = view_from_light(light, box, screen.up, std::max(screen.view.width, screen.view.height), 2);
  PolygonLists lists(static_cast<std::size_t>(std::max(0, screen.height - 1)));
  const auto add = [&](std::vector<LightPolygon>& list, std::initializer_list<vec3> corners) {
    LightPolygon polygon;
    polygon.corners = 0;
    float depth = 0;
    for (const vec3 corner : corners) {
      const vec3 at = view.project(corner);
      if (!(at.z > 0)) return;
      depth += at.z / static_cast<float>(corners.size());
      polygon.corner[polygon.corners++] = {at.x, at.y};
    }
    const float area = 0.5f * std::abs(doubled_area(polygon));
    polygon.flux = vec3{area, area * depth, 0.0f};
    list.push_back(polygon);
  };
  // Where a corner is dry, each wet one keeps its third, as in the caustics.
  const auto add_triangle = [&](std::vector<LightPolygon>& list, const std::array<glm::ivec2, 3>& points) {
    std::array<bool, 3> wet{};
    for (std::size_t k = 0; k < 3; ++k) wet[k] = screen.is_wet(points[k].x, points[k].y);
    const auto point = [&](std::size_t k) { return screen.point(points[k].x, points[k].y); };
    if (wet[0] && wet[1] && wet[2]) return add(list, {point(0), point(1), point(2)});
    for (std::size_t k = 0; k < 3; ++k) {
      if (!wet[k]) continue;
      const std::size_t next = (k + 1) % 3, last = (k + 2) % 3;
      const vec3 here = point(k);
      const auto there = [&](std::size_t n) {
        return wet[n] ? point(n) : screen.beside(points[n].x, points[n].y, here);
      };
      const vec3 b = there(next), c = there(last);
      add(list, {here, 0.5f * (here + b), (here + b + c) / 3.0f, 0.5f * (here + c)});
    }
  };
  parallel_for(lists.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t l = begin; l < end; ++l)
      for (int x = 0, y = static_cast<int>(l); x + 1 < screen.width; ++x) {
        add_triangle(lists[l], {glm::ivec2{x, y}, {x + 1, y}, {x, y + 1}});
        add_triangle(lists[l], {glm::ivec2{x + 1, y + 1}, {x, y + 1}, {x + 1, y}});
      }
  });
  Image<vec3> covered(view.width, view.height);
  draw_polygons(lists, covered);
  Image<float> depth(view.width, view.height, kInfinity), coverage(view.width, view.height);
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x) {
      const vec3 texel = covered(x, y);
      if (!(texel.x > 0.01f)) continue;
      // Triangles that touch cover a texel to rounding.
      coverage(x, y) = texel.x > 0.999f ? 1.0f : texel.x;
      const Ray ray = view.ray({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
      depth(x, y) = texel.y / texel.x / std::max(glm::dot(ray.direction, view.forward), 1e-3f);
    }
  return {view, std::move(depth), std::move(coverage)};
}

/// Draws the landings that a view sees.
void add_map(LightCast& cast, const Image<LightLanding>& landings, const Overview& overview, const View& whole,
             SceneMap solids, int size, const LightSource& light, bool first) {
  // The sun's disc, and the facets of the triangles.
  const float path = static_cast<float>(overview.path / static_cast<double>(std::max<std::size_t>(overview.landed, 1)));
  const float sun = light.sun ? kSunSpread * path : 0.0f, facets = kFacets * cast.spacing;
  const float smooth = std::sqrt(sun * sun + facets * facets);
  View view;
  if (!fit_to(overview, whole, size, 3.0f * smooth, view)) return;
  const TrianglesOfView triangles =
      caustics_triangles(cast.screen, light, landings, view, solids, first ? &cast.balance : nullptr);
  const float smooth_px = smooth / view.pixel_size(0.0f);
  if (first) cast.smooth_px = smooth_px;
  const auto drawn = [&](const PolygonLists& lists) {
    Image<vec3> power(view.width, view.height);
    draw_light(lists, power);
    blur_finely(power, smooth_px);
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
  const int size = options.map_size > 0 ? options.map_size : std::clamp(5 * points / 4, kLeastSize, kMapSize);
  const bool ground_alone = scene.solid_bounds().empty();
  const int solids_size = ground_alone ? kGroundSize : std::clamp(points, 2 * kLeastSize, kSolidsSize);

  // The solids as they are seen from the water's highest level on.
  const View whole = view_along(bent, reach(box, scene, up, bent, -to_light), up, solids_size, kMargin);
  const float top = glm::dot(box.centre(), up) + 0.5f * glm::dot(box.extent(), glm::abs(up));
  SceneMap solids;
  Image<LightLanding> landings;
  {
    const StageTimer timer(times, "caustics intersect");
    if (material.transparent)
      solids = see_solids(whole, scene, [&](const Ray& ray) {
        return (top - glm::dot(ray.origin, up)) / std::min(glm::dot(ray.direction, up), -0.02f);
      });
    landings = land(cast.screen, surface, light, scene, material,
                    options.exact_hits || ground_alone ? nullptr : &solids, options);
  }
  const StageTimer timer(times, "caustics draw");
  cast.unbent.push_back(unbent_of(cast.screen, light, box, options.screen == ScreenDirection::light));
  if (!material.transparent) return cast;
  // And walls that the first view sees at a grazing angle, from the middle of the water.
  vec3 east = glm::cross(up, std::abs(up.x) < 0.9f ? vec3{1, 0, 0} : vec3{0, 0, 1});
  east = glm::normalize(east);
  const vec3 north = glm::cross(up, east);
  const std::array<vec3, 4> sides{east, -east, north, -north};
  const Overview overview = overview_of(landings, whole, sides);
  add_map(cast, landings, overview, whole, std::move(solids), size, light, true);
  for (std::size_t i = 0; i < sides.size(); ++i) {
    if (!overview.walls[i]) continue;
    const vec3 side = sides[i];
    const View level = view_along(side, box, up, std::max(solids_size / 2, kLeastSize), kMargin);
    const float begin =
        2.0f * std::max(0.5f * glm::length(box.extent()), 1e-6f) - 0.5f * glm::dot(box.extent(), glm::abs(side));
    SceneMap walls = see_solids(level, scene, [&](const Ray&) { return begin; });
    add_map(cast, landings, overview_of(landings, level, {}), level, std::move(walls), size / 2, light, false);
  }
  if (keep) cast.landings = std::move(landings);
  return cast;
}

}  // namespace meniscus
