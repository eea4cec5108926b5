// The water under a height field as a surface: what is seen of it is found by rays.
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <type_traits>

#include "surface/height_field_packet.h"
#include "surface/packet_rays.h"

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// @throws Error invalid_argument
HeightField checked(HeightField field) {
  const auto fail = [](std::string problem, std::string expected, std::string found) {
    throw Error(ErrorCode::invalid_argument,
                ErrorDetail{std::move(problem), std::move(expected), std::move(found), {}, {}, {}, {}});
  };
  if (field.empty()) return field;
  const int width = field.height.width(), height = field.height.height();
  if (width < 2 || height < 2)
    fail("a height field is too narrow", "2 x 2 points or more", fmt::format("{} x {} points", width, height));
  if (!(field.step.x > 0 && field.step.y > 0) || !std::isfinite(field.step.x + field.step.y) ||
      !std::isfinite(field.low.x + field.low.y) || !std::isfinite(field.floor))
    fail("a height field has no place", "steps > 0 and finite bounds",
         fmt::format("steps {} and {} m", field.step.x, field.step.y));
  for (const float level : field.height)
    if (!(level < kInfinity))
      fail("a height field has a height that is none", "finite heights", fmt::format("{}", level));
  if (!field.colour.empty() && field.colour.size() != field.height.size())
    fail("a height field has colours of another size", fmt::format("{} x {}", width, height),
         fmt::format("{} x {}", field.colour.width(), field.colour.height()));
  if (field.normal.width() != width || field.normal.height() != height) find_normals(field);
  return field;
}

class HeightFieldSurface final : public Surface {
 public:
  HeightFieldSurface(HeightField field, bool sides, bool want_thickness)
      : rays_(checked(std::move(field)), sides), bounds_(rays_.field().bounds()), want_thickness_(want_thickness) {}

  SurfaceBuffers see(const View& view, std::span<const vec2> points, StageTimes* times) const override {
    StageTimer timer(times, "march");
    SurfaceBuffers seen = blank(view, points);
    seen.eye_in_water = view.projection != Projection::orthographic &&
                        rays_.body().inside(rays_.body().field_ray({view.eye, view.forward}), 0);
    if (seen.eye_in_water)
      for_each_ray(view, points, [&](std::size_t i, const Ray& ray) { look(view, ray, i, seen); });
    else if (!points.empty())
      parallel_for(points.size(), 1024, [&](std::size_t begin, std::size_t end) {
        PacketRays rays;
        for (std::size_t i = begin; i < end; i += kPacket)
          look(view, rays, point_rays(view, points, i, rays), seen, i, kPacketWidth);
      });
    else
      look_at_picture(view, seen);
    return seen;
  }

  Image<float> thickness(const View& view, std::span<const vec2> points, StageTimes* times) const override {
    StageTimer timer(times, "thickness");
    Image<float> values = image_of(view, points, 0.0f);
    for_each_ray(view, points, [&](std::size_t i, const Ray& ray) {
      const FieldRay in_field = rays_.body().field_ray(ray);
      const FieldStretch stretch = rays_.body().clipped(in_field, 0, static_cast<double>(kInfinity));
      if (stretch.found()) values[i] = static_cast<float>(rays_.body().length(in_field, stretch.begin, stretch.end));
    });
    return values;
  }

  float spacing() const override { return rays_.field().spacing; }

  bool can_march() const override { return true; }

  void crossings(std::span<const Ray> rays, std::span<const float> from, std::span<const float> limit,
                 std::span<const std::uint8_t> inside, std::span<Crossing> found) const override {
    if (from.size() != rays.size() || limit.size() != rays.size() || inside.size() != rays.size() ||
        found.size() != rays.size())
      throw Error(ErrorCode::invalid_argument, "the lists of rays to follow have different lengths");
    parallel_for(rays.size(), 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const float start = std::max(from[i], 0.0f);
        found[i] = inside[i] ? rays_.out_of(rays[i], start, limit[i]) : rays_.into(rays[i], start, limit[i]);
      }
    });
  }

  Bounds bounds() const override { return bounds_; }

  const HeightField* height_field() const override { return &rays_.field(); }

 private:
  template <class T>
  static Image<T> image_of(const View& view, std::span<const vec2> points, T fill) {
    if (points.empty()) return Image<T>(view.width, view.height, fill);
    return Image<T>(static_cast<int>(points.size()), 1, fill);
  }

  SurfaceBuffers blank(const View& view, std::span<const vec2> points) const {
    SurfaceBuffers seen;
    seen.depth = image_of(view, points, kInfinity);
    seen.normal = image_of(view, points, vec3{0.0f});
    seen.thickness = image_of(view, points, 0.0f);
    seen.coverage = image_of(view, points, 0.0f);
    if (!rays_.field().colour.empty()) seen.colour = image_of(view, points, vec3{0.0f});
    return seen;
  }

  /// Calls visit(index, ray) for all pixels or points.
  template <class Visit>
  static void for_each_ray(const View& view, std::span<const vec2> points, Visit visit) {
    if (!points.empty()) {
      parallel_for(points.size(), 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) visit(i, view.ray(points[i]));
      });
      return;
    }
    const auto width = static_cast<std::size_t>(view.width);
    parallel_for(static_cast<std::size_t>(view.height), 4, [&](std::size_t begin, std::size_t end) {
      for (std::size_t y = begin; y < end; ++y)
        for (std::size_t x = 0; x < width; ++x)
          visit(y * width + x, view.ray({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f}));
    });
  }

  void look_at_picture(const View& view, SurfaceBuffers& seen) const {
    const int rows = (view.height + kPacketHeight - 1) / kPacketHeight;
    const auto width = static_cast<std::size_t>(view.width);
    parallel_for(static_cast<std::size_t>(rows), 4, [&](std::size_t begin, std::size_t end) {
      PacketRays rays;
      for (int y = static_cast<int>(begin) * kPacketHeight; y < static_cast<int>(end) * kPacketHeight;
           y += kPacketHeight)
        for (int x = 0; x < view.width; x += kPacketWidth) {
          const PacketMask mask = picture_rays(view, x, y, rays);
          look(view, rays, mask, seen, static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x), width);
        }
    });
  }

  /// Sixteen rays: lane l is pixel or point first + l % 8 + (l / 8) stride.
  void look(const View& view, const PacketRays& rays, PacketMask mask, SurfaceBuffers& seen, std::size_t first,
            std::size_t stride) const {
    const auto index = [&](int l) {
      return first + static_cast<std::size_t>(l / kPacketWidth) * stride + static_cast<std::size_t>(l % kPacketWidth);
    };
    FieldHits hits;
    enter_packet(rays_, rays, mask, want_thickness_, hits);
    for (int l = 0; l < kPacket; l += kPacketWidth) {
      const PacketMask row = (hits.hit >> l) & ((1u << kPacketWidth) - 1u);
      if (row == 0) continue;
      if (row == (1u << kPacketWidth) - 1u)
        keep(hits, l, std::integral_constant<int, kPacketWidth>(), seen, index(l));
      else
        for (PacketMask rest = row; rest != 0; rest &= rest - 1) {
          const int k = l + __builtin_ctz(rest);
          keep(hits, k, std::integral_constant<int, 1>(), seen, index(k));
        }
    }
    if (!seen.colour.empty())
      for_each_lane(hits.hit, [&](int l) {
        seen.colour[index(l)] = rays_.colour(rays_.body().field_ray(ray(rays, l)), static_cast<double>(hits.depth[l]));
      });
    for_each_lane(hits.unmeasured, [&](int l) {
      const FieldRay in_field = rays_.body().field_ray(ray(rays, l));
      const FieldStretch stretch =
          rays_.body().clipped(in_field, static_cast<double>(hits.depth[l]), static_cast<double>(kInfinity));
      seen.thickness[index(l)] = static_cast<float>(rays_.body().length(in_field, stretch.begin, stretch.end));
    });
    for_each_lane(hits.unsettled, [&](int l) { look(view, ray(rays, l), index(l), seen); });
  }

  /// Writes `Count` lanes from lane l on to the pixels from i on.
  template <int Count>
  void keep(const FieldHits& hits, int l, std::integral_constant<int, Count>, SurfaceBuffers& seen,
            std::size_t i) const {
    std::copy_n(hits.depth + l, Count, seen.depth.data() + i);
    std::copy_n(hits.normal + 3 * l, 3 * Count, &seen.normal[i].x);
    std::fill_n(seen.coverage.data() + i, Count, 1.0f);
    if (want_thickness_) std::copy_n(hits.thickness + l, Count, seen.thickness.data() + i);
  }

  template <class Visit>
  static void for_each_lane(PacketMask mask, Visit visit) {
    for (; mask != 0; mask &= mask - 1) visit(__builtin_ctz(mask));
  }

  static Ray ray(const PacketRays& rays, int l) {
    return {{rays.ox[l], rays.oy[l], rays.oz[l]}, {rays.dx[l], rays.dy[l], rays.dz[l]}};
  }

  /// One ray by itself.
  void look(const View& view, const Ray& ray, std::size_t i, SurfaceBuffers& seen) const {
    const FieldRay in_field = rays_.body().field_ray(ray);
    const FieldStretch stretch = rays_.body().clipped(in_field, 0, static_cast<double>(kInfinity));
    if (!stretch.found()) return;
    FieldChange change;
    if (seen.eye_in_water)
      change = rays_.leave(in_field, 0, static_cast<double>(kInfinity));
    else if (view.projection == Projection::orthographic && rays_.body().inside(in_field, 0))
      change = {0, Face::start};  // the face that the view's plane cuts
    else
      change = rays_.enter(in_field, stretch, static_cast<double>(kInfinity));
    const double from = seen.eye_in_water || !change.found() ? stretch.begin : change.t;
    if (want_thickness_) seen.thickness[i] = static_cast<float>(rays_.body().length(in_field, from, stretch.end));
    if (!change.found()) return;
    seen.depth[i] = static_cast<float>(std::max(change.t, 0.0));
    seen.normal[i] = rays_.normal(ray, in_field, change, !seen.eye_in_water);
    seen.coverage[i] = 1.0f;
    if (!seen.colour.empty()) seen.colour[i] = rays_.colour(in_field, change.t);
  }

  HeightFieldRays rays_;
  Bounds bounds_;  ///< asked for with every batch of rays
  bool want_thickness_;
};

}  // namespace

std::unique_ptr<Surface> make_height_field_surface(HeightField field, bool sides, bool want_thickness) {
  return std::make_unique<HeightFieldSurface>(std::move(field), sides, want_thickness);
}

}  // namespace meniscus
