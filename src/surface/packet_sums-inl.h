// Sums over a packet's list; included once for each instruction set, after highway.h.

#if defined(MENISCUS_SURFACE_PACKET_SUMS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MENISCUS_SURFACE_PACKET_SUMS_INL_H_
#undef MENISCUS_SURFACE_PACKET_SUMS_INL_H_
#else
#define MENISCUS_SURFACE_PACKET_SUMS_INL_H_
#endif

#include <hwy/highway.h>

#include "base/packing-inl.h"
#include "surface/packet.h"
#include "surface/packet_sizes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = HWY_CAPPED(float, kPacket);
using Vec = hn::Vec<Tag>;

/// 1 / sqrt(v) to nearly float precision by one Newton step; v > 0.
HWY_INLINE Vec reciprocal_root(Vec v) {
  const Tag d;
  const Vec guess = hn::ApproximateReciprocalSqrt(v);
  const Vec half = hn::Mul(hn::Set(d, 0.5f), hn::Mul(v, guess));
  return hn::Mul(guess, hn::NegMulAdd(half, guess, hn::Set(d, 1.5f)));
}

/// Fills the list with the particles nearer than `radius` to the box, in their sorted order.
HWY_MAYBE_UNUSED HWY_NOINLINE void gather_list(const RaycastField& field, vec3 low, vec3 high, float radius,
                                               bool colours, PacketList& list) {
  if (HWY_UNLIKELY(field.has_sizes())) return gather_sizes(field, low, high, radius, colours, list);
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  const BandGrid& grid = field.grid;
  const Vec low_x = hn::Set(d, low.x), low_y = hn::Set(d, low.y), low_z = hn::Set(d, low.z);
  const Vec high_x = hn::Set(d, high.x), high_y = hn::Set(d, high.y), high_z = hn::Set(d, high.z);
  const Vec radius2 = hn::Set(d, radius * radius), zero = hn::Zero(d);
  const auto outside = [&](Vec v, Vec from, Vec to) {
    return hn::Max(hn::Max(hn::Sub(from, v), hn::Sub(v, to)), zero);
  };
  list.count = 0;
  list.near_full = grid.touches_full(low, high);
  grid.for_each_run(low - radius, high + radius, [&](std::size_t begin, std::size_t end) {
    list.reserve(list.count + (end - begin) + 2 * kPacket, colours);
    for (std::size_t i = begin; i < end; i += lanes) {
      const Vec x = hn::LoadU(d, grid.x() + i), y = hn::LoadU(d, grid.y() + i), z = hn::LoadU(d, grid.z() + i);
      const Vec off_x = outside(x, low_x, high_x), off_y = outside(y, low_y, high_y), off_z = outside(z, low_z, high_z);
      const Vec off2 = hn::MulAdd(off_x, off_x, hn::MulAdd(off_y, off_y, hn::Mul(off_z, off_z)));
      // Lanes past the run's end belong to other cells, which may be part of the box and come again.
      const auto near = hn::And(hn::Lt(off2, radius2), hn::FirstN(d, end - i));
      const std::size_t found = hn::CountTrue(d, near);
      if (found == 0) continue;
      const Packing packed(d, near);
      const auto keep = [&](Vec values, const AlignedFloats& to) {
        hn::StoreU(packed(values), d, to.data() + list.count);
      };
      keep(x, list.x);
      keep(y, list.y);
      keep(z, list.z);
      keep(hn::LoadU(d, field.mass.data() + i), list.mass);
      if (colours) {
        keep(hn::LoadU(d, field.red.data() + i), list.red);
        keep(hn::LoadU(d, field.green.data() + i), list.green);
        keep(hn::LoadU(d, field.blue.data() + i), list.blue);
      }
      list.count += found;
    }
  });
}

/// W(r) / W(0) at squared distance r2, by kernel.
struct CubicSplineShape {
  static HWY_INLINE Vec at(Vec r2, Vec per_h) {
    const Tag d;
    const Vec r = hn::Mul(r2, reciprocal_root(hn::Max(r2, hn::Set(d, 1e-30f))));
    const Vec zero = hn::Zero(d);
    const Vec outer = hn::Max(hn::NegMulAdd(r, per_h, hn::Set(d, 1.0f)), zero);
    const Vec inner = hn::Max(hn::NegMulAdd(r, per_h, hn::Set(d, 0.5f)), zero);
    const Vec inner3 = hn::Mul(hn::Mul(inner, inner), hn::Mul(inner, hn::Set(d, 8.0f)));
    return hn::MulSub(hn::Mul(outer, outer), hn::Add(outer, outer), inner3);
  }
};
struct Poly6Shape {
  static HWY_INLINE Vec at(Vec r2, Vec per_h) {
    const Tag d;
    const Vec s = hn::Max(hn::NegMulAdd(r2, hn::Mul(per_h, per_h), hn::Set(d, 1.0f)), hn::Zero(d));
    return hn::Mul(hn::Mul(s, s), s);
  }
};
struct WyvillShape {
  static HWY_INLINE Vec at(Vec r2, Vec per_h) {
    const Tag d;
    const Vec one = hn::Set(d, 1.0f);
    const Vec a = hn::Min(hn::Mul(r2, hn::Mul(per_h, per_h)), one);
    const Vec inner = hn::NegMulAdd(a, hn::Set(d, 4.0f / 9.0f), hn::Set(d, 17.0f / 9.0f));
    return hn::Max(hn::MulAdd(a, hn::MulAdd(a, inner, hn::Set(d, -22.0f / 9.0f)), one), hn::Zero(d));
  }
};

/// Sets rho to one at those of a vector of points that lie where particles in the midst of the water are left out.
HWY_MAYBE_UNUSED HWY_NOINLINE void fill_where_full(const BandGrid& grid, Vec px, Vec py, Vec pz, float* rho) {
  const Tag d;
  alignas(64) float x[kPacket], y[kPacket], z[kPacket];
  hn::Store(px, d, x);
  hn::Store(py, d, y);
  hn::Store(pz, d, z);
  for (std::size_t l = 0; l < hn::Lanes(d); ++l)
    if (grid.full_at({x[l], y[l], z[l]})) rho[l] = 1.0f;
}

/// rho at sixteen points; position(l) gives three vectors from lane l on.
template <class Shape, bool kSizes, class Position>
HWY_INLINE void sum_density(const RaycastField& field, const PacketList& list, Position position, float* rho) {
  const Tag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  Vec per_h = hn::Set(d, 1.0f / field.options.smoothing_length);
  const float *lx = list.x.data(), *ly = list.y.data(), *lz = list.z.data(), *lm = list.mass.data();
  for (int l = 0; l < kPacket; l += lanes) {
    Vec px, py, pz;
    position(l, px, py, pz);
    Vec sum = hn::Zero(d);
    for (std::size_t j = 0; j < list.count; ++j) {
      if constexpr (kSizes) per_h = hn::Set(d, list.per_smoothing.data()[j]);
      const Vec x = hn::Sub(px, hn::Set(d, lx[j])), y = hn::Sub(py, hn::Set(d, ly[j])),
                z = hn::Sub(pz, hn::Set(d, lz[j]));
      const Vec r2 = hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
      sum = hn::MulAdd(Shape::at(r2, per_h), hn::Set(d, lm[j]), sum);
    }
    hn::Store(hn::Mul(sum, hn::Set(d, field.scale)), d, rho + l);
    if (HWY_UNLIKELY(list.near_full)) fill_where_full(field.grid, px, py, pz, rho + l);
  }
}

template <class Position>
HWY_INLINE void sum_density_by_kernel(const RaycastField& field, const PacketList& list, Position position,
                                      float* rho) {
  switch (field.options.kernel) {
    case Kernel::cubic_spline:
      return field.has_sizes() ? sum_density<CubicSplineShape, true>(field, list, position, rho)
                               : sum_density<CubicSplineShape, false>(field, list, position, rho);
    case Kernel::poly6:
      return field.has_sizes() ? sum_density<Poly6Shape, true>(field, list, position, rho)
                               : sum_density<Poly6Shape, false>(field, list, position, rho);
    case Kernel::wyvill:
      return field.has_sizes() ? sum_density<WyvillShape, true>(field, list, position, rho)
                               : sum_density<WyvillShape, false>(field, list, position, rho);
  }
}

HWY_MAYBE_UNUSED HWY_NOINLINE void density_along_rays(const RaycastField& field, const PacketList& list,
                                                      const PacketRays& rays, const float* t, float* rho) {
  const Tag d;
  sum_density_by_kernel(
      field, list,
      [&](int l, Vec& px, Vec& py, Vec& pz) {
        const Vec along = hn::Load(d, t + l);
        px = hn::MulAdd(along, hn::Load(d, rays.dx + l), hn::Load(d, rays.ox + l));
        py = hn::MulAdd(along, hn::Load(d, rays.dy + l), hn::Load(d, rays.oy + l));
        pz = hn::MulAdd(along, hn::Load(d, rays.dz + l), hn::Load(d, rays.oz + l));
      },
      rho);
}

HWY_MAYBE_UNUSED HWY_NOINLINE void density_at_points(const RaycastField& field, const PacketList& list,
                                                     const PacketPoints& points, float* rho) {
  const Tag d;
  sum_density_by_kernel(
      field, list,
      [&](int l, Vec& px, Vec& py, Vec& pz) {
        px = hn::Load(d, points.x + l);
        py = hn::Load(d, points.y + l);
        pz = hn::Load(d, points.z + l);
      },
      rho);
}

/// Averages of the colours, weighted by m_j W(r, h).
HWY_MAYBE_UNUSED HWY_NOINLINE void colours_from_list(const RaycastField& field, const PacketList& list,
                                                     const PacketPoints& points, PacketPoints& colours) {
  const Tag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  Vec per_h = hn::Set(d, 1.0f / field.options.smoothing_length);
  for (int l = 0; l < kPacket; l += lanes) {
    const Vec px = hn::Load(d, points.x + l), py = hn::Load(d, points.y + l), pz = hn::Load(d, points.z + l);
    Vec sum = hn::Set(d, 1e-12f), red = hn::Zero(d), green = hn::Zero(d), blue = hn::Zero(d);
    for (std::size_t j = 0; j < list.count; ++j) {
      if (field.has_sizes()) per_h = hn::Set(d, list.per_smoothing.data()[j]);
      const Vec x = hn::Sub(px, hn::Set(d, list.x.data()[j])), y = hn::Sub(py, hn::Set(d, list.y.data()[j])),
                z = hn::Sub(pz, hn::Set(d, list.z.data()[j]));
      const Vec r2 = hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
      const Vec weight = hn::Mul(CubicSplineShape::at(r2, per_h), hn::Set(d, list.mass.data()[j]));
      sum = hn::Add(sum, weight);
      red = hn::MulAdd(weight, hn::Set(d, list.red.data()[j]), red);
      green = hn::MulAdd(weight, hn::Set(d, list.green.data()[j]), green);
      blue = hn::MulAdd(weight, hn::Set(d, list.blue.data()[j]), blue);
    }
    const Vec norm = hn::Div(hn::Set(d, 1.0f), sum);
    hn::Store(hn::Mul(red, norm), d, colours.x + l);
    hn::Store(hn::Mul(green, norm), d, colours.y + l);
    hn::Store(hn::Mul(blue, norm), d, colours.z + l);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#endif
