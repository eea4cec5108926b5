// Kernels as a march along rays sums them; included once for each instruction set, after highway.h.

#if defined(MENISCUS_SURFACE_PACKET_KERNELS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MENISCUS_SURFACE_PACKET_KERNELS_INL_H_
#undef MENISCUS_SURFACE_PACKET_KERNELS_INL_H_
#else
#define MENISCUS_SURFACE_PACKET_KERNELS_INL_H_
#endif

#include <hwy/highway.h>

#include "surface/packet_sums-inl.h"

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

/// Kernels over W(0) for a march. bracket(s): from s = max(1 - r^2 / h^2, 0), times m, to find between which samples a
/// ray crosses. exact(r2, along, ...): adds m W and m dW/dt, where dr^2/dt = 2 `along`.
struct CubicSplineSamples {
  /// s^3 times a polynomial of least squares over the ball: rms 6e-4, at most 2e-3 of W(0) beyond h / 7.
  static HWY_INLINE Vec bracket(Vec s, Vec mass) {
    const Tag d;
    Vec q = hn::MulAdd(s, hn::Set(d, 0.70379128f), hn::Set(d, 0.02400724f));
    q = hn::MulAdd(s, q, hn::Set(d, -0.07193769f));
    q = hn::MulAdd(s, q, hn::Set(d, 0.33959841f));
    return hn::Mul(hn::Mul(hn::Mul(s, s), hn::Mul(s, mass)), q);
  }
  static HWY_INLINE void exact(Vec r2, Vec along, Vec per_h, Vec mass, Vec& sum, Vec& slope) {
    const Tag d;
    const Vec zero = hn::Zero(d), near = hn::Max(r2, hn::Set(d, 1e-30f));
    const Vec per_r = reciprocal_root(near);
    const Vec q = hn::Mul(hn::Mul(near, per_r), per_h);
    const Vec outer = hn::Max(hn::Sub(hn::Set(d, 1.0f), q), zero);
    const Vec inner = hn::Max(hn::Sub(hn::Set(d, 1.0f), hn::Add(q, q)), zero);  // 8 (1/2 - q)^3 = (1 - 2 q)^3
    const Vec outer2 = hn::Mul(outer, outer), inner2 = hn::Mul(inner, inner);
    sum = hn::MulAdd(mass, hn::MulSub(outer2, hn::Add(outer, outer), hn::Mul(inner2, inner)), sum);
    // dW/dq = 6 ((1 - 2 q)^2 - (1 - q)^2), without the factor 6 / h
    slope = hn::MulAdd(hn::Sub(inner2, outer2), hn::Mul(hn::Mul(along, per_r), hn::Mul(mass, per_h)), slope);
  }
  static constexpr float kSlope = 6.0f;
};
struct Poly6Samples {
  static HWY_INLINE Vec bracket(Vec s, Vec mass) { return hn::Mul(hn::Mul(s, s), hn::Mul(s, mass)); }
  static HWY_INLINE void exact(Vec r2, Vec along, Vec per_h, Vec mass, Vec& sum, Vec& slope) {
    const Tag d;
    const Vec per_h2 = hn::Mul(per_h, per_h);
    const Vec s = hn::Max(hn::NegMulAdd(r2, per_h2, hn::Set(d, 1.0f)), hn::Zero(d));
    const Vec s2 = hn::Mul(hn::Mul(s, s), mass);
    sum = hn::MulAdd(s2, s, sum);
    slope = hn::NegMulAdd(s2, hn::Mul(along, per_h2), slope);
  }
  static constexpr float kSlope = 6.0f;
};
struct WyvillSamples {
  /// 1 - 22/9 a + 17/9 a^2 - 4/9 a^3 with a = 1 - s
  static HWY_INLINE Vec bracket(Vec s, Vec mass) {
    const Tag d;
    return hn::Mul(hn::Mul(hn::Mul(s, s), mass), hn::MulAdd(s, hn::Set(d, 4.0f / 9.0f), hn::Set(d, 5.0f / 9.0f)));
  }
  static HWY_INLINE void exact(Vec r2, Vec along, Vec per_h, Vec mass, Vec& sum, Vec& slope) {
    const Tag d;
    const Vec per_h2 = hn::Mul(per_h, per_h);
    const Vec s = hn::Max(hn::NegMulAdd(r2, per_h2, hn::Set(d, 1.0f)), hn::Zero(d));
    const Vec sm = hn::Mul(s, mass);
    sum = hn::MulAdd(hn::Mul(sm, s), hn::MulAdd(s, hn::Set(d, 4.0f / 9.0f), hn::Set(d, 5.0f / 9.0f)), sum);
    const Vec rise = hn::MulAdd(s, hn::Set(d, 12.0f / 9.0f), hn::Set(d, 10.0f / 9.0f));
    slope = hn::NegMulAdd(hn::Mul(sm, rise), hn::Mul(along, per_h2), slope);
  }
  static constexpr float kSlope = 2.0f;
};

/// Calls visit(shape) with the field's kernel.
template <class Visit>
HWY_INLINE void with_kernel(Kernel kernel, Visit visit) {
  switch (kernel) {
    case Kernel::cubic_spline:
      return visit(CubicSplineSamples{});
    case Kernel::poly6:
      return visit(Poly6Samples{});
    case Kernel::wyvill:
      return visit(WyvillSamples{});
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#endif
