#include "surface/surfel_sums.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surface/surfel_sums.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = HWY_CAPPED(float, kPacket);
using Vec = hn::Vec<Tag>;

/// s(a) = W(r) / W(0) of a = (r / h)^2, its first and second derivatives; zero from a = 1 on.
struct Derivatives {
  Vec value, first, second;
};
struct WyvillSlopes {
  /// With t = 1 - a: s = t^2 (5/9 + 4/9 t), s' = -t (10/9 + 12/9 t), s'' = 10/9 + 24/9 t.
  static HWY_INLINE Derivatives at(Vec a) {
    const Tag d;
    const Vec t = hn::Max(hn::Sub(hn::Set(d, 1.0f), a), hn::Zero(d));
    const Vec four = hn::Set(d, 4.0f / 9.0f), ten = hn::Set(d, 10.0f / 9.0f);
    return {hn::Mul(hn::Mul(t, t), hn::MulAdd(four, t, hn::Set(d, 5.0f / 9.0f))),
            hn::Neg(hn::Mul(t, hn::MulAdd(hn::Set(d, 12.0f / 9.0f), t, ten))),
            hn::IfThenElseZero(hn::Gt(t, hn::Zero(d)), hn::MulAdd(hn::Set(d, 24.0f / 9.0f), t, ten))};
  }
};
struct Poly6Slopes {
  static HWY_INLINE Derivatives at(Vec a) {
    const Tag d;
    const Vec t = hn::Max(hn::Sub(hn::Set(d, 1.0f), a), hn::Zero(d));
    const Vec t2 = hn::Mul(t, t);
    return {hn::Mul(t2, t), hn::Mul(hn::Set(d, -3.0f), t2), hn::Mul(hn::Set(d, 6.0f), t)};
  }
};
struct CubicSplineSlopes {
  /// With q = sqrt(a): d/da = 1 / (2 q) d/dq of s = 2 (1 - q)^3 - 8 (1/2 - q)^3.
  static HWY_INLINE Derivatives at(Vec a) {
    const Tag d;
    const Vec zero = hn::Zero(d), one = hn::Set(d, 1.0f);
    const Vec q = hn::Sqrt(hn::Max(a, hn::Set(d, 1e-8f)));
    const Vec outer = hn::Max(hn::Sub(one, q), zero), inner = hn::Max(hn::Sub(hn::Set(d, 0.5f), q), zero);
    const Vec outer2 = hn::Mul(outer, outer), inner2 = hn::Mul(inner, inner);
    const Vec per_2q = hn::Div(hn::Set(d, 0.5f), q);
    const Vec slope = hn::MulSub(hn::Set(d, 24.0f), inner2, hn::Mul(hn::Set(d, 6.0f), outer2));
    const Vec bend = hn::MulSub(hn::Set(d, 12.0f), outer, hn::Mul(hn::Set(d, 48.0f), inner));
    const Vec first = hn::Mul(slope, per_2q);
    // (s_qq - s_q / q) / (4 q^2)
    const Vec second = hn::Mul(hn::Mul(per_2q, per_2q), hn::NegMulAdd(hn::Set(d, 2.0f), first, bend));
    return {hn::MulSub(hn::Mul(outer2, outer), hn::Set(d, 2.0f), hn::Mul(hn::Mul(inner2, inner), hn::Set(d, 8.0f))),
            first, second};
  }
};

template <class Slopes, bool kCurvature>
HWY_INLINE void sum(const RaycastField& field, const PacketList& list, const PacketPoints& points,
                    const PacketTangents* tangents, IsoSums& sums) {
  const Tag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const float h = field.options.smoothing_length;
  const Vec per_h2 = hn::Set(d, 1.0f / (h * h));
  const Vec scale = hn::Set(d, field.scale), slope_scale = hn::Set(d, 2.0f * field.scale / (h * h));
  for (int l = 0; l < kPacket; l += lanes) {
    const Vec px = hn::Load(d, points.x + l), py = hn::Load(d, points.y + l), pz = hn::Load(d, points.z + l);
    Vec tx = px, ty = px, tz = px, ux = px, uy = px, uz = px;
    if (kCurvature) {
      tx = hn::Load(d, tangents->t.x + l), ty = hn::Load(d, tangents->t.y + l), tz = hn::Load(d, tangents->t.z + l);
      ux = hn::Load(d, tangents->u.x + l), uy = hn::Load(d, tangents->u.y + l), uz = hn::Load(d, tangents->u.z + l);
    }
    Vec density = hn::Zero(d), gx = density, gy = density, gz = density;
    Vec even = density, tt = density, uu = density, tu = density;
    for (std::size_t j = 0; j < list.count; ++j) {
      const Vec x = hn::Sub(px, hn::Set(d, list.x.data()[j])), y = hn::Sub(py, hn::Set(d, list.y.data()[j])),
                z = hn::Sub(pz, hn::Set(d, list.z.data()[j]));
      const Vec a = hn::Mul(hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z))), per_h2);
      const Derivatives s = Slopes::at(a);
      const Vec mass = hn::Set(d, list.mass.data()[j]);
      density = hn::MulAdd(s.value, mass, density);
      const Vec first = hn::Mul(s.first, mass);
      gx = hn::MulAdd(first, x, gx);
      gy = hn::MulAdd(first, y, gy);
      gz = hn::MulAdd(first, z, gz);
      if (kCurvature) {
        // t H t = 2 / h^2 sum m (s' + 2 s'' (d . t)^2 / h^2), and so on
        const Vec t = hn::MulAdd(x, tx, hn::MulAdd(y, ty, hn::Mul(z, tz)));
        const Vec u = hn::MulAdd(x, ux, hn::MulAdd(y, uy, hn::Mul(z, uz)));
        const Vec second = hn::Mul(s.second, mass);
        even = hn::Add(even, first);
        tt = hn::MulAdd(hn::Mul(second, t), t, tt);
        uu = hn::MulAdd(hn::Mul(second, u), u, uu);
        tu = hn::MulAdd(hn::Mul(second, t), u, tu);
      }
    }
    gx = hn::Mul(gx, slope_scale);
    gy = hn::Mul(gy, slope_scale);
    gz = hn::Mul(gz, slope_scale);
    hn::Store(hn::Mul(density, scale), d, sums.density + l);
    hn::Store(gx, d, sums.gx + l);
    hn::Store(gy, d, sums.gy + l);
    hn::Store(gz, d, sums.gz + l);
    if (kCurvature) {
      const Vec size = hn::Sqrt(hn::MulAdd(gx, gx, hn::MulAdd(gy, gy, hn::Mul(gz, gz))));
      const Vec per_size = hn::Div(hn::Neg(slope_scale), hn::Max(size, hn::Set(d, 1e-20f)));
      const Vec two_per_h2 = hn::Add(per_h2, per_h2);
      hn::Store(hn::Mul(hn::MulAdd(tt, two_per_h2, even), per_size), d, sums.tt + l);
      hn::Store(hn::Mul(hn::MulAdd(uu, two_per_h2, even), per_size), d, sums.uu + l);
      hn::Store(hn::Mul(hn::Mul(tu, two_per_h2), per_size), d, sums.tu + l);
    }
  }
}

template <class Slopes>
void sum_either(const RaycastField& field, const PacketList& list, const PacketPoints& points,
                const PacketTangents* tangents, IsoSums& sums) {
  if (tangents)
    sum<Slopes, true>(field, list, points, tangents, sums);
  else
    sum<Slopes, false>(field, list, points, tangents, sums);
}

}  // namespace

void IsoSumsOf(const RaycastField& field, const PacketList& list, const PacketPoints& points,
               const PacketTangents* tangents, IsoSums& sums) {
  switch (field.options.kernel) {
    case Kernel::cubic_spline:
      return sum_either<CubicSplineSlopes>(field, list, points, tangents, sums);
    case Kernel::poly6:
      return sum_either<Poly6Slopes>(field, list, points, tangents, sums);
    case Kernel::wyvill:
      return sum_either<WyvillSlopes>(field, list, points, tangents, sums);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace meniscus {

HWY_EXPORT(IsoSumsOf);

void iso_sums(const RaycastField& field, const PacketList& list, const PacketPoints& points,
              const PacketTangents* tangents, IsoSums& sums) {
  HWY_DYNAMIC_DISPATCH(IsoSumsOf)(field, list, points, tangents, sums);
}

}  // namespace meniscus
#endif
