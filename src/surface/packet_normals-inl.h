// Normals of a packet's points; included once for each instruction set, after highway.h.

#if defined(MENISCUS_SURFACE_PACKET_NORMALS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MENISCUS_SURFACE_PACKET_NORMALS_INL_H_
#undef MENISCUS_SURFACE_PACKET_NORMALS_INL_H_
#else
#define MENISCUS_SURFACE_PACKET_NORMALS_INL_H_
#endif

#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include "surface/packet_sums-inl.h"

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

struct Vec3V {
  Vec x, y, z;
};

HWY_INLINE Vec dot(Vec3V a, Vec3V b) { return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z))); }

HWY_INLINE Vec3V scaled(Vec3V a, Vec factor) {
  return {hn::Mul(a.x, factor), hn::Mul(a.y, factor), hn::Mul(a.z, factor)};
}

/// a + factor b
HWY_INLINE Vec3V combined(Vec3V a, Vec factor, Vec3V b) {
  return {hn::MulAdd(factor, b.x, a.x), hn::MulAdd(factor, b.y, a.y), hn::MulAdd(factor, b.z, a.z)};
}

HWY_INLINE Vec3V normalized(Vec3V a) {
  const Tag d;
  return scaled(a, hn::Div(hn::Set(d, 1.0f), hn::Sqrt(hn::Max(dot(a, a), hn::Set(d, 1e-30f)))));
}

/// One rotation of Jacobi's iteration as in formulas/eigen.h, on the entries pp, qq, pq; pr and qr are the other
/// two off-diagonal entries, vp and vq the columns of eigenvectors.
HWY_INLINE void rotate(Vec& pp, Vec& qq, Vec& pq, Vec& pr, Vec& qr, Vec3V& vp, Vec3V& vq) {
  const Tag d;
  const Vec one = hn::Set(d, 1.0f), zero = hn::Zero(d);
  const auto needed = hn::Gt(hn::Abs(pq), hn::Set(d, 1e-30f));
  const Vec theta = hn::Div(hn::Mul(hn::Set(d, 0.5f), hn::Sub(qq, pp)), hn::IfThenElse(needed, pq, one));
  const Vec size = hn::Div(one, hn::Add(hn::Abs(theta), hn::Sqrt(hn::MulAdd(theta, theta, one))));
  const Vec t = hn::IfThenElseZero(needed, hn::IfThenElse(hn::Lt(theta, zero), hn::Neg(size), size));
  const Vec c = hn::Div(one, hn::Sqrt(hn::MulAdd(t, t, one)));
  const Vec s = hn::Mul(t, c), minus_s = hn::Neg(s);
  pp = hn::NegMulAdd(t, pq, pp);
  qq = hn::MulAdd(t, pq, qq);
  pq = zero;
  const Vec keep = pr;
  pr = hn::MulAdd(c, keep, hn::Mul(minus_s, qr));
  qr = hn::MulAdd(s, keep, hn::Mul(c, qr));
  const Vec3V v = vp;
  vp = combined(scaled(v, c), minus_s, vq);
  vq = combined(scaled(v, s), c, vq);
}

/// Normals of [Xiao2017] eq. 2 to 6 at sixteen points from one list.
HWY_NOINLINE void normals_from_list(const RaycastField& field, const PacketList& list, const PacketPoints& points,
                                    const PacketPoints& towards, PacketPoints& normals) {
  const Tag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const RaycastOptions& options = field.options;
  const Vec zero = hn::Zero(d), one = hn::Set(d, 1.0f), per_radius = hn::Set(d, 1.0f / options.normal_radius);
  for (int l = 0; l < kPacket; l += lanes) {
    // Everything in units of R and relative to the point, so that float sums keep their digits.
    const Vec px = hn::Load(d, points.x + l), py = hn::Load(d, points.y + l), pz = hn::Load(d, points.z + l);
    Vec3V gradient{zero, zero, zero}, mean{zero, zero, zero};
    Vec weights = zero, neighbours = zero, xx = zero, yy = zero, zz = zero, xy = zero, xz = zero, yz = zero;
    for (std::size_t j = 0; j < list.count; ++j) {
      const Vec3V off = scaled({hn::Sub(hn::Set(d, list.x.data()[j]), px), hn::Sub(hn::Set(d, list.y.data()[j]), py),
                                hn::Sub(hn::Set(d, list.z.data()[j]), pz)},
                               per_radius);
      const Vec q2 = hn::Max(dot(off, off), hn::Set(d, 1e-12f));
      const Vec per_q = reciprocal_root(q2);
      const Vec q = hn::Mul(q2, per_q);
      const auto inside = hn::Lt(q, one);
      // Eq. 2 with the spiky kernel: the gradient's size is proportional to (1 - q)^2.
      const Vec rest = hn::Max(hn::Sub(one, q), zero);
      gradient = combined(gradient, hn::Mul(hn::Mul(rest, rest), per_q), off);
      // Eq. 3 and 4 with W = 1 - q^3.
      const Vec w = hn::IfThenElseZero(inside, hn::NegMulAdd(q2, q, one));
      neighbours = hn::Add(neighbours, hn::IfThenElseZero(inside, one));
      weights = hn::Add(weights, w);
      const Vec3V weighted = scaled(off, w);
      mean = {hn::Add(mean.x, weighted.x), hn::Add(mean.y, weighted.y), hn::Add(mean.z, weighted.z)};
      xx = hn::MulAdd(weighted.x, off.x, xx);
      yy = hn::MulAdd(weighted.y, off.y, yy);
      zz = hn::MulAdd(weighted.z, off.z, zz);
      xy = hn::MulAdd(weighted.x, off.y, xy);
      xz = hn::MulAdd(weighted.x, off.z, xz);
      yz = hn::MulAdd(weighted.y, off.z, yz);
    }
    const Vec3V fallback{hn::Load(d, towards.x + l), hn::Load(d, towards.y + l), hn::Load(d, towards.z + l)};
    const auto has_gradient = hn::Gt(dot(gradient, gradient), hn::Set(d, 1e-12f));
    Vec3V normal = normalized({hn::Neg(gradient.x), hn::Neg(gradient.y), hn::Neg(gradient.z)});
    normal = {hn::IfThenElse(has_gradient, normal.x, fallback.x), hn::IfThenElse(has_gradient, normal.y, fallback.y),
              hn::IfThenElse(has_gradient, normal.z, fallback.z)};
    if (options.normals != NormalMethod::gradient) {
      const Vec per_weight = hn::Div(one, hn::Max(weights, hn::Set(d, 1e-12f)));
      mean = scaled(mean, per_weight);
      xx = hn::NegMulAdd(mean.x, mean.x, hn::Mul(xx, per_weight));
      yy = hn::NegMulAdd(mean.y, mean.y, hn::Mul(yy, per_weight));
      zz = hn::NegMulAdd(mean.z, mean.z, hn::Mul(zz, per_weight));
      xy = hn::NegMulAdd(mean.x, mean.y, hn::Mul(xy, per_weight));
      xz = hn::NegMulAdd(mean.x, mean.z, hn::Mul(xz, per_weight));
      yz = hn::NegMulAdd(mean.y, mean.z, hn::Mul(yz, per_weight));
      Vec3V vx{one, zero, zero}, vy{zero, one, zero}, vz{zero, zero, one};
      for (int sweep = 0; sweep < 5; ++sweep) {
        rotate(xx, yy, xy, xz, yz, vx, vy);
        rotate(xx, zz, xz, xy, yz, vx, vz);
        rotate(yy, zz, yz, xy, xz, vy, vz);
      }
      const Vec least = hn::Min(hn::Min(xx, yy), zz), largest = hn::Max(hn::Max(xx, yy), zz);
      const Vec middle = hn::Sub(hn::Add(hn::Add(xx, yy), zz), hn::Add(least, largest));
      Vec3V pca = vz;
      const auto x_least = hn::Eq(xx, least), y_least = hn::Eq(yy, least);
      pca = {hn::IfThenElse(y_least, vy.x, pca.x), hn::IfThenElse(y_least, vy.y, pca.y),
             hn::IfThenElse(y_least, vy.z, pca.z)};
      pca = {hn::IfThenElse(x_least, vx.x, pca.x), hn::IfThenElse(x_least, vx.y, pca.y),
             hn::IfThenElse(x_least, vx.z, pca.z)};
      // The eigenvector's sign is open: take the side of the gradient.
      Vec agreement = dot(pca, normal);
      const Vec sign = hn::IfThenElse(hn::Lt(agreement, zero), hn::Neg(one), one);
      agreement = hn::Abs(agreement);
      // Eq. 5 and 6; few or collinear neighbours have no plane.
      Vec w = one;
      if (options.normals == NormalMethod::blend)
        w = hn::Min(one, hn::Exp(d, hn::Mul(hn::Set(d, options.blend_sharpness),
                                            hn::Sub(agreement, hn::Set(d, options.blend_agreement)))));
      const auto planar = hn::And(hn::Ge(neighbours, hn::Set(d, static_cast<float>(kFewestNeighboursForPca))),
                                  hn::Gt(middle, hn::Mul(hn::Set(d, kLeastPcaSpread), largest)));
      w = hn::IfThenElseZero(planar, w);
      normal = normalized(combined(scaled(normal, hn::Sub(one, w)), hn::Mul(w, sign), pca));
    }
    hn::Store(normal.x, d, normals.x + l);
    hn::Store(normal.y, d, normals.y + l);
    hn::Store(normal.z, d, normals.z + l);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#endif
