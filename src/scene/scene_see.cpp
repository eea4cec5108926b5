// The scene as a view.
#include <algorithm>
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

void Scene::Parts::see(const RayBlock& rays, Beam beam, const std::size_t* pixels, SceneBuffers& seen) const {
  BlockHits hits;
  vec3 radiance[RayBlock::kRays];
  meet(rays, beam, false, hits);
  shade(rays, beam, hits, radiance);
  for (int lane = 0; lane < rays.count; ++lane) {
    const std::size_t i = pixels[lane];
    seen.radiance[i] = radiance[lane];
    const int face = hits.face[lane];
    if (face == kNothing) continue;
    seen.depth[i] = hits.distance[lane];
    seen.normal[i] = face == kSolidFace ? hits.solids[lane].normal : plane_normals[static_cast<std::size_t>(face)];
    seen.albedo[i] = {hits.albedo[0][lane], hits.albedo[1][lane], hits.albedo[2][lane]};
  }
}

SceneBuffers Scene::see(const View& view, std::span<const vec2> points, StageTimes* times) const {
  const StageTimer timer(times, "scene");
  const int width = points.empty() ? view.width : static_cast<int>(points.size());
  const int height = points.empty() ? view.height : 1;
  SceneBuffers seen{Image<vec3>(width, height), Image<float>(width, height, std::numeric_limits<float>::infinity()),
                    Image<vec3>(width, height), Image<vec3>(width, height)};
  const Beam beam = beam_of(view);
  constexpr int kRays = RayBlock::kRays;
  if (!points.empty()) {
    parallel_for(points.size(), 16 * kRays, [&](std::size_t begin, std::size_t end) {
      for (std::size_t first = begin; first < end; first += kRays) {
        RayBlock rays;
        std::size_t pixels[kRays];
        const auto count = static_cast<int>(std::min<std::size_t>(kRays, end - first));
        for (int lane = 0; lane < count; ++lane) {
          pixels[lane] = first + static_cast<std::size_t>(lane);
          rays.set(lane, view.ray(points[pixels[lane]]));
        }
        rays.close(count);
        parts_->see(rays, beam, pixels, seen);
      }
    });
    return seen;
  }
  // Square tiles: their rays stay close together.
  constexpr int kTile = 8;
  static_assert(kTile * kTile == kRays);
  const int across = (width + kTile - 1) / kTile, down = (height + kTile - 1) / kTile;
  parallel_for(static_cast<std::size_t>(across) * static_cast<std::size_t>(down), 16,
               [&](std::size_t begin, std::size_t end) {
                 for (std::size_t tile = begin; tile < end; ++tile) {
                   const int x0 = static_cast<int>(tile % static_cast<std::size_t>(across)) * kTile;
                   const int y0 = static_cast<int>(tile / static_cast<std::size_t>(across)) * kTile;
                   RayBlock rays;
                   std::size_t pixels[kRays];
                   int count = 0;
                   for (int y = y0; y < std::min(y0 + kTile, height); ++y)
                     for (int x = x0; x < std::min(x0 + kTile, width); ++x) {
                       pixels[count] =
                           static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
                       rays.set(count++, view.ray({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f}));
                     }
                   rays.close(count);
                   parts_->see(rays, beam, pixels, seen);
                 }
               });
  return seen;
}

}  // namespace meniscus
