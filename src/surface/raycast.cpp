// The ray-cast surface [Xiao2017]: splatted entry depth, marched iso-surface, blended and filtered normals.
#include <tbb/task_arena.h>
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <mutex>
#include <optional>

#include "surface/hidden_cells.h"
#include "surface/march.h"
#include "surface/masses.h"
#include "surface/normal_filter.h"
#include "surface/packet.h"
#include "surface/splat.h"
#include "surface/thickness.h"

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Sixteen picture points that are drawn together, and where their results go.
struct Block {
  vec2 points[kPacket];
  std::size_t targets[kPacket];
  PacketMask mask = 0;
};

/// Gives the packet's rays; lanes that are not in the mask repeat the first one that is.
void set_rays(const View& view, const Block& block, PacketRays& rays) {
  const int first = __builtin_ctz(block.mask);
  for (int l = 0; l < kPacket; ++l) {
    const Ray ray = view.ray(block.points[(block.mask >> l) & 1u ? l : first]);
    rays.ox[l] = ray.origin.x;
    rays.oy[l] = ray.origin.y;
    rays.oz[l] = ray.origin.z;
    rays.dx[l] = ray.direction.x;
    rays.dy[l] = ray.direction.y;
    rays.dz[l] = ray.direction.z;
  }
}

/// Calls visit(block) for tiles of 4 x 4 pixels of the picture in parallel, or for sixteen points after another.
template <class Visit>
void for_each_block(const View& view, std::span<const vec2> points, Visit visit) {
  if (!points.empty()) {
    parallel_for((points.size() + kPacket - 1) / kPacket, 64, [&](std::size_t begin, std::size_t end) {
      for (std::size_t at = begin; at < end; ++at) {
        Block block;
        for (std::size_t l = 0; l < kPacket; ++l) {
          const std::size_t i = at * kPacket + l;
          if (i >= points.size()) break;
          block.points[l] = points[i];
          block.targets[l] = i;
          block.mask |= 1u << l;
        }
        visit(block);
      }
    });
    return;
  }
  constexpr int kSide = 4;
  const auto tiles_x = static_cast<std::size_t>((view.width + kSide - 1) / kSide);
  const auto tiles_y = static_cast<std::size_t>((view.height + kSide - 1) / kSide);
  parallel_for(tiles_y * tiles_x, 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t tile = begin; tile < end; ++tile) {
      const int x0 = static_cast<int>(tile % tiles_x) * kSide, y0 = static_cast<int>(tile / tiles_x) * kSide;
      Block block;
      for (int l = 0; l < kPacket; ++l) {
        const int x = x0 + l % kSide, y = y0 + l / kSide;
        if (x >= view.width || y >= view.height) continue;
        block.points[l] = {static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f};
        block.targets[l] =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width) + static_cast<std::size_t>(x);
        block.mask |= 1u << l;
      }
      visit(block);
    }
  });
}

/// Kept by each thread from one packet to the next.
PacketList& thread_list() {
  thread_local PacketList list;
  return list;
}

PacketPoints points_of(vec3 p) {
  PacketPoints points;
  std::fill_n(points.x, kPacket, p.x);
  std::fill_n(points.y, kPacket, p.y);
  std::fill_n(points.z, kPacket, p.z);
  return points;
}

class RaycastSurface final : public Surface {
 public:
  RaycastSurface(const Particles& particles, const RaycastOptions& options, std::span<const vec3> colours,
                 StageTimes* times)
      : field_([&] {
          StageTimer timer(times, "sort");
          return make_field(particles, options, colours);
        }()) {
    StageTimer timer(times, "masses");
    if (field_.options.cull_interior) find_hidden_cells(field_);
    if (field_.options.keep_thin) find_masses(field_);
    spheres_ = entry_spheres(field_);
  }

  SurfaceBuffers see(const View& view, std::span<const vec2> points, StageTimes* times) const override {
    SurfaceBuffers coarse = find_entries(view, times);
    if (points.empty()) {
      find_surface(view, {}, coarse, times);
      if (field_.options.want_thickness) coarse.thickness = thickness(view, {}, times);
      return coarse;
    }
    if (field_.options.want_thickness) coarse.thickness = thickness(view, {}, times);
    return refine(view, coarse, points, times);
  }

  SurfaceBuffers refine(const View& view, const SurfaceBuffers& coarse, std::span<const vec2> points,
                        StageTimes* times) const override {
    SurfaceBuffers fine;
    const int count = static_cast<int>(points.size());
    fine.eye_in_water = coarse.eye_in_water;
    fine.entry = Image<float>(count, 1, kInfinity);
    fine.exit = Image<float>(count, 1, -kInfinity);
    for (std::size_t i = 0; i < points.size(); ++i) {
      // A point between pixel centres may meet what its neighbours meet.
      const int x = static_cast<int>(points[i].x), y = static_cast<int>(points[i].y);
      for (int qy = std::max(y - 1, 0); qy <= std::min(y + 1, view.height - 1); ++qy)
        for (int qx = std::max(x - 1, 0); qx <= std::min(x + 1, view.width - 1); ++qx) {
          fine.entry[i] = std::min(fine.entry[i], coarse.entry(qx, qy));
          fine.exit[i] = std::max(fine.exit[i], coarse.exit(qx, qy));
        }
    }
    if (points.empty()) return fine;
    find_surface(view, points, fine, times);
    if (field_.options.filter_radius > 0 && !coarse.normal.empty() && !fine.normal.empty())
      take_filtered_normals(view, coarse, points, filter_tolerance(), fine);
    if (!coarse.thickness.empty()) fine.thickness = sampled_picture(coarse.thickness, points);
    return fine;
  }

  Image<float> thickness(const View& view, std::span<const vec2> points, StageTimes* times) const override {
    StageTimer timer(times, "thickness");
    return splatted_thickness(field_.grid, field_.options.spacing, view, points);
  }

  float spacing() const override { return field_.options.spacing; }

  bool can_march() const override { return true; }

  void crossings(std::span<const Ray> rays, std::span<const float> from, std::span<const float> limit,
                 std::span<const std::uint8_t> inside, std::span<Crossing> found) const override {
    // Isolated, so that the thread that makes the cells does not begin other work that waits for them.
    std::call_once(cells_made_, [&] { tbb::this_task_arena::isolate([&] { cells_.emplace(field_); }); });
    march_crossings(field_, *cells_, rays, from, limit, inside, found);
  }

  Bounds bounds() const override { return field_.grid.bounds().grown(field_.options.smoothing_length); }

 private:
  /// Whether rays of this view start inside the water.
  bool starts_inside(const View& view) const {
    if (view.projection != Projection::perspective || field_.grid.size() == 0) return false;
    alignas(64) float density[kPacket];
    density_packet(field_, points_of(view.eye), 1u, false, thread_list(), density);
    return density[0] >= field_.options.iso;
  }

  SurfaceBuffers find_entries(const View& view, StageTimes* times) const {
    StageTimer timer(times, "splat");
    SurfaceBuffers buffers;
    buffers.eye_in_water = starts_inside(view);
    if (!buffers.eye_in_water) {
      splat_depth(view, {spheres_.x, spheres_.y, spheres_.z, spheres_.radius}, buffers.entry, buffers.exit);
      start_where_hidden(view, buffers);
      return buffers;
    }
    const Bounds box = bounds();
    float farthest = 0;
    for (const float x : {box.low.x, box.high.x})
      for (const float y : {box.low.y, box.high.y})
        for (const float z : {box.low.z, box.high.z})
          farthest = std::max(farthest, glm::length(vec3{x, y, z} - view.eye));
    buffers.entry = Image<float>(view.width, view.height, 0.0f);
    buffers.exit = Image<float>(view.width, view.height, farthest);
    return buffers;
  }

  /// Rays that start amidst hidden cells, in a bubble or on a plane through the water, are inside of no sphere that
  /// was splatted: they march from their start.
  void start_where_hidden(const View& view, SurfaceBuffers& buffers) const {
    const ParticleGrid& grid = field_.grid;
    const auto is_hidden = [&](vec3 at) {
      const ParticleGrid::CellBox box = grid.cells(at, at);
      return !box.empty() && field_.is_hidden(grid.cell_index(box.x0, box.y0, box.z0));
    };
    if (field_.hidden.empty()) return;
    const bool perspective = view.projection == Projection::perspective;
    const vec3 half = 0.5f * grid.bounds().extent(), forward = glm::abs(view.forward);
    if (perspective ? !is_hidden(view.eye)
                    : glm::dot(grid.bounds().centre() - view.eye, view.forward) > glm::dot(half, forward))
      return;
    parallel_for(static_cast<std::size_t>(view.height), 16, [&](std::size_t begin, std::size_t end) {
      for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
        for (int x = 0; x < view.width; ++x)
          if (perspective || is_hidden(view.ray({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f}).origin))
            buffers.entry(x, y) = 0.0f;
    });
  }

  /// Depth, normals and colours from the entries; all images as large as buffers.entry.
  void find_surface(const View& view, std::span<const vec2> points, SurfaceBuffers& buffers, StageTimes* times) const {
    const int width = buffers.entry.width(), height = buffers.entry.height();
    buffers.depth = Image<float>(width, height, kInfinity);
    buffers.coverage = Image<float>(width, height, 0.0f);
    {
      StageTimer timer(times, "march");
      for_each_block(view, points, [&](const Block& block) {
        alignas(64) float entry[kPacket], exit[kPacket], depth[kPacket];
        PacketMask mask = 0;
        for (int l = 0; l < kPacket; ++l) {
          entry[l] = exit[l] = 0.0f;
          if (!((block.mask >> l) & 1u)) continue;
          entry[l] = buffers.entry[block.targets[l]];
          exit[l] = buffers.exit[block.targets[l]];
          if (entry[l] <= exit[l]) mask |= 1u << l;
        }
        if (mask == 0) return;
        PacketRays rays;
        set_rays(view, block, rays);
        for (int l = 0; l < kPacket; ++l)
          if (!((mask >> l) & 1u)) entry[l] = entry[__builtin_ctz(mask)];
        march_packet(field_, rays, mask, entry, exit, buffers.eye_in_water, thread_list(), depth);
        for (int l = 0; l < kPacket; ++l)
          if (((mask >> l) & 1u) && depth[l] < kInfinity) {
            buffers.depth[block.targets[l]] = depth[l];
            buffers.coverage[block.targets[l]] = 1.0f;
          }
      });
    }
    if (!field_.options.want_normals) return;
    {
      StageTimer timer(times, "normals");
      buffers.normal = Image<vec3>(width, height, vec3{0});
      if (field_.has_colours()) buffers.colour = Image<vec3>(width, height, vec3{0});
      for_each_block(view, points, [&](const Block& block) { find_normals(view, block, buffers); });
    }
    if (!points.empty() || field_.options.filter_radius == 0) return;
    StageTimer timer(times, "filter");
    buffers.normal =
        filtered_normals(view, buffers.depth, buffers.normal, field_.options.filter_radius, filter_tolerance());
  }

  float filter_tolerance() const { return 0.5f * field_.options.spacing; }

  void find_normals(const View& view, const Block& block, SurfaceBuffers& buffers) const {
    PacketMask mask = 0;
    for (int l = 0; l < kPacket; ++l)
      if (((block.mask >> l) & 1u) && buffers.depth[block.targets[l]] < kInfinity) mask |= 1u << l;
    if (mask == 0) return;
    PacketPoints points, towards, normals;
    for (int l = 0; l < kPacket; ++l) {
      const int lane = (mask >> l) & 1u ? l : __builtin_ctz(mask);
      const Ray ray = view.ray(block.points[lane]);
      const vec3 point = ray.origin + buffers.depth[block.targets[lane]] * ray.direction;
      points.x[l] = point.x;
      points.y[l] = point.y;
      points.z[l] = point.z;
      towards.x[l] = -ray.direction.x;
      towards.y[l] = -ray.direction.y;
      towards.z[l] = -ray.direction.z;
    }
    normals_packet(field_, points, mask, towards, thread_list(), normals);
    for (int l = 0; l < kPacket; ++l)
      if ((mask >> l) & 1u) {
        // A ray that starts in the water meets the face that the view's plane cuts.
        const bool cut = buffers.depth[block.targets[l]] <= 0.0f && !buffers.eye_in_water;
        buffers.normal[block.targets[l]] =
            cut ? vec3{towards.x[l], towards.y[l], towards.z[l]} : vec3{normals.x[l], normals.y[l], normals.z[l]};
      }
    if (!field_.has_colours()) return;
    PacketPoints colours;
    colours_packet(field_, points, mask, thread_list(), colours);
    for (int l = 0; l < kPacket; ++l)
      if ((mask >> l) & 1u) buffers.colour[block.targets[l]] = {colours.x[l], colours.y[l], colours.z[l]};
  }

  RaycastField field_;
  SphereSet spheres_;
  mutable std::once_flag cells_made_;
  mutable std::optional<MarchCells> cells_;  ///< made when rays are followed for the first time
};

}  // namespace

std::unique_ptr<Surface> make_raycast_surface(const Particles& particles, const RaycastOptions& options,
                                              std::span<const vec3> colours, StageTimes* times) {
  return std::make_unique<RaycastSurface>(particles, options, colours, times);
}

}  // namespace meniscus
