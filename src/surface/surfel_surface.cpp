// The surface splatted from surfels [Iwasaki2008] 5.2, with what the particles add: thickness, colours, the eye in
// water.
#include <tbb/task_arena.h>
#include <glm/geometric.hpp>
#include <mutex>
#include <optional>

#include "surface/density.h"
#include "surface/march.h"
#include "surface/normal_filter.h"
#include "surface/packet.h"
#include "surface/surfel_extract.h"
#include "surface/surfel_splat.h"
#include "surface/thickness.h"

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

PacketList& thread_list() {
  thread_local PacketList list;
  return list;
}

/// What the surface knows of the particles behind its surfels.
struct Origin {
  explicit Origin(RaycastField particles) : field(std::move(particles)) {}
  RaycastField field;
  mutable std::once_flag cells_made;
  mutable std::optional<MarchCells> cells;  ///< made when rays are followed for the first time
};

class SurfelSurface final : public Surface {
 public:
  SurfelSurface(const Particles& particles, const SurfelOptions& given, std::span<const vec3> colours,
                StageTimes* times)
      : options_(resolved(given)) {
    origin_.emplace(make_density_field(particles, density_options_of(options_), true, colours, times));
    surfels_ = extract_surfels(origin_->field, options_, times);
    if (options_.normals != NormalMethod::gradient) find_normals(times);
    bounds_ = origin_->field.grid.bounds().grown(options_.smoothing_length);
  }

  SurfelSurface(std::vector<Surfel> surfels, float epsilon) : surfels_(std::move(surfels)) {
    options_.epsilon = epsilon;
    options_.want_thickness = false;
    options_.filter_radius = 0;
    for (const Surfel& surfel : surfels_) {
      bounds_.add(surfel.position - surfel.radius);
      bounds_.add(surfel.position + surfel.radius);
    }
  }

  SurfaceBuffers see(const View& view, std::span<const vec2> points, StageTimes* times) const override {
    if (view.projection == Projection::cube) return see_cube(view, points, times);
    if (points.empty()) return see_picture(view, times);
    return refine(view, see_picture(view, times), points, times);
  }

  SurfaceBuffers refine(const View& view, const SurfaceBuffers& coarse, std::span<const vec2> points,
                        StageTimes* times) const override {
    if (points.empty()) return {};
    if (view.projection == Projection::cube) return see_cube(view, points, times);
    SurfaceBuffers fine = splatted(view, points, times);
    if (options_.filter_radius > 0 && !coarse.normal.empty())
      take_filtered_normals(view, coarse, points, filter_tolerance(), fine);
    add_colours(view, points, fine, times);
    if (!coarse.thickness.empty()) fine.thickness = sampled_picture(coarse.thickness, points);
    return fine;
  }

  Image<float> thickness(const View& view, std::span<const vec2> points, StageTimes* times) const override {
    if (!origin_) {
      const bool picture = points.empty();
      return Image<float>(picture ? view.width : static_cast<int>(points.size()), picture ? view.height : 1, 0.0f);
    }
    StageTimer timer(times, "thickness");
    const BandGrid& grid = origin_->field.grid;
    const CountedCells counted(grid, options_.spacing, grid.counted());
    const auto of_face = [&](const View& face, std::span<const vec2> in_face) {
      return splatted_thickness(counted, options_.spacing, face, in_face);
    };
    if (view.projection != Projection::cube) return of_face(view, points);
    if (points.empty()) {
      Image<float> whole(view.width, view.height, 0.0f);
      for (int face = 0; face < 6; ++face) paste(of_face(view.face(face), {}), face, whole);
      return whole;
    }
    Image<float> values(static_cast<int>(points.size()), 1, 0.0f);
    for_each_face(view, points, [&](const View& face, std::span<const vec2> in_face, auto& targets) {
      const Image<float> found = of_face(face, in_face);
      for (std::size_t i = 0; i < targets.size(); ++i) values[targets[i]] = found[i];
    });
    return values;
  }

  float spacing() const override { return options_.spacing; }

  bool can_march() const override { return origin_.has_value(); }

  void crossings(std::span<const Ray> rays, std::span<const float> from, std::span<const float> limit,
                 std::span<const std::uint8_t> inside, std::span<Crossing> found) const override {
    if (!origin_) return Surface::crossings(rays, from, limit, inside, found);
    // Isolated, so that the thread that makes the cells does not begin other work that waits for them.
    std::call_once(origin_->cells_made,
                   [&] { tbb::this_task_arena::isolate([&] { origin_->cells.emplace(origin_->field); }); });
    march_crossings(origin_->field, *origin_->cells, rays, from, limit, inside, found);
  }

  Bounds bounds() const override { return bounds_; }

 private:
  SurfaceBuffers see_picture(const View& view, StageTimes* times) const {
    SurfaceBuffers seen = splatted(view, {}, times);
    if (options_.filter_radius > 0) {
      StageTimer timer(times, "filter");
      seen.normal = filtered_normals(view, seen.depth, seen.normal, options_.filter_radius, filter_tolerance());
    }
    add_colours(view, {}, seen, times);
    if (options_.want_thickness) seen.thickness = thickness(view, {}, times);
    return seen;
  }

  SurfaceBuffers splatted(const View& view, std::span<const vec2> points, StageTimes* times) const {
    StageTimer timer(times, "splat");
    SurfaceBuffers seen = splat_surfels(view, surfels_, normals_, options_.epsilon, starts_inside(view), points);
    if (seen.eye_in_water) std::fill(seen.entry.begin(), seen.entry.end(), 0.0f);
    show_cut(view, points, seen);
    return seen;
  }

  /// The normals of [Xiao2017] 3.3 at the surfels, sixteen neighbours at a time.
  void find_normals(StageTimes* times) {
    StageTimer timer(times, "normals");
    origin_->field.options.normals = options_.normals;
    normals_.resize(surfels_.size());
    parallel_for((surfels_.size() + kPacket - 1) / kPacket, 64, [&](std::size_t begin, std::size_t end) {
      for (std::size_t at = begin; at < end; ++at) {
        const std::size_t first = at * kPacket, count = std::min<std::size_t>(kPacket, surfels_.size() - first);
        PacketPoints points, towards, found;
        for (std::size_t l = 0; l < kPacket; ++l) {
          const Surfel& surfel = surfels_[first + std::min(l, count - 1)];
          points.x[l] = surfel.position.x, points.y[l] = surfel.position.y, points.z[l] = surfel.position.z;
          towards.x[l] = surfel.normal.x, towards.y[l] = surfel.normal.y, towards.z[l] = surfel.normal.z;
        }
        const auto mask = static_cast<PacketMask>((1u << count) - 1u);
        normals_packet(origin_->field, points, mask, towards, thread_list(), found);
        for (std::size_t l = 0; l < count; ++l) normals_[first + l] = {found.x[l], found.y[l], found.z[l]};
      }
    });
  }

  /// Whether rays of this view start inside the water.
  bool starts_inside(const View& view) const {
    if (!origin_ || view.projection == Projection::orthographic) return false;
    return density_at({&view.eye, 1})[0] >= options_.iso;
  }

  /// At up to sixteen places, the last one repeated.
  std::array<float, kPacket> density_at(std::span<const vec3> places) const {
    PacketPoints points;
    for (std::size_t l = 0; l < kPacket; ++l) {
      const vec3 p = places[std::min(l, places.size() - 1)];
      points.x[l] = p.x;
      points.y[l] = p.y;
      points.z[l] = p.z;
    }
    alignas(64) std::array<float, kPacket> density{};
    if (origin_->field.grid.size() > 0)
      density_packet(origin_->field, points, 0xffffu, false, thread_list(), density.data());
    return density;
  }

  /// Calls visit(first, count, ray of each) for sixteen consecutive pixels or points.
  template <class Visit>
  static void for_each_sixteen(const View& view, std::span<const vec2> points, std::size_t size, Visit visit) {
    parallel_for((size + kPacket - 1) / kPacket, 64, [&](std::size_t begin, std::size_t end) {
      for (std::size_t at = begin; at < end; ++at) {
        const std::size_t first = at * kPacket, count = std::min<std::size_t>(kPacket, size - first);
        visit(first, count, [&](std::size_t i) {
          if (!points.empty()) return view.ray(points[i]);
          const auto width = static_cast<std::size_t>(view.width);
          return view.ray({static_cast<float>(i % width) + 0.5f, static_cast<float>(i / width) + 0.5f});
        });
      }
    });
  }

  /// Parallel rays that start in the water meet the face that the view's plane cuts.
  void show_cut(const View& view, std::span<const vec2> points, SurfaceBuffers& seen) const {
    if (!origin_ || view.projection != Projection::orthographic || bounds_.empty()) return;
    const float half = glm::dot(0.5f * bounds_.extent(), glm::abs(view.forward));
    if (std::abs(glm::dot(bounds_.centre() - view.eye, view.forward)) > half) return;
    for_each_sixteen(view, points, seen.depth.size(), [&](std::size_t first, std::size_t count, auto ray_of) {
      std::array<vec3, kPacket> starts;
      for (std::size_t l = 0; l < count; ++l) starts[l] = ray_of(first + l).origin;
      const auto density = density_at({starts.data(), count});
      for (std::size_t l = 0; l < count; ++l) {
        if (!(density[l] >= options_.iso)) continue;
        seen.depth[first + l] = seen.entry[first + l] = 0.0f;
        seen.exit[first + l] = std::max(seen.exit[first + l], 0.0f);
        seen.normal[first + l] = -view.forward;
        seen.coverage[first + l] = 1.0f;
      }
    });
  }

  void add_colours(const View& view, std::span<const vec2> points, SurfaceBuffers& seen, StageTimes* times) const {
    if (!origin_ || !origin_->field.has_colours()) return;
    StageTimer timer(times, "colours");
    seen.colour = Image<vec3>(seen.depth.width(), seen.depth.height(), vec3{0});
    for_each_sixteen(view, points, seen.depth.size(), [&](std::size_t first, std::size_t count, auto ray_of) {
      PacketPoints places{}, colours;
      PacketMask mask = 0;
      for (std::size_t l = 0; l < count; ++l) {
        if (!(seen.depth[first + l] < kInfinity)) continue;
        const Ray ray = ray_of(first + l);
        const vec3 p = ray.origin + seen.depth[first + l] * ray.direction;
        places.x[l] = p.x;
        places.y[l] = p.y;
        places.z[l] = p.z;
        mask |= 1u << l;
      }
      if (mask == 0) return;
      colours_packet(origin_->field, places, mask, thread_list(), colours);
      for (std::size_t l = 0; l < count; ++l)
        if ((mask >> l) & 1u) seen.colour[first + l] = {colours.x[l], colours.y[l], colours.z[l]};
    });
  }

  float filter_tolerance() const { return 0.5f * options_.spacing; }

  /// Calls visit(face, points in it, their places in the list) for the faces of a cube that have points.
  template <class Visit>
  static void for_each_face(const View& view, std::span<const vec2> points, Visit visit) {
    const float size = static_cast<float>(view.height);
    for (int face = 0; face < 6; ++face) {
      std::vector<vec2> in_face;
      std::vector<std::size_t> targets;
      for (std::size_t i = 0; i < points.size(); ++i)
        if (std::clamp(static_cast<int>(points[i].x / size), 0, 5) == face) {
          in_face.push_back(points[i] - vec2{static_cast<float>(face) * size, 0});
          targets.push_back(i);
        }
      if (!targets.empty()) visit(view.face(face), std::span<const vec2>(in_face), targets);
    }
  }

  template <class T>
  static void paste(const Image<T>& square, int face, Image<T>& whole) {
    for (int y = 0; y < square.height(); ++y)
      std::copy_n(square.row(y), square.width(), whole.row(y) + face * square.width());
  }

  /// Six pictures side by side, or the points of each in its own.
  SurfaceBuffers see_cube(const View& view, std::span<const vec2> points, StageTimes* times) const {
    SurfaceBuffers whole;
    const int width = points.empty() ? view.width : static_cast<int>(points.size()),
              height = points.empty() ? view.height : 1;
    const auto for_each_image = [&](const SurfaceBuffers& part, auto visit) {
      visit(part.depth, whole.depth, kInfinity);
      visit(part.normal, whole.normal, vec3{0});
      visit(part.thickness, whole.thickness, 0.0f);
      visit(part.colour, whole.colour, vec3{0});
      visit(part.coverage, whole.coverage, 0.0f);
      visit(part.entry, whole.entry, kInfinity);
      visit(part.exit, whole.exit, -kInfinity);
      whole.eye_in_water = part.eye_in_water;
    };
    const auto make_room = [&](const auto& from, auto& to, auto fill) {
      if (!from.empty() && to.empty()) to = std::remove_reference_t<decltype(to)>(width, height, fill);
    };
    if (points.empty()) {
      for (int face = 0; face < 6; ++face)
        for_each_image(see_picture(view.face(face), times), [&](const auto& from, auto& to, auto fill) {
          make_room(from, to, fill);
          paste(from, face, to);
        });
      return whole;
    }
    for_each_face(view, points, [&](const View& face, std::span<const vec2> in_face, const auto& targets) {
      for_each_image(see(face, in_face, times), [&](const auto& from, auto& to, auto fill) {
        make_room(from, to, fill);
        for (std::size_t i = 0; i < from.size(); ++i) to[targets[i]] = from[i];
      });
    });
    return whole;
  }

  SurfelOptions options_;
  std::vector<Surfel> surfels_;
  std::vector<vec3> normals_;     ///< that are shaded, by surfel; empty: the surfels' own
  std::optional<Origin> origin_;  ///< none where surfels are all there is
  Bounds bounds_;
};

}  // namespace

std::unique_ptr<Surface> make_surfel_surface(const Particles& particles, const SurfelOptions& options,
                                             std::span<const vec3> colours, StageTimes* times) {
  return std::make_unique<SurfelSurface>(particles, options, colours, times);
}

std::unique_ptr<Surface> make_surfel_surface(std::vector<Surfel> surfels, float epsilon) {
  if (!(epsilon > 0) || !std::isfinite(epsilon))
    throw Error(ErrorCode::invalid_argument,
                ErrorDetail{"epsilon is out of range", "more than 0 m", std::to_string(epsilon), {}, {}, {}, {}});
  return std::make_unique<SurfelSurface>(std::move(surfels), epsilon);
}

}  // namespace meniscus
