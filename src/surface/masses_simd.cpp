#include "surface/masses.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surface/masses_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// after highway.h
#include "surface/packet_sums-inl.h"

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

/// Positions of the particles nearer than `reach` to the box. Masses are not looked at: they are being written.
HWY_NOINLINE void gather_positions(const BandGrid& grid, vec3 low, vec3 high, float reach, PacketList& list) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  const Vec low_x = hn::Set(d, low.x), low_y = hn::Set(d, low.y), low_z = hn::Set(d, low.z);
  const Vec high_x = hn::Set(d, high.x), high_y = hn::Set(d, high.y), high_z = hn::Set(d, high.z);
  const Vec reach2 = hn::Set(d, reach * reach), zero = hn::Zero(d);
  const auto outside = [&](Vec v, Vec from, Vec to) {
    return hn::Max(hn::Max(hn::Sub(from, v), hn::Sub(v, to)), zero);
  };
  list.count = 0;
  grid.for_each_run(low - reach, high + reach, [&](std::size_t begin, std::size_t end) {
    list.reserve(list.count + (end - begin) + 2 * kPacket, false);
    for (std::size_t i = begin; i < end; i += lanes) {
      const Vec x = hn::LoadU(d, grid.x() + i), y = hn::LoadU(d, grid.y() + i), z = hn::LoadU(d, grid.z() + i);
      const Vec off_x = outside(x, low_x, high_x), off_y = outside(y, low_y, high_y), off_z = outside(z, low_z, high_z);
      const Vec off2 = hn::MulAdd(off_x, off_x, hn::MulAdd(off_y, off_y, hn::Mul(off_z, off_z)));
      const auto near = hn::And(hn::Lt(off2, reach2), hn::FirstN(d, end - i));
      hn::CompressStore(x, near, d, list.x.data() + list.count);
      hn::CompressStore(y, near, d, list.y.data() + list.count);
      list.count += hn::CompressStore(z, near, d, list.z.data() + list.count);
    }
  });
}

template <class Shape>
HWY_NOINLINE void sum_units(const RaycastField& field, const MassPoints& points, const PacketList& list,
                            float* HWY_RESTRICT density) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  const Vec per_h = hn::Set(d, 1.0f / field.options.smoothing_length), scale = hn::Set(d, field.scale);
  const float *lx = list.x.data(), *ly = list.y.data(), *lz = list.z.data();
  for (std::size_t l = 0; l < points.count; l += lanes) {
    const Vec px = hn::Load(d, points.x + l), py = hn::Load(d, points.y + l), pz = hn::Load(d, points.z + l);
    Vec sum = hn::Zero(d);
    for (std::size_t j = 0; j < list.count; ++j) {
      const Vec x = hn::Sub(px, hn::Set(d, lx[j])), y = hn::Sub(py, hn::Set(d, ly[j])),
                z = hn::Sub(pz, hn::Set(d, lz[j]));
      sum = hn::Add(sum, Shape::at(hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z))), per_h));
    }
    hn::Store(hn::Mul(sum, scale), d, density + l);
  }
}

}  // namespace

void UnitDensities(const RaycastField& field, const MassPoints& points, PacketList& list, float* HWY_RESTRICT density) {
  vec3 low{points.x[0], points.y[0], points.z[0]}, high = low;
  for (std::size_t i = 1; i < points.count; ++i) {
    low = {std::min(low.x, points.x[i]), std::min(low.y, points.y[i]), std::min(low.z, points.z[i])};
    high = {std::max(high.x, points.x[i]), std::max(high.y, points.y[i]), std::max(high.z, points.z[i])};
  }
  gather_positions(field.grid, low, high, field.options.smoothing_length, list);
  switch (field.options.kernel) {
    case Kernel::cubic_spline:
      return sum_units<CubicSplineShape>(field, points, list, density);
    case Kernel::poly6:
      return sum_units<Poly6Shape>(field, points, list, density);
    case Kernel::wyvill:
      return sum_units<WyvillShape>(field, points, list, density);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace meniscus {

HWY_EXPORT(UnitDensities);

void unit_densities(const RaycastField& field, const MassPoints& points, PacketList& list, float* density) {
  HWY_DYNAMIC_DISPATCH(UnitDensities)(field, points, list, density);
}

}  // namespace meniscus
#endif
