#include "surface/density_tile.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surface/density_tile.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = HWY_CAPPED(float, 16);
using Vec = hn::Vec<Tag>;

/// The kernels as functions of t = 1 - (r / h)^2, where t > 0, times a mass: W(r) / W(0) m. No row of a disc needs a
/// square root, except for the cubic spline.
struct Wyvill {
  /// [Iwasaki2008] eq. 1 in factors: (1 - a^2)^2 (1 - 4/9 a^2) = t^2 (5/9 + 4/9 t).
  HWY_INLINE explicit Wyvill(float mass)
      : constant(hn::Set(Tag(), 5.0f / 9.0f * mass)), linear(hn::Set(Tag(), 4.0f / 9.0f * mass)) {}
  HWY_INLINE Vec add(Vec t, Vec sum) const { return hn::MulAdd(hn::Mul(t, t), hn::MulAdd(linear, t, constant), sum); }
  Vec constant, linear;
};
struct Poly6 {
  HWY_INLINE explicit Poly6(float mass) : mass(hn::Set(Tag(), mass)) {}
  HWY_INLINE Vec add(Vec t, Vec sum) const { return hn::MulAdd(hn::Mul(t, t), hn::Mul(t, mass), sum); }
  Vec mass;
};
struct CubicSpline {
  HWY_INLINE explicit CubicSpline(float mass) : mass(hn::Set(Tag(), mass)) {}
  HWY_INLINE Vec add(Vec t, Vec sum) const {
    const Tag d;
    const Vec zero = hn::Zero(d), one = hn::Set(d, 1.0f);
    const Vec q = hn::Sqrt(hn::Max(hn::Sub(one, t), zero));
    const Vec outer = hn::Sub(one, q), inner = hn::Max(hn::Sub(hn::Set(d, 0.5f), q), zero);
    const Vec inner3 = hn::Mul(hn::Mul(inner, inner), hn::Mul(inner, hn::Set(d, 8.0f)));
    return hn::MulAdd(hn::MulSub(hn::Mul(outer, outer), hn::Add(outer, outer), inner3), mass, sum);
  }
  Vec mass;
};

/// First and last index of the points within `half` of `centre`, cut to [0, n).
struct Span {
  HWY_INLINE Span(float centre, float half, int n)
      : first(static_cast<int>(std::ceil(std::max(centre - half, 0.0f)))),
        last(static_cast<int>(std::floor(std::min(centre + half, static_cast<float>(n - 1))))) {}
  int first, last;
};

/// One vector of points in each of some planes, row after row.
/// @param disc  1 - (z / h)^2 of each plane
template <int kPlanes, class Kernel>
HWY_INLINE void splat_rows(float* HWY_RESTRICT row, std::size_t row_pitch, std::size_t plane_pitch, int rows, float dy,
                           float step_y, const float* disc, Vec x2, const Kernel kernel) {
  const Tag d;
  const Vec zero = hn::Zero(d);
  const Vec t0 = hn::Sub(hn::Set(d, disc[0]), x2), t1 = hn::Sub(hn::Set(d, disc[kPlanes > 1 ? 1 : 0]), x2),
            t2 = hn::Sub(hn::Set(d, disc[kPlanes > 2 ? 2 : 0]), x2),
            t3 = hn::Sub(hn::Set(d, disc[kPlanes > 3 ? 3 : 0]), x2);
  const auto add = [&](Vec t, Vec y2, float* HWY_RESTRICT at)
                       HWY_ATTR { hn::StoreU(kernel.add(hn::Max(hn::Sub(t, y2), zero), hn::LoadU(d, at)), d, at); };
  for (; rows > 0; --rows, row += row_pitch, dy += step_y) {
    const Vec y2 = hn::Set(d, dy * dy);
    add(t0, y2, row);
    if (kPlanes > 1) add(t1, y2, row + plane_pitch);
    if (kPlanes > 2) add(t2, y2, row + 2 * plane_pitch);
    if (kPlanes > 3) add(t3, y2, row + 3 * plane_pitch);
  }
}

/// One metaball: the discs in which it meets the planes of the box, four planes at a time, by columns as wide as a
/// vector; one column where the ball is no wider.
/// @param x, y, z  of the centre, in steps from the box's first point
/// @param reach    h in steps
template <class Kernel>
HWY_INLINE void splat_ball(const DensityTile& tile, vec3 per_h, vec3 reach, float x, float y, float z,
                           const Kernel kernel) {
  const Tag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const Span columns(x, reach.x, tile.nx), planes(z, reach.z, tile.nz);
  for (int k = planes.first; k <= planes.last; k += 4) {
    const int count = std::min(4, planes.last - k + 1);
    float disc[4], largest = 0.0f;
    for (int p = 0; p < count; ++p) {
      const float dz = (static_cast<float>(k + p) - z) * per_h.z;
      disc[p] = 1.0f - dz * dz;
      largest = std::max(largest, disc[p]);
    }
    for (int i = columns.first; i <= columns.last; i += lanes) {
      // The widest disc's rows within this column.
      const float nearest = std::max(std::max(static_cast<float>(i) - x, x - static_cast<float>(i + lanes - 1)), 0.0f);
      const float widest = largest - nearest * nearest * per_h.x * per_h.x;
      if (!(widest > 0.0f)) continue;
      const Span rows(y, std::sqrt(widest) * reach.y, tile.ny);
      const Vec dx = hn::Mul(hn::Iota(d, static_cast<float>(i) - x), hn::Set(d, per_h.x));
      const Vec x2 = hn::Mul(dx, dx);
      float* HWY_RESTRICT row = tile.values + static_cast<std::size_t>(k) * tile.plane_pitch +
                                static_cast<std::size_t>(rows.first) * tile.row_pitch + i;
      const float dy = (static_cast<float>(rows.first) - y) * per_h.y;
      const auto splat = [&](auto planes_at_once) HWY_ATTR {
        splat_rows<planes_at_once.value>(row, tile.row_pitch, tile.plane_pitch, rows.last - rows.first + 1, dy, per_h.y,
                                         disc, x2, kernel);
      };
      if (count == 4)
        splat(std::integral_constant<int, 4>());
      else if (count == 3)
        splat(std::integral_constant<int, 3>());
      else if (count == 2)
        splat(std::integral_constant<int, 2>());
      else
        splat(std::integral_constant<int, 1>());
    }
  }
}

template <class Kernel>
void splat_balls(const RaycastField& field, const DensityTile& tile) {
  const BandGrid& grid = field.grid;
  const float h = field.options.smoothing_length;
  const vec3 per_step = 1.0f / tile.step, per_h = tile.step / h;
  const vec3 last = vec3{tile.nx - 1, tile.ny - 1, tile.nz - 1};
  const vec3 reach = h * per_step;
  grid.for_each_run(tile.low - h, tile.low + last * tile.step + h, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const float x = (grid.x()[i] - tile.low.x) * per_step.x, y = (grid.y()[i] - tile.low.y) * per_step.y,
                  z = (grid.z()[i] - tile.low.z) * per_step.z;
      if (x < -reach.x || x > last.x + reach.x || y < -reach.y || y > last.y + reach.y || z < -reach.z ||
          z > last.z + reach.z)
        continue;
      splat_ball(tile, per_h, reach, x, y, z, Kernel(field.mass[i] * field.scale));
    }
  });
}

}  // namespace

void SplatIntoTile(const RaycastField& field, const DensityTile& tile) {
  for (int k = 0; k < tile.nz; ++k)
    for (int j = 0; j < tile.ny; ++j)
      std::fill_n(
          tile.values + static_cast<std::size_t>(k) * tile.plane_pitch + static_cast<std::size_t>(j) * tile.row_pitch,
          tile.nx, 0.0f);
  switch (field.options.kernel) {
    case meniscus::Kernel::cubic_spline:
      return splat_balls<CubicSpline>(field, tile);
    case meniscus::Kernel::poly6:
      return splat_balls<Poly6>(field, tile);
    case meniscus::Kernel::wyvill:
      return splat_balls<Wyvill>(field, tile);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace meniscus {

HWY_EXPORT(SplatIntoTile);

void splat_into_tile(const RaycastField& field, const DensityTile& tile) {
  HWY_DYNAMIC_DISPATCH(SplatIntoTile)(field, tile);
}

}  // namespace meniscus
#endif
