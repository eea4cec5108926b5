// Density and its slope along sixteen rays; included once for each instruction set, after highway.h.

#if defined(MENISCUS_SURFACE_PACKET_SLOPES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MENISCUS_SURFACE_PACKET_SLOPES_INL_H_
#undef MENISCUS_SURFACE_PACKET_SLOPES_INL_H_
#else
#define MENISCUS_SURFACE_PACKET_SLOPES_INL_H_
#endif

#include <hwy/highway.h>

#include "surface/packet_kernels-inl.h"

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

/// rho and its derivative along the rays, 1/m, at t m along them.
template <class Shape, bool kSizes>
HWY_INLINE void sum_slopes(const RaycastField& field, const PacketList& list, const PacketRays& rays, const float* t,
                           float* rho, float* slope) {
  const Tag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  Vec per_h = hn::Set(d, 1.0f / field.options.smoothing_length);
  for (int l = 0; l < kPacket; l += lanes) {
    const Vec along = hn::Load(d, t + l), dx = hn::Load(d, rays.dx + l), dy = hn::Load(d, rays.dy + l),
              dz = hn::Load(d, rays.dz + l);
    const Vec px = hn::MulAdd(along, dx, hn::Load(d, rays.ox + l));
    const Vec py = hn::MulAdd(along, dy, hn::Load(d, rays.oy + l));
    const Vec pz = hn::MulAdd(along, dz, hn::Load(d, rays.oz + l));
    Vec sum = hn::Zero(d), slopes = hn::Zero(d);
    for (std::size_t j = 0; j < list.count; ++j) {
      const Vec x = hn::Sub(px, hn::Set(d, list.x.data()[j])), y = hn::Sub(py, hn::Set(d, list.y.data()[j])),
                z = hn::Sub(pz, hn::Set(d, list.z.data()[j]));
      if (kSizes) per_h = hn::Set(d, list.per_smoothing.data()[j]);
      const Vec r2 = hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
      const Vec across = hn::MulAdd(x, dx, hn::MulAdd(y, dy, hn::Mul(z, dz)));
      Shape::exact(r2, across, per_h, hn::Set(d, list.mass.data()[j]), sum, slopes);
    }
    hn::Store(hn::Mul(sum, hn::Set(d, field.scale)), d, rho + l);
    hn::Store(hn::Mul(slopes, hn::Set(d, field.scale * Shape::kSlope)), d, slope + l);
  }
}

HWY_NOINLINE void density_slopes(const RaycastField& field, const PacketList& list, const PacketRays& rays,
                                 const float* t, float* rho, float* slope) {
  with_kernel(field.options.kernel, [&](auto shape) {
    if (field.has_sizes())
      sum_slopes<decltype(shape), true>(field, list, rays, t, rho, slope);
    else
      sum_slopes<decltype(shape), false>(field, list, rays, t, rho, slope);
  });
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#endif
