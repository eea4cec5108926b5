#include "surface/normal_filter.h"

#include <algorithm>
#include <cmath>

#include "surface/packet.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surface/normal_filter.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// after highway.h
#include "surface/vector3-inl.h"

#ifndef MENISCUS_SURFACE_NORMAL_FILTER_TILE
#define MENISCUS_SURFACE_NORMAL_FILTER_TILE
namespace meniscus {
namespace {

constexpr int kVector = 16;
/// Pixels that are filtered together: a row of them with the window's border on both sides has kPitch values, so that
/// all rows and components of a tile stay in the second-level cache.
constexpr int kPitch = 336, kTileHeight = 32;
constexpr int tile_width(int radius) { return kPitch - kVector - 2 * radius; }
constexpr float kLog2E = 1.442695041f;

/// One call of the filter.
struct FilterJob {
  const View& view;
  const Image<float>& depth;
  const Image<vec3>& normals;
  int radius;
  float tolerance;
  const float* spatial;  ///< (2 radius + 1)^2 values of -r^2 / (2 sigma^2) - 1 / sharpness, for powers of two
  Image<vec3>& filtered;
};

}  // namespace
}  // namespace meniscus
#endif

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

/// 2^v to 7.5e-5 relative for -100 <= v <= 127; 2^-100 below: products of smaller ones would be subnormal, and slow.
HWY_INLINE Vec power_of_two(Vec v) {
  const Tag d;
  const hn::RebindToSigned<Tag> di;
  // Adding 1.5 * 2^23 leaves the nearest integer in the last bits, from where it goes into the exponent.
  const Vec shift = hn::Set(d, 12582912.0f);
  v = hn::Max(v, hn::Set(d, -100.0f));
  const Vec shifted = hn::Add(v, shift);
  const Vec f = hn::Sub(v, hn::Sub(shifted, shift));
  // Of least relative error for |f| <= 1/2 among the cubic polynomials.
  Vec power = hn::MulAdd(f, hn::Set(d, 0.05517167f), hn::Set(d, 0.24261112f));
  power = hn::MulAdd(f, power, hn::Set(d, 0.69326099f));
  power = hn::MulAdd(f, power, hn::Set(d, 0.99992807f));
  return hn::BitCast(d, hn::Add(hn::BitCast(di, power), hn::ShiftLeft<23>(hn::BitCast(di, shifted))));
}

/// How the distance off a pixel's tangent plane follows from what is kept of another pixel's place.
enum class Places {
  perspective,  ///< the depth along the view's axis, times the normal's product with a ray that is linear in x and y
  parallel,     ///< the depth, times the normal's product with the axis, plus what is linear in x and y
  anywhere      ///< three coordinates
};

/// Points and normals of a tile and the window's border around it: row by row, in a row one component after another.
/// Without surface all are zero, which adds nothing to any sum.
class FilterTile {
 public:
  /// @param x0, y0  the tile's first pixel
  FilterTile(const FilterJob& job, int x0, int y0)
      : job_(job),
        x0_(x0),
        y0_(y0),
        width_(std::min(tile_width(job.radius), job.depth.width() - x0)),
        height_(std::min(kTileHeight, job.depth.height() - y0)) {}

  void run() {
    thread_local AlignedFloats memory;
    const std::size_t size = kRow * static_cast<std::size_t>(height_ + 2 * job_.radius);
    memory.reserve(size, 0);
    values_ = memory.data();
    std::fill_n(values_, size, 0.0f);
    const int first = std::max(y0_ - job_.radius, 0);
    const int last = std::min(y0_ + height_ + job_.radius, job_.depth.height());
    for (int y = first; y < last; ++y) fill_row(y);
    const Projection projection = job_.view.projection;
    for (int y = 0; y < height_; ++y)
      if (projection == Projection::perspective)
        filter_row<Places::perspective>(y);
      else if (projection == Projection::orthographic)
        filter_row<Places::parallel>(y);
      else
        filter_row<Places::anywhere>(y);
  }

 private:
  static constexpr int kComponents = 6;
  static constexpr std::size_t kRow = static_cast<std::size_t>(kComponents) * kPitch;

  /// The first component of a pixel; the others follow at distances of kPitch.
  float* at(int x, int y) const {
    return values_ + static_cast<std::size_t>(y - y0_ + job_.radius) * kRow +
           static_cast<std::size_t>(x - x0_ + job_.radius);
  }

  /// Positions are in units of sqrt(2) tolerance, scaled for powers of two.
  float scale() const { return std::sqrt(0.5f * kLog2E) / job_.tolerance; }

  void fill_row(int y) {
    const Tag d;
    const int lanes = static_cast<int>(hn::Lanes(d));
    const int first = std::max(x0_ - job_.radius, 0);
    const int last = std::min(x0_ + width_ + job_.radius, job_.depth.width());
    const float* depth = job_.depth.row(y);
    const float* normals = &job_.normals.row(y)->x;
    if (job_.view.projection == Projection::cube) return fill_row_of_cube(y, first, last);
    const PictureRays rays(job_.view);
    const bool perspective = job_.view.projection == Projection::perspective;
    const Vec row = hn::Set(d, static_cast<float>(y) + 0.5f), by = hn::Set(d, scale());
    const Vec infinity = hn::Set(d, std::numeric_limits<float>::infinity());
    for (int x = first; x < last; x += lanes) {
      alignas(64) float rest[kVector], rest_normals[3 * kVector];
      const float *t = depth + x, *n = normals + 3 * x;
      if (x + lanes > last) {  // copies, so that no vector reaches past the row
        std::fill_n(rest, kVector, std::numeric_limits<float>::infinity());
        std::fill_n(rest_normals, 3 * kVector, 0.0f);
        std::copy(t, depth + last, rest);
        std::copy(n, normals + 3 * last, rest_normals);
        t = rest;
        n = rest_normals;
      }
      const Vec along = hn::LoadU(d, t);
      const auto hit = hn::Lt(along, infinity);
      if (hn::AllFalse(d, hit)) continue;
      Vec3V normal;
      hn::LoadInterleaved3(d, n, normal.x, normal.y, normal.z);
      Vec place = hn::Mul(along, by);
      if (perspective) {
        const Vec column = hn::Iota(d, static_cast<float>(x) + 0.5f);
        Vec3V direction;
        rays.point(column, row, along, direction);
        place = hn::Mul(place, dot(direction, set(job_.view.forward)));
      }
      const Vec values[] = {normal.x, normal.y, normal.z, place};
      for (int i = 0; i < 4; ++i) hn::StoreU(hn::IfThenElseZero(hit, values[i]), d, at(x, y) + i * kPitch);
    }
  }

  void fill_row_of_cube(int y, int first, int last) {
    for (int x = first; x < last; ++x) {
      const float depth = job_.depth(x, y);
      if (!(depth < std::numeric_limits<float>::infinity())) continue;
      const Ray ray = job_.view.ray({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
      const vec3 point = scale() * (ray.origin - job_.view.eye + depth * ray.direction), normal = job_.normals(x, y);
      const float values[] = {normal.x, normal.y, normal.z, point.x, point.y, point.z};
      for (int i = 0; i < kComponents; ++i) at(x, y)[i * kPitch] = values[i];
    }
  }

  static HWY_INLINE Vec3V normal_at(const float* pixel) {
    const Tag d;
    return {hn::LoadU(d, pixel), hn::LoadU(d, pixel + kPitch), hn::LoadU(d, pixel + 2 * kPitch)};
  }
  static HWY_INLINE Vec3V point_at(const float* pixel) { return normal_at(pixel + 3 * kPitch); }
  static HWY_INLINE Vec place_at(const float* pixel) { return hn::LoadU(Tag(), pixel + 3 * kPitch); }

  template <Places kPlaces>
  HWY_NOINLINE void filter_row(int row) {
    const Tag d;
    const int lanes = static_cast<int>(hn::Lanes(d));
    const Vec zero = hn::Zero(d);
    float* out = &job_.filtered.row(y0_ + row)[x0_].x;
    for (int x = 0; x < width_; x += lanes) {
      const float* centre = at(x0_ + x, y0_ + row);
      const Vec3V n = normal_at(centre);
      const auto hit = hn::Gt(dot(n, n), zero);
      if (hn::AllFalse(d, hit)) continue;
      TangentPlane<kPlaces> plane(job_.view, x0_ + x, y0_ + row, scale(), n, centre);
      const Vec3V sum = window_sum(n, plane, centre);
      const Vec size2 = hn::Max(dot(sum, sum), hn::Set(d, 1e-20f));
      const Vec3V result = scaled(sum, hn::IfThenElseZero(hit, hn::Div(hn::Set(d, 1.0f), hn::Sqrt(size2))));
      if (x + lanes <= width_) {
        hn::StoreInterleaved3(result.x, result.y, result.z, d, out + 3 * x);
      } else {
        alignas(64) float rest[3 * kVector];
        hn::StoreInterleaved3(result.x, result.y, result.z, d, rest);
        std::copy_n(rest, 3 * (width_ - x), out + 3 * x);
      }
    }
  }

  /// Distances of pixels from the tangent planes of a vector of pixels.
  template <Places kPlaces>
  class TangentPlane {
   public:
    HWY_INLINE TangentPlane(const View& view, int x, int y, float scale, Vec3V n, const float* centre) : n_(n) {
      const Tag d;
      const float per_pixel = 2.0f * view.half_height / static_cast<float>(view.height);
      if constexpr (kPlaces == Places::anywhere) {
        origin_ = dot(n, point_at(centre));
        return;
      }
      const float unit = kPlaces == Places::parallel ? scale : 1.0f;
      right_ = hn::Mul(dot(n, set(view.right)), hn::Set(d, unit * per_pixel));
      down_ = hn::Mul(dot(n, set(view.up)), hn::Set(d, -unit * per_pixel));
      along_ = dot(n, set(view.forward));
      origin_ = hn::Mul(place_at(centre), along_);
      if constexpr (kPlaces == Places::perspective) {
        const Vec off_x = hn::Iota(d, static_cast<float>(x) + 0.5f - 0.5f * static_cast<float>(view.width));
        const Vec off_y = hn::Set(d, static_cast<float>(y) + 0.5f - 0.5f * static_cast<float>(view.height));
        along_ = hn::MulAdd(off_x, right_, hn::MulAdd(off_y, down_, along_));
        origin_ = hn::Mul(place_at(centre), along_);
      }
    }

    /// Those of the taps `dy` rows below.
    HWY_INLINE void set_row(int dy) {
      if constexpr (kPlaces == Places::perspective)
        row_ = hn::MulAdd(hn::Set(Tag(), static_cast<float>(dy)), down_, along_);
      else if constexpr (kPlaces == Places::parallel)
        row_ = hn::MulSub(hn::Set(Tag(), static_cast<float>(dy)), down_, origin_);
    }

    HWY_INLINE Vec off(const float* tap, int dx) const {
      const Tag d;
      if constexpr (kPlaces == Places::anywhere) {
        const Vec3V p = point_at(tap);
        return hn::MulAdd(n_.x, p.x, hn::MulAdd(n_.y, p.y, hn::MulSub(n_.z, p.z, origin_)));
      } else {
        const Vec linear = hn::MulAdd(hn::Set(d, static_cast<float>(dx)), right_, row_);
        return kPlaces == Places::perspective ? hn::MulSub(place_at(tap), linear, origin_)
                                              : hn::MulAdd(place_at(tap), along_, linear);
      }
    }

   private:
    Vec3V n_;
    Vec right_, down_, along_, origin_, row_;
  };

  template <Places kPlaces>
  HWY_INLINE Vec3V window_sum(const Vec3V n, TangentPlane<kPlaces>& plane, const float* centre) const {
    const Tag d;
    const Vec3V for_agreement = scaled(n, hn::Set(d, kLog2E / kNormalSharpness));
    const float* spatial = job_.spatial;
    const int radius = job_.radius;
    Vec3V sum = n;
    for (int dy = -radius; dy <= radius; ++dy) {
      const float* row = centre + dy * static_cast<std::ptrdiff_t>(kRow);
      plane.set_row(dy);
      for (int dx = -radius; dx <= radius; ++dx, ++spatial) {
        if (dx == 0 && dy == 0) continue;
        const Vec3V q = normal_at(row + dx);
        const Vec off = plane.off(row + dx, dx);
        Vec exponent = hn::MulAdd(for_agreement.z, q.z, hn::Set(d, *spatial));
        exponent = hn::MulAdd(for_agreement.x, q.x, hn::MulAdd(for_agreement.y, q.y, exponent));
        sum = combined(sum, power_of_two(hn::NegMulAdd(off, off, exponent)), q);
      }
    }
    return sum;
  }

  const FilterJob& job_;
  int x0_, y0_, width_, height_;
  float* values_ = nullptr;
};

}  // namespace

void FilterNormalTile(const FilterJob& job, int x0, int y0) { FilterTile(job, x0, y0).run(); }

}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace meniscus {

HWY_EXPORT(FilterNormalTile);

Image<vec3> filtered_normals(const View& view, const Image<float>& depth, const Image<vec3>& normals, int radius,
                             float tolerance) {
  const int width = depth.width(), height = depth.height();
  const float sigma = 0.5f * static_cast<float>(radius);
  std::vector<float> spatial;
  for (int dy = -radius; dy <= radius; ++dy)
    for (int dx = -radius; dx <= radius; ++dx)
      spatial.push_back(kLog2E *
                        (-0.5f * static_cast<float>(dx * dx + dy * dy) / (sigma * sigma) - 1.0f / kNormalSharpness));
  Image<vec3> filtered(width, height, vec3{0});
  const FilterJob job{view, depth, normals, radius, tolerance, spatial.data(), filtered};
  const auto tiles_x = static_cast<std::size_t>((width + tile_width(radius) - 1) / tile_width(radius));
  const auto tiles_y = static_cast<std::size_t>((height + kTileHeight - 1) / kTileHeight);
  parallel_for(tiles_x * tiles_y, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t tile = begin; tile < end; ++tile) HWY_DYNAMIC_DISPATCH(FilterNormalTile)
    (job, static_cast<int>(tile % tiles_x) * tile_width(radius), static_cast<int>(tile / tiles_x) * kTileHeight);
  });
  return filtered;
}

}  // namespace meniscus
#endif
