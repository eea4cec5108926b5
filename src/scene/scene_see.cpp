// The scene as a view.
#include <glm/common.hpp>
#include <limits>

#include "scene/scene_parts.h"

namespace meniscus {
namespace {

/// Width of the beam of one picture point.
Beam beam_of(const View& view) {
  if (view.projection == Projection::orthographic) return {view.pixel_size(1.0f), 0.0f};
  return {0.0f, view.pixel_size(1.0f)};
}

}  // namespace

SceneBuffers Scene::see(const View& view, std::span<const vec2> points, StageTimes* times) const {
  const StageTimer timer(times, "scene");
  const int width = points.empty() ? view.width : static_cast<int>(points.size());
  const int height = points.empty() ? view.height : 1;
  SceneBuffers seen{Image<vec3>(width, height), Image<float>(width, height, std::numeric_limits<float>::infinity()),
                    Image<vec3>(width, height), Image<vec3>(width, height)};
  const Beam beam = beam_of(view);
  const auto draw = [&](std::size_t i, vec2 point) {
    const Ray ray = view.ray(point);
    const SolidHit found = hit(ray, beam);
    if (!found.found() || found.presence < 1.0f) seen.radiance[i] = environment().radiance(ray.direction);
    if (!found.found()) return;
    seen.radiance[i] = found.presence < 1.0f ? glm::mix(seen.radiance[i], lit(found, ray, beam), found.presence)
                                             : lit(found, ray, beam);
    seen.depth[i] = found.distance;
    seen.normal[i] = found.normal;
    seen.albedo[i] = found.albedo;
  };
  if (!points.empty()) {
    parallel_for(points.size(), 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) draw(i, points[i]);
    });
    return seen;
  }
  // Square tiles: their rays stay close together.
  constexpr int kTile = 16;
  const int across = (width + kTile - 1) / kTile, down = (height + kTile - 1) / kTile;
  parallel_for(static_cast<std::size_t>(across) * static_cast<std::size_t>(down), 4,
               [&](std::size_t begin, std::size_t end) {
                 for (std::size_t tile = begin; tile < end; ++tile) {
                   const int x0 = static_cast<int>(tile % static_cast<std::size_t>(across)) * kTile;
                   const int y0 = static_cast<int>(tile / static_cast<std::size_t>(across)) * kTile;
                   for (int y = y0; y < std::min(y0 + kTile, height); ++y)
                     for (int x = x0; x < std::min(x0 + kTile, width); ++x)
                       draw(static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x),
                            {static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
                 }
               });
  return seen;
}

}  // namespace meniscus
