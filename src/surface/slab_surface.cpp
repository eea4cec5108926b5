#include "surface/slab_surface.h"

#include <algorithm>
#include <cmath>

#include "surface/normal_filter.h"
#include "surface/raycast_field.h"
#include "surface/thickness.h"
#include "surface/thickness_water.h"

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kMarginSpacings = 4;   ///< beyond the reach of sums: for the entry of rays near the border
constexpr float kSeamSpacings = 0.5f;  ///< hits this far beyond a border count for both slabs, so that none is lost
constexpr std::size_t kSample = std::size_t{1} << 18;

const std::vector<float>& values_of(const Particles& particles, int axis) {
  return axis == 0 ? particles.x : axis == 1 ? particles.y : particles.z;
}

float smoothing_length_of(const RaycastOptions& options) {
  return options.smoothing_length > 0 ? options.smoothing_length : 2 * options.spacing;
}

/// m: the masses of particles that a sum at a place reaches depend on others around them.
float margin_of(const RaycastOptions& options) {
  const float h = smoothing_length_of(options);
  const float normals = options.normal_radius > 0 ? options.normal_radius : 3 * options.spacing;
  return std::max(h, normals) + h + kMarginSpacings * options.spacing;
}

/// Axes along which slabs may lie: the long ones, so that margins do not make them thick.
bool may_be_cut(const vec3& extent, int axis) {
  return extent[axis] >= 0.5f * std::max({extent.x, extent.y, extent.z});
}

/// The next number of slabs that is tried.
int more_slabs(int slabs) { return slabs + std::max(1, slabs / 4); }

/// One slab: the half-open range of its own, m along the axis.
struct Slab {
  int axis = 0;
  float low = -kInfinity, high = kInfinity;
};

class SlabSurface final : public Surface {
 public:
  SlabSurface(const Particles& particles, const RaycastOptions& options, std::span<const vec3> colours, int slabs)
      : particles_(particles), options_(options), colours_(colours), slabs_(slabs), bounds_(particles.bounds()) {
    // The options are checked as they always are.
    static_cast<void>(make_raycast_surface(Particles{}, options));
    if (!colours.empty() && colours.size() != particles.size())
      throw Error(ErrorCode::invalid_argument, "there must be as many colours as particles");
    if (slabs < 1) throw Error(ErrorCode::invalid_argument, "a surface is drawn in one slab at least");
  }

  SurfaceBuffers see(const View& view, std::span<const vec2> points, StageTimes* times) const override {
    SurfaceBuffers whole = empty_buffers(view.width, view.height);
    for (const Slab& slab : slabs_for(view)) {
      const std::unique_ptr<Surface> part = part_of(slab, margin_of(options_), times);
      SurfaceBuffers seen = part->see(view, {}, times);
      refuse_inside(seen, slab, view);
      compose(view, {}, slab, seen, whole);
      for (std::size_t i = 0; i < whole.entry.size(); ++i) {
        whole.entry[i] = std::min(whole.entry[i], seen.entry[i]);
        whole.exit[i] = std::max(whole.exit[i], seen.exit[i]);
      }
      look_behind_cuts(view, *part, slab, seen, whole, times);
    }
    if (options_.want_normals && options_.filter_radius > 0) {
      StageTimer timer(times, "filter");
      whole.normal = filtered_normals(view, whole.depth, whole.normal, options_.filter_radius, filter_tolerance());
    }
    if (options_.want_thickness) whole.thickness = thickness(view, {}, times);
    return points.empty() ? std::move(whole) : refine(view, whole, points, times);
  }

  SurfaceBuffers refine(const View& view, const SurfaceBuffers& coarse, std::span<const vec2> points,
                        StageTimes* times) const override {
    SurfaceBuffers fine = empty_buffers(static_cast<int>(points.size()), 1);
    for (const Slab& slab : slabs_for(view)) {
      if (points.empty()) break;
      const std::unique_ptr<Surface> part = part_of(slab, margin_of(options_), times);
      SurfaceBuffers seen = part->refine(view, coarse, points, times);
      compose(view, points, slab, seen, fine);
      fine.entry = std::move(seen.entry);  // of `coarse` in all slabs, as is the thickness
      fine.exit = std::move(seen.exit);
      fine.thickness = std::move(seen.thickness);
    }
    if (options_.want_normals && options_.filter_radius > 0 && !coarse.normal.empty() && !points.empty())
      take_filtered_normals(view, coarse, points, filter_tolerance(), fine);
    return fine;
  }

  /// The sum of what the slabs hold: cells are those of the whole, and cuts lie between them, so that the sums differ
  /// from the whole's only where cells beside a cut are told by their neighbours.
  Image<float> thickness(const View& view, std::span<const vec2> points, StageTimes* times) const override {
    const StageTimer timer(times, "thickness");
    return thickness_by_sums({bounds_, particles_.size(), options_.spacing}, view, points,
                             [&](const SplatCamera& camera) {
                               Image<float> sums(camera.width, camera.height, 0.0f);
                               const std::vector<Slab> slabs = slabs_for(view);
                               const float cell = smoothing_length_of(options_);
                               const vec3 origin = BandGrid::origin_of(bounds_, cell);
                               const auto cell_at = [&](const Slab& slab, float border) {
                                 return static_cast<int>(std::lround((border - origin[slab.axis]) / cell));
                               };
                               for (std::size_t k = 0; k < slabs.size(); ++k) {
                                 const Slab& slab = slabs[k];
                                 WaterShare share{particles_.size(), slab.axis};
                                 if (k > 0) share.first = cell_at(slab, slab.low);
                                 if (k + 1 < slabs.size()) share.end = cell_at(slab, slab.high);
                                 if (share.first < share.end) add_water(share, camera, sums);
                               }
                               return sums;
                             });
  }

  float spacing() const override { return options_.spacing; }

  Bounds bounds() const override { return bounds_.grown(smoothing_length_of(options_)); }

 private:
  float filter_tolerance() const { return 0.5f * options_.spacing; }

  SurfaceBuffers empty_buffers(int width, int height) const {
    SurfaceBuffers buffers;
    buffers.depth = buffers.entry = Image<float>(width, height, kInfinity);
    buffers.exit = Image<float>(width, height, -kInfinity);
    buffers.coverage = Image<float>(width, height);
    buffers.normal = Image<vec3>(width, height, vec3{0.0f});
    if (!colours_.empty()) buffers.colour = Image<vec3>(width, height, vec3{0.0f});
    return buffers;
  }

  /// Slabs of about equally many particles, across the axis that rays run along least: most rays stay in one slab.
  std::vector<Slab> slabs_for(const View& view) const {
    const vec3 extent = bounds_.extent();
    int axis = 0;
    float best = -1;
    for (int i = 0; i < 3; ++i) {
      const float across = extent[i] * (1.0f - 0.9f * std::abs(view.forward[i]));
      if (may_be_cut(extent, i) && across > best) {
        best = across;
        axis = i;
      }
    }
    const std::vector<float>& values = values_of(particles_, axis);
    std::vector<float> sample;
    const std::size_t step = values.size() / kSample + 1;
    for (std::size_t i = 0; i < values.size(); i += step) sample.push_back(values[i]);
    std::sort(sample.begin(), sample.end());
    std::vector<Slab> slabs{{axis, -kInfinity, kInfinity}};
    for (int k = 1; k < slabs_; ++k) {
      if (sample.empty()) break;
      const float border = sample[sample.size() * static_cast<std::size_t>(k) / static_cast<std::size_t>(slabs_)];
      if (!(border > slabs.back().low + options_.spacing)) continue;  // nothing would be between them
      slabs.back().high = border;
      slabs.push_back({axis, border, kInfinity});
    }
    return slabs;
  }

  /// Adds the water of some cells of the whole's grid.
  void add_water(const WaterShare& share, const SplatCamera& camera, Image<float>& sums) const {
    // Which cells lie amidst water is told by those around them.
    const float cell = smoothing_length_of(options_), margin = margin_of(options_) + cell;
    const float origin = BandGrid::origin_of(bounds_, cell)[share.axis];
    const float begin = origin + cell * static_cast<float>(share.first),
                end = origin + cell * static_cast<float>(share.end);
    const bool first = share.first <= 0, last = end >= bounds_.high[share.axis] - 0.01f * cell;
    const Slab slab{share.axis, first ? -kInfinity : begin, last ? kInfinity : end};
    Particles part = particles_in(slab, margin, nullptr);
    // Two more in cells that do not count hold the bounds: one at each end, or both where the other end is the slab's.
    vec3 low = bounds_.low, high = bounds_.high;
    if (first) low[share.axis] = bounds_.high[share.axis];
    if (last) high[share.axis] = bounds_.low[share.axis];
    if (!first || !last) {
      for (const vec3& at : {low, high}) {
        part.x.push_back(at.x);
        part.y.push_back(at.y);
        part.z.push_back(at.z);
      }
    }
    const RaycastField field = make_field(part, options_, {}, Keep::band);
    const Image<float> more =
        summed_water(CountedCells(field.grid, options_.spacing, share.all), options_.spacing, camera, share);
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += more[i];
  }

  /// The particles of a slab and those up to `margin` m beside it.
  /// @param colours  becomes theirs; may be null
  Particles particles_in(const Slab& slab, float margin, std::vector<vec3>* colours) const {
    const std::vector<float>& values = values_of(particles_, slab.axis);
    const auto is_in = [&](float value) { return value >= slab.low - margin && value < slab.high + margin; };
    const auto count = static_cast<std::size_t>(std::count_if(values.begin(), values.end(), is_in));
    Particles part;
    for (std::vector<float>* list : {&part.x, &part.y, &part.z}) list->reserve(count + 2);
    if (colours != nullptr) colours->reserve(count);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!is_in(values[i])) continue;
      part.x.push_back(particles_.x[i]);
      part.y.push_back(particles_.y[i]);
      part.z.push_back(particles_.z[i]);
      if (colours != nullptr) colours->push_back(colours_[i]);
    }
    return part;
  }

  /// The surface of the particles of a slab and of those up to `margin` m beside it.
  std::unique_ptr<Surface> part_of(const Slab& slab, float margin, StageTimes* times) const {
    std::vector<vec3> colours;
    const Particles part = particles_in(slab, margin, colours_.empty() ? nullptr : &colours);
    RaycastOptions options = options_;
    options.filter_radius = 0;  // the filter reaches over borders
    options.want_thickness = false;
    return make_raycast_surface(part, options, colours, times);
  }

  /// Takes the hits in the slab's own part that are nearer than those that are there.
  void compose(const View& view, std::span<const vec2> points, const Slab& slab, const SurfaceBuffers& seen,
               SurfaceBuffers& whole) const {
    const auto width = static_cast<std::size_t>(view.width);
    parallel_for(seen.depth.size(), 4096, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        if (!(seen.depth[i] < whole.depth[i])) continue;
        const Ray ray =
            view.ray(points.empty() ? vec2{static_cast<float>(i % width) + 0.5f, static_cast<float>(i / width) + 0.5f}
                                    : points[i]);
        if (!is_own(slab, ray, seen.depth[i])) continue;
        whole.depth[i] = seen.depth[i];
        whole.coverage[i] = seen.coverage[i];
        if (!seen.normal.empty()) whole.normal[i] = seen.normal[i];
        if (!seen.colour.empty()) whole.colour[i] = seen.colour[i];
      }
    });
  }

  /// Particles at a cut have too few neighbours and count for more than they should, so that the surface bulges there:
  /// a ray that grazes it ends before the slab's own part. Such rays march from where that begins.
  void look_behind_cuts(const View& view, const Surface& part, const Slab& slab, SurfaceBuffers& seen,
                        SurfaceBuffers& whole, StageTimes* times) const {
    const float seam = kSeamSpacings * options_.spacing;
    const auto width = static_cast<std::size_t>(view.width);
    std::vector<vec2> points;
    std::vector<std::size_t> pixels;
    for (std::size_t i = 0; i < seen.depth.size(); ++i) {
      const vec2 point{static_cast<float>(i % width) + 0.5f, static_cast<float>(i / width) + 0.5f};
      const Ray ray = view.ray(point);
      const float along = ray.direction[slab.axis];
      const float border = along > 0 ? slab.low - seam : slab.high + seam;
      const float begin = (border - ray.origin[slab.axis]) / along;  // NaN or infinite where there is none
      if (!(begin > 0 && begin < kInfinity)) continue;
      if (seen.depth[i] < std::min(begin, whole.depth[i])) {
        points.push_back(point);
        pixels.push_back(i);
      }
      seen.entry[i] = std::max(seen.entry[i], begin);
    }
    if (points.empty()) return;
    const SurfaceBuffers behind = part.refine(view, seen, points, times);
    for (std::size_t k = 0; k < points.size(); ++k) {
      const std::size_t i = pixels[k];
      if (!(behind.depth[k] < whole.depth[i]) || !is_own(slab, view.ray(points[k]), behind.depth[k])) continue;
      whole.depth[i] = behind.depth[k];
      whole.coverage[i] = behind.coverage[k];
      if (!behind.normal.empty()) whole.normal[i] = behind.normal[k];
      if (!behind.colour.empty()) whole.colour[i] = behind.colour[k];
    }
  }

  /// Whether a hit lies in the slab's own part, or so near to it that rounding may have moved it.
  bool is_own(const Slab& slab, const Ray& ray, float distance) const {
    const float seam = kSeamSpacings * options_.spacing;
    const float at = ray.origin[slab.axis] + distance * ray.direction[slab.axis];
    return at >= slab.low - seam && at < slab.high + seam;
  }

  void refuse_inside(const SurfaceBuffers& seen, const Slab& slab, const View& view) const {
    if (!seen.eye_in_water || view.eye[slab.axis] < slab.low || view.eye[slab.axis] >= slab.high) return;
    throw Error(ErrorCode::limit_exceeded, {"water that the eye is in cannot be drawn in parts",
                                            "an eye out of the water, or memory for all of the surface",
                                            {},
                                            {},
                                            {},
                                            {},
                                            "raise --memory-limit, or move the eye"});
  }

  const Particles& particles_;
  RaycastOptions options_;
  std::span<const vec3> colours_;
  int slabs_;
  Bounds bounds_;
};

}  // namespace

std::unique_ptr<Surface> make_slab_surface(const Particles& particles, const RaycastOptions& options,
                                           std::span<const vec3> colours, int slabs) {
  return std::make_unique<SlabSurface>(particles, options, colours, slabs);
}

std::uint64_t slab_bytes(int slabs, std::uint64_t count, const Bounds& bounds, const RaycastOptions& options,
                         std::uint64_t pixels, bool coloured) {
  const std::uint64_t colour = coloured ? 3 * sizeof(float) : 0;
  const RaycastEstimate whole = estimate_raycast(count, bounds, options, pixels);
  const auto held = [&](const RaycastEstimate& e, std::uint64_t particles) {
    return std::max(e.build_bytes, e.kept_bytes + e.view_bytes) + particles * colour;
  };
  if (slabs <= 1) return held(whole, count);
  const std::uint64_t own_buffers = estimate_raycast(0, bounds, options, pixels).view_bytes;  // the composed picture
  std::uint64_t most = 0;
  const vec3 extent = bounds.extent();
  for (int axis = 0; axis < 3; ++axis) {
    if (!may_be_cut(extent, axis)) continue;
    const double margin = std::min(
        1.0, 2.0 * static_cast<double>(margin_of(options)) / std::max(1e-30, static_cast<double>(extent[axis])));
    const double part = std::min(1.0, 1.0 / slabs + margin);
    Bounds slab = bounds;
    slab.high[axis] = slab.low[axis] + static_cast<float>(part) * extent[axis];
    const auto in_slab = static_cast<std::uint64_t>(part * static_cast<double>(count)) + 1;
    const std::uint64_t copied = in_slab * (3 * sizeof(float) + colour);
    most = std::max(most, held(estimate_raycast(in_slab, slab, options, pixels), in_slab) + copied + own_buffers);
  }
  return most;
}

int slabs_within(std::uint64_t bytes, std::uint64_t count, const Bounds& bounds, const RaycastOptions& options,
                 std::uint64_t pixels, bool coloured) {
  for (int slabs = 1; slabs <= kMostSlabs; slabs = more_slabs(slabs))
    if (slab_bytes(slabs, count, bounds, options, pixels, coloured) <= bytes) return slabs;
  return 0;
}

std::uint64_t least_slab_bytes(std::uint64_t count, const Bounds& bounds, const RaycastOptions& options,
                               std::uint64_t pixels, bool coloured) {
  std::uint64_t least = slab_bytes(1, count, bounds, options, pixels, coloured);
  for (int slabs = 2; slabs <= kMostSlabs; slabs = more_slabs(slabs))
    least = std::min(least, slab_bytes(slabs, count, bounds, options, pixels, coloured));
  return least;
}

}  // namespace meniscus
