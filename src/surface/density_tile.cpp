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

/// One metaball: the discs in which it meets the planes of the box, row by row, the points of a row by vectors.
/// Vectors reach past a disc's rim, where t is cut off at zero, but not past the ends of the box's rows.
/// @param x, y, z  of the centre, in steps from the box's first point
template <class Kernel>
HWY_INLINE void splat_ball(const DensityTile& tile, vec3 per_h, float x, float y, float z, const Kernel kernel) {
  const Tag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const Vec zero = hn::Zero(d);
  const Span columns(x, 1.0f / per_h.x, tile.nx), planes(z, 1.0f / per_h.z, tile.nz);
  if (columns.first > columns.last) return;
  const int vectors = (columns.last - columns.first) / lanes + 1;
  const int start = std::max(std::min(columns.first, tile.nx - vectors * lanes), 0);
  const auto offset2 = [&](int column) {
    const Vec dx = hn::Mul(hn::Add(hn::Iota(d, static_cast<float>(column) - x), zero), hn::Set(d, per_h.x));
    return hn::Mul(dx, dx);
  };
  const Vec first2 = offset2(start);
  for (int k = planes.first; k <= planes.last; ++k) {
    const float dz = (static_cast<float>(k) - z) * per_h.z;
    const float disc = 1.0f - dz * dz;
    if (!(disc > 0.0f)) continue;
    const Span rows(y, std::sqrt(disc) / per_h.y, tile.ny);
    float* HWY_RESTRICT row = tile.values + static_cast<std::size_t>(k) * tile.plane_pitch +
                              static_cast<std::size_t>(rows.first) * tile.row_pitch;
    float dy = (static_cast<float>(rows.first) - y) * per_h.y;
    if (vectors == 1 && start + lanes <= tile.nx) {
      for (int j = rows.first; j <= rows.last; ++j, row += tile.row_pitch, dy += per_h.y) {
        const Vec t = hn::Max(hn::Sub(hn::Set(d, disc - dy * dy), first2), zero);
        hn::StoreU(kernel.add(t, hn::LoadU(d, row + start)), d, row + start);
      }
      continue;
    }
    for (int j = rows.first; j <= rows.last; ++j, row += tile.row_pitch, dy += per_h.y) {
      const float left = disc - dy * dy;
      if (!(left > 0.0f)) continue;
      const Span inside(x, std::sqrt(left) / per_h.x, tile.nx);
      const Vec row_t = hn::Set(d, left);
      for (int i = inside.first; i <= inside.last; i += lanes) {
        const Vec t = hn::Max(hn::Sub(row_t, offset2(i)), zero);
        const int rest = tile.nx - i;
        if (rest >= lanes) {
          hn::StoreU(kernel.add(t, hn::LoadU(d, row + i)), d, row + i);
        } else {
          const auto mask = hn::FirstN(d, static_cast<std::size_t>(rest));
          hn::BlendedStore(kernel.add(t, hn::MaskedLoad(mask, d, row + i)), mask, d, row + i);
        }
      }
    }
  }
}

template <class Kernel>
void splat_balls(const RaycastField& field, const DensityTile& tile) {
  const ParticleGrid& grid = field.grid;
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
      splat_ball(tile, per_h, x, y, z, Kernel(field.mass[i] * field.scale));
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
