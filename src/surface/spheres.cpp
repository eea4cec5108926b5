// Particles as balls: what they are before a surface is made of them, to compare with.
#include <fmt/format.h>
#include <tbb/task_arena.h>
#include <cmath>
#include <glm/geometric.hpp>
#include <mutex>
#include <optional>

#include "meniscus/surface.h"
#include "particles/band_grid.h"
#include "surface/spheres_crossings.h"
#include "surface/splat.h"

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

class SphereSurface final : public Surface {
 public:
  SphereSurface(const Particles& particles, float radius, std::span<const vec3> colours)
      : grid_(particles, {2.0f * radius, 0, 0}), radius_(radius) {
    if (!colours.empty() && colours.size() != particles.size())
      throw Error(ErrorCode::invalid_argument,
                  fmt::format("{} colours were given for {} particles", colours.size(), particles.size()));
    if (colours.empty()) return;
    colours_.resize(grid_.size());
    for (std::size_t i = 0; i < colours_.size(); ++i) colours_[i] = colours[grid_.given_index(i)];
  }

  SurfaceBuffers see(const View& view, std::span<const vec2> points, StageTimes* times) const override {
    SurfaceBuffers buffers;
    {
      StageTimer timer(times, "splat");
      const SphereGroups groups(spheres());
      const GroupedSpheres all{spheres(), &groups};
      splat_entries(view, {&all, 1}, buffers.entry, buffers.exit);
    }
    if (!points.empty()) return refine(view, buffers, points, times);
    find(view, {}, buffers, times);
    buffers.thickness = thickness(view, {}, times);
    return buffers;
  }

  SurfaceBuffers refine(const View& view, const SurfaceBuffers& coarse, std::span<const vec2> points,
                        StageTimes* times) const override {
    // A point's ball is one of those that the pixels around it see.
    SurfaceBuffers fine;
    fine.entry = Image<float>(static_cast<int>(points.size()), 1, kInfinity);
    fine.exit = fine.entry;
    parallel_for(points.size(), 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) fine.entry[i] = first_hit(view, coarse, points[i]);
    });
    find(view, points, fine, times);
    fine.thickness = Image<float>(static_cast<int>(points.size()), 1, 0.0f);
    for (std::size_t i = 0; i < points.size(); ++i)
      if (fine.depth[i] < kInfinity) fine.thickness[i] = radius_;
    return fine;
  }

  Image<float> thickness(const View& view, std::span<const vec2> points, StageTimes* times) const override {
    StageTimer timer(times, "thickness");
    const Image<float> whole = splat_chords(view, spheres(), 1.0f, 1);
    if (points.empty()) return whole;
    Image<float> values(static_cast<int>(points.size()), 1);
    for (std::size_t i = 0; i < points.size(); ++i)
      values[i] = whole(std::clamp(static_cast<int>(points[i].x), 0, view.width - 1),
                        std::clamp(static_cast<int>(points[i].y), 0, view.height - 1));
    return values;
  }

  bool can_march() const override { return true; }

  void crossings(std::span<const Ray> rays, std::span<const float> from, std::span<const float> limit,
                 std::span<const std::uint8_t> inside, std::span<Crossing> found) const override {
    // Isolated, so that the thread that makes the cells does not begin other work that waits for them.
    std::call_once(cells_made_,
                   [&] { tbb::this_task_arena::isolate([&] { cells_.emplace(ball_cells(grid_, radius_)); }); });
    ball_crossings(grid_, radius_, *cells_, rays, from, limit, inside, found);
  }

  Bounds bounds() const override { return grid_.bounds().grown(radius_); }

 private:
  Spheres spheres() const {
    return {{grid_.x(), grid_.size()}, {grid_.y(), grid_.size()}, {grid_.z(), grid_.size()}, {&radius_, 1}};
  }

  /// Least distance at which the point's ray enters a ball that touches the surface seen around it.
  float first_hit(const View& view, const SurfaceBuffers& coarse, vec2 point) const {
    const Ray ray = view.ray(point);
    float nearest = kInfinity;
    const int x = static_cast<int>(point.x), y = static_cast<int>(point.y);
    for (int qy = std::max(y - 1, 0); qy <= std::min(y + 1, view.height - 1); ++qy)
      for (int qx = std::max(x - 1, 0); qx <= std::min(x + 1, view.width - 1); ++qx) {
        const float t = coarse.entry(qx, qy);
        if (!(t < kInfinity)) continue;
        const vec3 seen = ray.origin + t * ray.direction;
        const float reach = 2.0f * radius_;
        grid_.for_each_run(seen - reach, seen + reach, [&](std::size_t begin, std::size_t end) {
          for (std::size_t j = begin; j < end; ++j) {
            const vec3 offset = grid_.position(j) - ray.origin;
            const float middle = glm::dot(offset, ray.direction);
            const vec3 across = offset - middle * ray.direction;
            const float half2 = radius_ * radius_ - glm::dot(across, across);
            if (half2 > 0.0f && middle + std::sqrt(half2) > 0.0f)
              nearest = std::min(nearest, std::max(middle - std::sqrt(half2), 0.0f));
          }
        });
      }
    return nearest;
  }

  /// Depth is the entry; normal and colour are those of the ball whose face the point lies on.
  void find(const View& view, std::span<const vec2> points, SurfaceBuffers& buffers, StageTimes* times) const {
    StageTimer timer(times, "normals");
    const int width = buffers.entry.width(), height = buffers.entry.height();
    buffers.depth = buffers.entry;
    buffers.normal = Image<vec3>(width, height, vec3{0});
    buffers.coverage = Image<float>(width, height, 0.0f);
    if (!colours_.empty()) buffers.colour = Image<vec3>(width, height, vec3{0});
    parallel_for(buffers.depth.size(), 1024, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        if (!(buffers.depth[i] < kInfinity)) continue;
        const auto x = static_cast<float>(i % static_cast<std::size_t>(width)),
                   y = static_cast<float>(i / static_cast<std::size_t>(width));
        const Ray ray = view.ray(points.empty() ? vec2{x + 0.5f, y + 0.5f} : points[i]);
        const vec3 at = ray.origin + buffers.depth[i] * ray.direction;
        const float reach = 1.01f * radius_;
        float best = kInfinity;
        grid_.for_each_run(at - reach, at + reach, [&](std::size_t first, std::size_t last) {
          for (std::size_t j = first; j < last; ++j) {
            const vec3 off = at - grid_.position(j);
            const float miss = std::abs(glm::length(off) - radius_);
            if (miss >= best || !(glm::length(off) > 0.0f)) continue;
            best = miss;
            buffers.normal[i] = glm::normalize(off);
            if (!colours_.empty()) buffers.colour[i] = colours_[j];
          }
        });
        if (best == kInfinity) buffers.normal[i] = -ray.direction;
        buffers.coverage[i] = 1.0f;
      }
    });
  }

  BandGrid grid_;
  float radius_;
  std::vector<vec3> colours_;
  mutable std::once_flag cells_made_;
  mutable std::optional<MarchCells> cells_;  ///< made when rays are followed for the first time
};

}  // namespace

std::unique_ptr<Surface> make_sphere_surface(const Particles& particles, float radius, std::span<const vec3> colours) {
  return std::make_unique<SphereSurface>(particles, radius, colours);
}

}  // namespace meniscus
