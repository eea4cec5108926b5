// The ray-cast surface by the plain method: scalar, one thread, nothing shared between rays. It says what the
// fast one has to give.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "meniscus/formulas/eigen.h"
#include "meniscus/formulas/kernels.h"
#include "surface/normal_filter.h"
#include "surface/particle_sizes.h"
#include "surface/raycast_field.h"

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

class PlainRaycastSurface final : public Surface {
 public:
  PlainRaycastSurface(const Particles& particles, const ResolvedSizes& own, std::span<const vec3> colours,
                      StageTimes* times)
      : field_([&] {
          StageTimer timer(times, "sort");
          return make_field(particles, own.options, colours);  // cells of the largest smoothing length
        }()) {
    take_sizes(own);
    StageTimer timer(times, "masses");
    if (!field_.options.keep_thin) return;
    SizedMassRules rules(field_.options);
    PagedVector<float> mass(field_.mass);
    for (std::size_t i = 0; i < field_.grid.size(); ++i) {
      const float density = density_at(field_.grid.position(i));
      mass[i] = mass_at(rules.rule(spacing_[i], smoothing_[i]), density);
      field_.entry_radius[i] = entry_radius_at(options_of(i), density);
    }
    field_.mass = std::move(mass);
  }

  SurfaceBuffers see(const View& view, std::span<const vec2> points, StageTimes* times) const override {
    SurfaceBuffers buffers;
    const int width = points.empty() ? view.width : static_cast<int>(points.size());
    const int height = points.empty() ? view.height : 1;
    buffers.eye_in_water = view.projection == Projection::perspective && density_at(view.eye) >= field_.options.iso;
    buffers.entry = Image<float>(width, height, buffers.eye_in_water ? 0.0f : kInfinity);
    buffers.exit = Image<float>(width, height, buffers.eye_in_water ? 1e6f * field_.options.spacing : -kInfinity);
    buffers.depth = Image<float>(width, height, kInfinity);
    buffers.coverage = Image<float>(width, height, 0.0f);
    const std::vector<Ray> rays = rays_of(view, points);
    if (!buffers.eye_in_water) {
      StageTimer timer(times, "splat");
      splat(view, points, rays, buffers);
    }
    {
      StageTimer timer(times, "march");
      for (std::size_t i = 0; i < buffers.depth.size(); ++i) {
        if (!(buffers.entry[i] <= buffers.exit[i])) continue;
        buffers.depth[i] = march(rays[i], buffers.entry[i], buffers.exit[i], buffers.eye_in_water ? -1.0f : 1.0f);
        buffers.coverage[i] = buffers.depth[i] < kInfinity ? 1.0f : 0.0f;
      }
    }
    if (field_.options.want_normals) {
      StageTimer timer(times, "normals");
      buffers.normal = Image<vec3>(width, height, vec3{0});
      if (field_.has_colours()) buffers.colour = Image<vec3>(width, height, vec3{0});
      for (std::size_t i = 0; i < buffers.depth.size(); ++i) {
        if (!(buffers.depth[i] < kInfinity)) continue;
        const Ray ray = rays[i];
        const vec3 point = ray.origin + buffers.depth[i] * ray.direction;
        const bool cut = buffers.depth[i] <= 0.0f && !buffers.eye_in_water;  // by the view's plane
        buffers.normal[i] = cut ? -ray.direction : normal_at(point, -ray.direction);
        if (field_.has_colours()) buffers.colour[i] = colour_at(point);
      }
      if (points.empty() && field_.options.filter_radius > 0) {
        StageTimer filter_timer(times, "filter");
        buffers.normal = filtered(buffers, rays);
      }
    }
    if (field_.options.want_thickness) buffers.thickness = thickness(view, points, times);
    return buffers;
  }

  Image<float> thickness(const View& view, std::span<const vec2> points, StageTimes* times) const override {
    StageTimer timer(times, "thickness");
    const std::vector<Ray> rays = rays_of(view, points);
    Image<float> sum(points.empty() ? view.width : static_cast<int>(points.size()), points.empty() ? view.height : 1);
    for (std::size_t i = 0; i < field_.grid.size(); ++i) {
      const vec3 centre = field_.grid.position(i);
      const float s = spacing_[i], r = thickness_radius(options_of(i));
      const float weight = s * s * s / (4.0f / 3.0f * 3.14159265f * r * r * r);
      for_each_covered(view, points, centre, r, [&](std::size_t pixel) {
        const Chord chord = chord_of(rays[pixel], centre, r);
        if (chord.leave > chord.enter) sum[pixel] += weight * (chord.leave - chord.enter);
      });
    }
    return sum;
  }

  Bounds bounds() const override { return field_.grid.bounds().grown(field_.options.smoothing_length); }

  float spacing() const override { return least_spacing_; }

 private:
  /// Steps are those of the smallest particle.
  void take_sizes(const ResolvedSizes& own) {
    spacing_.assign(field_.grid.size(), field_.options.spacing);
    smoothing_.assign(field_.grid.size(), field_.options.smoothing_length);
    least_spacing_ = field_.options.spacing;
    if (own.empty()) return;
    float least = field_.options.smoothing_length;
    for (std::size_t i = 0; i < field_.grid.size(); ++i) {
      const std::size_t given = field_.grid.given_index(i);
      spacing_[i] = own.spacing[given];
      smoothing_[i] = own.smoothing_length[given];
      least = std::min(least, smoothing_[i]);
      least_spacing_ = std::min(least_spacing_, spacing_[i]);
      field_.entry_radius[i] = entry_radius_at(options_of(i), 1.0f);
    }
    field_.step = field_.options.step * least;
  }

  RaycastOptions options_of(std::size_t i) const { return options_of_size(field_.options, spacing_[i], smoothing_[i]); }
  float volume_of(std::size_t i) const { return spacing_[i] * spacing_[i] * spacing_[i]; }

  struct Chord {
    float enter = kInfinity, leave = -kInfinity;
  };

  static Chord chord_of(const Ray& ray, vec3 centre, float radius) {
    const vec3 offset = centre - ray.origin;
    const float middle = glm::dot(offset, ray.direction);
    const vec3 across = offset - middle * ray.direction;
    const float half2 = radius * radius - glm::dot(across, across);
    if (half2 <= 0.0f) return {};
    const float half = std::sqrt(half2);
    if (middle + half <= 0.0f) return {};
    return {std::max(middle - half, 0.0f), middle + half};
  }

  /// The rays through the pixel centres, row after row, or through the points.
  static std::vector<Ray> rays_of(const View& view, std::span<const vec2> points) {
    std::vector<Ray> rays;
    for (const vec2 point : points) rays.push_back(view.ray(point));
    if (!points.empty()) return rays;
    rays.reserve(static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height));
    for (int y = 0; y < view.height; ++y)
      for (int x = 0; x < view.width; ++x)
        rays.push_back(view.ray({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f}));
    return rays;
  }

  /// Calls visit(index) for the pixels, or points, that a sphere may cover.
  template <class Visit>
  void for_each_covered(const View& view, std::span<const vec2> points, vec3 centre, float radius, Visit visit) const {
    if (!points.empty()) {
      for (std::size_t i = 0; i < points.size(); ++i) visit(i);
      return;
    }
    int x0 = 0, y0 = 0, x1 = view.width - 1, y1 = view.height - 1;
    const vec3 at = view.project(centre);
    const float distance2 = glm::dot(centre - view.eye, centre - view.eye);
    if (at.z + radius <= 0.0f) return;
    if (view.projection == Projection::orthographic || at.z > 4.0f * radius) {
      // Generous: no sphere in front of the eye is seen wider than this around its centre.
      const float nearest = view.projection == Projection::orthographic ? at.z : at.z - radius;
      const float slant = view.projection == Projection::orthographic ? 1.0f : std::sqrt(distance2) / at.z;
      const float reach = 1.5f * slant * radius / view.pixel_size(nearest) + 1.0f;
      x0 = static_cast<int>(std::max(0.0f, at.x - reach));
      x1 = static_cast<int>(std::min(static_cast<float>(view.width - 1), at.x + reach));
      y0 = static_cast<int>(std::max(0.0f, at.y - reach));
      y1 = static_cast<int>(std::min(static_cast<float>(view.height - 1), at.y + reach));
    }
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x)
        visit(static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width) + static_cast<std::size_t>(x));
  }

  void splat(const View& view, std::span<const vec2> points, const std::vector<Ray>& rays,
             SurfaceBuffers& buffers) const {
    for (std::size_t i = 0; i < field_.grid.size(); ++i) {
      const vec3 centre = field_.grid.position(i);
      const float radius = field_.entry_radius[i];
      for_each_covered(view, points, centre, radius, [&](std::size_t pixel) {
        const Chord chord = chord_of(rays[pixel], centre, radius);
        buffers.entry[pixel] = std::min(buffers.entry[pixel], chord.enter);
        buffers.exit[pixel] = std::max(buffers.exit[pixel], chord.leave);
      });
    }
  }

  /// Calls visit(particle, distance) for all within `radius` of the point.
  template <class Visit>
  void for_each_neighbour(vec3 point, float radius, Visit visit) const {
    const BandGrid& grid = field_.grid;
    grid.for_each_run(point - radius, point + radius, [&](std::size_t begin, std::size_t end) {
      for (std::size_t j = begin; j < end; ++j) {
        const vec3 off = grid.position(j) - point;
        const float distance2 = glm::dot(off, off);
        if (distance2 < radius * radius) visit(j, std::sqrt(distance2));
      }
    });
  }

  float density_at(vec3 point) const {
    float sum = 0;
    for_each_neighbour(point, field_.options.smoothing_length, [&](std::size_t j, float r) {
      sum += field_.mass[j] * volume_of(j) * kernel_value(field_.options.kernel, r, smoothing_[j]);
    });
    return sum;
  }

  vec3 colour_at(vec3 point) const {
    vec3 sum{0};
    float weights = 1e-12f;
    for_each_neighbour(point, field_.options.smoothing_length, [&](std::size_t j, float r) {
      const float weight = field_.mass[j] * volume_of(j) * formulas::cubic_spline(r, smoothing_[j]);
      sum += weight * vec3{field_.red[j], field_.green[j], field_.blue[j]};
      weights += weight;
    });
    return sum / weights;
  }

  /// m along the ray to where sign (rho - iso) becomes positive; infinity if it does not before `exit`.
  float march(const Ray& ray, float entry, float exit, float sign) const {
    const auto value_at = [&](float t) {
      return sign * (density_at(ray.origin + t * ray.direction) - field_.options.iso);
    };
    const float margin = -kSummitMargin * field_.options.iso;
    float earlier = 0, before = 0;
    for (int n = 0;; ++n) {
      const float t = entry + static_cast<float>(n) * field_.step;
      if (t > exit) return kInfinity;
      const float value = value_at(t);
      if (value >= 0.0f)
        return n == 0 ? backwards(entry, value, value_at) : refined(t - field_.step, before, t, value, value_at);
      if (n >= 2 && before > earlier && before > value) {
        const Summit summit = summit_of(earlier, before, value);
        const float middle = t - field_.step, at = middle + summit.place * field_.step;
        const float highest = summit.value > margin ? value_at(at) : -1.0f;
        if (highest >= 0.0f)
          return summit.place > 0.0f ? refined(middle, before, at, highest, value_at)
                                     : refined(middle - field_.step, earlier, at, highest, value_at);
      }
      earlier = before;
      before = value;
    }
  }

  template <class ValueAt>
  float backwards(float entry, float value, ValueAt value_at) const {
    float high_t = entry, high = value;
    const int steps = static_cast<int>(std::ceil(field_.options.smoothing_length / field_.step));
    for (int n = 1; n <= steps; ++n) {
      const float t = std::max(entry - static_cast<float>(n) * field_.step, 0.0f);
      const float here = value_at(t);
      if (here < 0.0f) return refined(t, here, high_t, high, value_at);
      high_t = t;
      high = here;
      if (t == 0.0f) break;
    }
    return high_t;
  }

  template <class ValueAt>
  float refined(float low_t, float low, float high_t, float high, ValueAt value_at) const {
    const auto secant = [&] {
      return low_t + std::clamp(high > low ? -low / (high - low) : 0.5f, 0.0f, 1.0f) * (high_t - low_t);
    };
    for (int i = 0; i < field_.options.refinement_steps; ++i) {
      const float t = field_.options.refinement == Refinement::secant ? secant() : 0.5f * (low_t + high_t);
      const float value = value_at(t);
      (value < 0.0f ? low_t : high_t) = t;
      (value < 0.0f ? low : high) = value;
    }
    return secant();
  }

  vec3 normal_at(vec3 point, vec3 towards) const {
    const float largest = field_.options.normal_radius, per_spacing = largest / field_.options.spacing;
    // Eq. 2; each particle counts by its volume and to its own radius, both in units of the largest one's.
    vec3 gradient{0};
    float weights = 0;
    vec3 mean{0};
    int neighbours = 0;
    for_each_neighbour(point, largest, [&](std::size_t j, float r) {
      const float R = per_spacing * spacing_[j], part = spacing_[j] / field_.options.spacing;
      if (r >= R) return;
      const float volume = part * part * part;
      const vec3 off = field_.grid.position(j) - point;
      gradient += volume * formulas::spiky_slope(r, R) / std::max(r, 1e-6f * R) * -off;
      weights += volume * formulas::pca_weight(r, R);
      mean += volume * formulas::pca_weight(r, R) * off;
      ++neighbours;
    });
    const vec3 outwards = -gradient;
    vec3 normal = glm::dot(outwards, outwards) > 0.0f ? glm::normalize(outwards) : towards;
    if (field_.options.normals == NormalMethod::gradient || neighbours < kFewestNeighboursForPca) return normal;
    // Eq. 3 and 4, in units of the largest R.
    mean /= weights;
    formulas::Symmetric3 covariance{0, 0, 0, 0, 0, 0};
    for_each_neighbour(point, largest, [&](std::size_t j, float r) {
      const float R = per_spacing * spacing_[j], part = spacing_[j] / field_.options.spacing;
      if (r >= R) return;
      const vec3 off = (field_.grid.position(j) - point - mean) / largest;
      const float w = part * part * part * formulas::pca_weight(r, R) / weights;
      covariance.xx += w * off.x * off.x;
      covariance.yy += w * off.y * off.y;
      covariance.zz += w * off.z * off.z;
      covariance.xy += w * off.x * off.y;
      covariance.xz += w * off.x * off.z;
      covariance.yz += w * off.y * off.z;
    });
    const formulas::LeastEigen eigen = formulas::least_eigen(covariance);
    if (!(eigen.middle > kLeastPcaSpread * eigen.largest)) return normal;
    const float agreement = glm::dot(eigen.direction, normal);
    const vec3 pca = agreement < 0 ? -eigen.direction : eigen.direction;
    if (field_.options.normals == NormalMethod::pca) return pca;
    // Eq. 5 and 6
    const float w = std::min(
        1.0f, std::exp(field_.options.blend_sharpness * (std::abs(agreement) - field_.options.blend_agreement)));
    return glm::normalize((1.0f - w) * normal + w * pca);
  }

  Image<vec3> filtered(const SurfaceBuffers& buffers, const std::vector<Ray>& rays) const;

  RaycastField field_;
  std::vector<float> spacing_, smoothing_;  ///< m, by sorted index
  float least_spacing_ = 0;
};

Image<vec3> PlainRaycastSurface::filtered(const SurfaceBuffers& buffers, const std::vector<Ray>& rays) const {
  const int radius = field_.options.filter_radius, width = buffers.depth.width(), height = buffers.depth.height();
  const float sigma = 0.5f * static_cast<float>(radius), tolerance = 0.5f * least_spacing_;
  Image<vec3> result(width, height, vec3{0});
  const auto point_at = [&](int x, int y) {
    const Ray& ray = rays[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
    return ray.origin + buffers.depth(x, y) * ray.direction;
  };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      if (!(buffers.depth(x, y) < kInfinity)) continue;
      const vec3 normal = buffers.normal(x, y), point = point_at(x, y);
      vec3 sum{0};
      for (int qy = std::max(y - radius, 0); qy <= std::min(y + radius, height - 1); ++qy)
        for (int qx = std::max(x - radius, 0); qx <= std::min(x + radius, width - 1); ++qx) {
          if (!(buffers.depth(qx, qy) < kInfinity)) continue;
          const float off_plane = glm::dot(normal, point_at(qx, qy) - point) / tolerance;
          const float distance2 = static_cast<float>((qx - x) * (qx - x) + (qy - y) * (qy - y));
          const vec3 other = buffers.normal(qx, qy);
          sum += other * std::exp(-0.5f * distance2 / (sigma * sigma) - 0.5f * off_plane * off_plane -
                                  (1.0f - glm::dot(normal, other)) / kNormalSharpness);
        }
      result(x, y) = glm::normalize(sum);
    }
  return result;
}

}  // namespace

std::unique_ptr<Surface> make_plain_raycast_surface(const Particles& particles, const RaycastOptions& options,
                                                    std::span<const vec3> colours, StageTimes* times,
                                                    const ParticleSizes& sizes) {
  return std::make_unique<PlainRaycastSurface>(particles, resolve_sizes(sizes, options, particles.size()), colours,
                                               times);
}

}  // namespace meniscus
