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
#include "surface/picture_march.h"
#include "surface/picture_normals.h"
#include "surface/sized_field.h"
#include "surface/sized_masses.h"
#include "surface/sized_thickness.h"
#include "surface/splat.h"
#include "surface/spray.h"
#include "surface/thickness.h"

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

PacketPoints points_of(vec3 p) {
  PacketPoints points;
  std::fill_n(points.x, kPacket, p.x);
  std::fill_n(points.y, kPacket, p.y);
  std::fill_n(points.z, kPacket, p.z);
  return points;
}

class RaycastSurface final : public Surface {
 public:
  RaycastSurface(const Particles& particles, const ResolvedSizes& own, std::span<const vec3> colours, StageTimes* times)
      : field_([&] {
          StageTimer timer(times, "sort");
          return own.empty() ? make_field(particles, own.options, colours, Keep::band)
                             : make_sized_field(particles, own, colours);
        }()) {
    make_spheres(times);
    if (!field_.options.want_thickness || field_.has_sizes()) return;
    StageTimer timer(times, "thickness");
    counted();
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
    if (field_.has_sizes()) return sized_thickness(field_, view, points);
    return splatted_thickness(counted(), field_.options.spacing, view, points);
  }

  float spacing() const override { return field_.least_spacing; }

  bool can_march() const override { return true; }

  void crossings(std::span<const Ray> rays, std::span<const float> from, std::span<const float> limit,
                 std::span<const std::uint8_t> inside, std::span<Crossing> found) const override {
    // Isolated, so that the thread that makes the cells does not begin other work that waits for them.
    std::call_once(cells_made_, [&] { tbb::this_task_arena::isolate([&] { cells_.emplace(field_); }); });
    march_crossings(field_, *cells_, rays, from, limit, inside, found);
  }

  Bounds bounds() const override {
    Bounds all;
    for_each_level(
        field_, [&](const RaycastField& level) { all.add(level.grid.bounds().grown(level.options.smoothing_length)); });
    return all;
  }

 private:
  void make_spheres(StageTimes* times) {
    StageTimer timer(times, "masses");
    if (field_.options.keep_thin && field_.has_sizes())
      find_sized_masses(field_);
    else if (field_.options.keep_thin)
      find_masses(field_);
    if (!field_.has_sizes()) shrink_entries_of_spray(field_);
    for_each_level(field_, [&](RaycastField& level) {
      forget_amidst(level);
      hidden_cells_.add(hidden_cell_spheres(level));
    });
    for_each_level(field_, [&](const RaycastField& level) {
      const std::size_t kept = level.grid.size();
      const Spheres spheres{{level.grid.x(), kept}, {level.grid.y(), kept}, {level.grid.z(), kept}, level.entry_radius};
      groups_.emplace_back(spheres);
      spheres_.push_back({spheres, nullptr});
    });
    const Spheres cells{hidden_cells_.x, hidden_cells_.y, hidden_cells_.z, hidden_cells_.radius};
    groups_.emplace_back(cells);
    spheres_.push_back({cells, nullptr});
    for (std::size_t k = 0; k < groups_.size(); ++k) spheres_[k].groups = &groups_[k];
  }

  /// Whether rays of this view start inside the water.
  bool starts_inside(const View& view) const {
    if (view.projection != Projection::perspective || field_.grid.size() == 0) return false;
    alignas(64) float density[kPacket];
    PacketList list;
    density_packet(field_, points_of(view.eye), 1u, false, list, density);
    return density[0] >= field_.options.iso;
  }

  SurfaceBuffers find_entries(const View& view, StageTimes* times) const {
    StageTimer timer(times, "splat");
    SurfaceBuffers buffers;
    buffers.eye_in_water = starts_inside(view);
    if (!buffers.eye_in_water) {
      splat_entries(view, spheres_, buffers.entry, buffers.exit);
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
    bool any_hidden = false;
    for_each_level(field_, [&](const RaycastField& level) { any_hidden |= level.grid.has_hidden(); });
    if (!any_hidden) return;
    const auto is_hidden = [&](vec3 at) {
      bool hidden = false;
      for_each_level(field_, [&](const RaycastField& level) { hidden |= level.grid.kind_at(at) != BandGrid::open; });
      return hidden;
    };
    const Bounds box = bounds();
    const bool perspective = view.projection == Projection::perspective;
    const vec3 half = 0.5f * box.extent(), forward = glm::abs(view.forward);
    if (perspective ? !is_hidden(view.eye) : glm::dot(box.centre() - view.eye, view.forward) > glm::dot(half, forward))
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
    {
      StageTimer timer(times, "march");
      march_picture(field_, view, points, buffers);
    }
    if (!field_.options.want_normals) return;
    {
      StageTimer timer(times, "normals");
      find_picture_normals(field_, view, points, buffers);
    }
    if (!points.empty() || field_.options.filter_radius == 0) return;
    StageTimer timer(times, "filter");
    buffers.normal =
        filtered_normals(view, buffers.depth, buffers.normal, field_.options.filter_radius, filter_tolerance());
  }

  const CountedCells& counted() const {
    // Isolated, so that the thread that makes the cells does not begin other work that waits for them.
    std::call_once(counted_made_, [&] {
      tbb::this_task_arena::isolate(
          [&] { counted_.emplace(field_.grid, field_.options.spacing, field_.grid.counted()); });
    });
    return *counted_;
  }

  float filter_tolerance() const { return 0.5f * field_.least_spacing; }

  RaycastField field_;
  SphereSet hidden_cells_;
  std::vector<SphereGroups> groups_;     ///< by level, and those of hidden cells
  std::vector<GroupedSpheres> spheres_;  ///< the same: the field's own arrays, and hidden_cells_
  mutable std::once_flag counted_made_;
  mutable std::optional<CountedCells> counted_;  ///< made at once if thickness is wanted, else when it is asked for
  mutable std::once_flag cells_made_;
  mutable std::optional<MarchCells> cells_;  ///< made when rays are followed for the first time
};

}  // namespace

std::unique_ptr<Surface> make_raycast_surface(const Particles& particles, const RaycastOptions& options,
                                              std::span<const vec3> colours, StageTimes* times,
                                              const ParticleSizes& sizes) {
  return std::make_unique<RaycastSurface>(particles, resolve_sizes(sizes, options, particles.size()), colours, times);
}

}  // namespace meniscus
