// The scene as a view.
#include <algorithm>
#include <limits>

#include "scene/scene_parts.h"
#include "scene/view_rays.h"

namespace meniscus {
namespace {

/// Width of the beam of one picture point.
Beam beam_of(const View& view) {
  if (view.projection == Projection::orthographic) return {view.pixel_size(1.0f), 0.0f};
  return {0.0f, view.pixel_size(1.0f)};
}

/// What a thread works with.
struct Work {
  RayBlock rays;
  BlockHits hits;
  BlockPixels points;
  std::size_t pixels[RayBlock::kRays];
};

}  // namespace

void Scene::Parts::see(const RayBlock& rays, const BlockBeams& beams, const std::size_t* pixels, BlockHits& hits,
                       SceneBuffers& seen) const {
  BlockVectors radiance;
  meet(rays, beams, false, hits);
  shade(rays, beams, hits, radiance);
  for (int lane = 0; lane < rays.count; ++lane) {
    const std::size_t i = pixels[lane];
    seen.radiance[i] = radiance.get(lane);
    const int face = hits.face[lane];
    if (face == kNothing) continue;
    seen.depth[i] = hits.distance[lane];
    // Of the ground its own normal: the cover's grain has no outlines.
    const SolidHit* solid = face == kSolidFace ? &hits.solids[lane] : nullptr;
    seen.normal[i] = !solid           ? plane_normals[static_cast<std::size_t>(face)]
                     : solid->covered ? solid->face_normal
                                      : solid->normal;
    seen.albedo[i] = {hits.albedo[0][lane], hits.albedo[1][lane], hits.albedo[2][lane]};
  }
}

SceneBuffers Scene::see(const View& view, std::span<const vec2> points, StageTimes* times) const {
  const StageTimer timer(times, "scene");
  const int width = points.empty() ? view.width : static_cast<int>(points.size());
  const int height = points.empty() ? view.height : 1;
  SceneBuffers seen{Image<vec3>(width, height), Image<float>(width, height, std::numeric_limits<float>::infinity()),
                    Image<vec3>(width, height), Image<vec3>(width, height)};
  BlockBeams beams;
  beams.fill(beam_of(view));
  constexpr int kRays = RayBlock::kRays;
  if (!points.empty()) {
    parallel_for(points.size(), 16 * kRays, [&](std::size_t begin, std::size_t end) {
      Work work;
      for (std::size_t first = begin; first < end; first += kRays) {
        const std::size_t count = std::min<std::size_t>(kRays, end - first);
        for (std::size_t k = 0; k < count; ++k) {
          work.pixels[k] = first + k;
          work.points.x[k] = points[first + k].x;
          work.points.y[k] = points[first + k].y;
        }
        view_rays(view, work.points, static_cast<int>(count), work.rays);
        parts_->see(work.rays, beams, work.pixels, work.hits, seen);
      }
    });
    return seen;
  }
  // Square tiles: their rays stay close together. A cube's six faces are six pictures.
  constexpr int kTile = 8;
  static_assert(kTile * kTile == kRays);
  const bool cube = view.projection == Projection::cube;
  const int edge_x = cube ? height : width;
  const auto across = static_cast<std::size_t>((edge_x + kTile - 1) / kTile);
  const auto down = static_cast<std::size_t>((height + kTile - 1) / kTile);
  parallel_for((cube ? 6 : 1) * across * down, 16, [&](std::size_t begin, std::size_t end) {
    Work work;
    for (std::size_t tile = begin; tile < end; ++tile) {
      const int face = static_cast<int>(tile / (across * down));
      const int x0 = static_cast<int>(tile % across) * kTile, y0 = static_cast<int>(tile / across % down) * kTile;
      int count = 0;
      for (int y = y0; y < std::min(y0 + kTile, height); ++y)
        for (int x = x0; x < std::min(x0 + kTile, edge_x); ++x, ++count) {
          work.pixels[count] = static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                               static_cast<std::size_t>(face * height + x);
          work.points.x[count] = static_cast<float>(x) + 0.5f;
          work.points.y[count] = static_cast<float>(y) + 0.5f;
        }
      view_rays(cube ? view.face(face) : view, work.points, count, work.rays);
      parts_->see(work.rays, beams, work.pixels, work.hits, seen);
    }
  });
  return seen;
}

}  // namespace meniscus
