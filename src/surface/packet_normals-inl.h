// Normals of a packet's points; included once for each instruction set, after highway.h.

#if defined(MENISCUS_SURFACE_PACKET_NORMALS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MENISCUS_SURFACE_PACKET_NORMALS_INL_H_
#undef MENISCUS_SURFACE_PACKET_NORMALS_INL_H_
#else
#define MENISCUS_SURFACE_PACKET_NORMALS_INL_H_
#endif

#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include "surface/moments-inl.h"
#include "surface/packet_sums-inl.h"
#include "surface/vector3-inl.h"

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

struct LeastEigenV {
  Vec3V direction;      ///< unit; zero where the two lesser eigenvalues are equal
  Vec middle, largest;  ///< eigenvalues
};

/// The unit eigenvector of the least eigenvalue of positive semidefinite matrices of trace one, as
/// formulas/eigen.h's least_eigen(): the least root of the characteristic polynomial by Laguerre's method, which comes
/// to it from below without passing it, then the largest cross product of two rows of C - lambda.
HWY_INLINE LeastEigenV least_eigenvector(Symmetric3V c) {
  const Tag d;
  const Vec zero = hn::Zero(d), one = hn::Set(d, 1.0f), two = hn::Set(d, 2.0f), three = hn::Set(d, 3.0f);
  const Vec minor_x = hn::NegMulAdd(c.yz, c.yz, hn::Mul(c.yy, c.zz));
  const Vec minor_y = hn::NegMulAdd(c.xz, c.xz, hn::Mul(c.xx, c.zz));
  const Vec minor_z = hn::NegMulAdd(c.xy, c.xy, hn::Mul(c.xx, c.yy));
  const Vec c1 = hn::Add(minor_x, hn::Add(minor_y, minor_z));
  const Vec side_y = hn::MulSub(c.yz, c.xz, hn::Mul(c.xy, c.zz)), side_z = hn::MulSub(c.xy, c.yz, hn::Mul(c.yy, c.xz));
  const Vec c0 = hn::MulAdd(c.xx, minor_x, hn::MulAdd(c.xy, side_y, hn::Mul(c.xz, side_z)));
  // f = l^3 - l^2 + c1 l - c0 with f' and f''.
  Vec least = zero;
  for (int i = 0; i < 4; ++i) {
    const Vec f = hn::MulSub(least, hn::MulAdd(least, hn::Sub(least, one), c1), c0);
    const Vec slope = hn::MulAdd(least, hn::MulSub(three, least, two), c1);
    const Vec bend = hn::MulSub(hn::Set(d, 6.0f), least, two);
    const Vec root =
        hn::Sqrt(hn::Max(hn::Mul(two, hn::MulSub(hn::Mul(two, slope), slope, hn::Mul(three, hn::Mul(f, bend)))), zero));
    // Where two roots meet the slope vanishes and f is rounding: steps stay small, and between the bounds.
    const Vec step = hn::Div(f, hn::Max(hn::Add(slope, root), hn::Set(d, 1e-5f)));
    least = hn::Min(hn::Max(hn::NegMulAdd(three, step, least), zero), hn::Set(d, 1.0f / 3.0f));
  }
  const Vec rest = hn::Sub(one, least), product = hn::NegMulAdd(least, rest, c1);
  LeastEigenV result;
  const Vec spread = hn::Sqrt(hn::Max(hn::NegMulAdd(hn::Set(d, 4.0f), product, hn::Mul(rest, rest)), zero));
  result.largest = hn::Mul(hn::Set(d, 0.5f), hn::Add(rest, spread));
  result.middle = hn::Sub(rest, result.largest);

  const Vec xx = hn::Sub(c.xx, least), yy = hn::Sub(c.yy, least), zz = hn::Sub(c.zz, least);
  const Vec xy = hn::MulSub(c.xz, c.yz, hn::Mul(c.xy, zz)), xz = hn::MulSub(c.xy, c.yz, hn::Mul(c.xz, yy)),
            yz = hn::MulSub(c.xy, c.xz, hn::Mul(c.yz, xx));
  const Vec3V rows_yz{hn::MulSub(yy, zz, hn::Mul(c.yz, c.yz)), xy, xz};
  const Vec3V rows_xz{xy, hn::MulSub(xx, zz, hn::Mul(c.xz, c.xz)), yz};
  const Vec3V rows_xy{xz, yz, hn::MulSub(xx, yy, hn::Mul(c.xy, c.xy))};
  // The cross products are the columns of the adjugate, which is a multiple of v v^T.
  Vec3V v = either(hn::Gt(dot(rows_xz, rows_xz), dot(rows_yz, rows_yz)), rows_xz, rows_yz);
  v = either(hn::Gt(dot(rows_xy, rows_xy), dot(v, v)), rows_xy, v);
  const Vec size2 = dot(v, v);
  result.direction = scaled(v, hn::IfThenElseZero(hn::Gt(size2, hn::Set(d, 1e-18f)),
                                                  hn::Div(one, hn::Sqrt(hn::Max(size2, hn::Set(d, 1e-30f))))));
  return result;
}

/// Eq. 5 and 6 from the sums; `planar` masks the lanes with neighbours enough.
template <class Mask>
HWY_INLINE Vec3V blended_normal(const RaycastOptions& options, const MomentSums& sums, Vec3V towards, Mask enough) {
  const Tag d;
  const Vec zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  const Vec3V outwards{hn::Neg(sums.gradient.x), hn::Neg(sums.gradient.y), hn::Neg(sums.gradient.z)};
  const auto has_gradient = hn::Gt(dot(outwards, outwards), hn::Set(d, 1e-10f));
  const Vec3V normal = either(has_gradient, normalized(outwards), towards);
  if (options.normals == NormalMethod::gradient) return normal;
  const Vec per_weight = hn::Div(one, hn::Max(sums.weights, hn::Set(d, 1e-12f)));
  const Vec3V mean = scaled(sums.mean, per_weight);
  Symmetric3V c{hn::NegMulAdd(mean.x, mean.x, hn::Mul(sums.squares.xx, per_weight)),
                hn::NegMulAdd(mean.y, mean.y, hn::Mul(sums.squares.yy, per_weight)),
                hn::NegMulAdd(mean.z, mean.z, hn::Mul(sums.squares.zz, per_weight)),
                hn::NegMulAdd(mean.x, mean.y, hn::Mul(sums.squares.xy, per_weight)),
                hn::NegMulAdd(mean.x, mean.z, hn::Mul(sums.squares.xz, per_weight)),
                hn::NegMulAdd(mean.y, mean.z, hn::Mul(sums.squares.yz, per_weight))};
  const Vec trace = hn::Add(c.xx, hn::Add(c.yy, c.zz));
  // Neighbours in one place have no plane; what is left of their trace is rounding.
  const auto spread = hn::Gt(trace, hn::Set(d, 1e-5f));
  const Vec per_trace = hn::IfThenElseZero(spread, hn::Div(one, hn::Max(trace, hn::Set(d, 1e-5f))));
  for (Vec* entry : {&c.xx, &c.yy, &c.zz, &c.xy, &c.xz, &c.yz}) *entry = hn::Mul(*entry, per_trace);
  const LeastEigenV eigen = least_eigenvector(c);
  // The eigenvector's sign is open: take the side of the gradient.
  Vec agreement = dot(eigen.direction, normal);
  const Vec sign = hn::IfThenElse(hn::Lt(agreement, zero), hn::Neg(one), one);
  agreement = hn::Abs(agreement);
  Vec w = one;
  if (options.normals == NormalMethod::blend)
    w = hn::Min(one, hn::Exp(d, hn::Mul(hn::Set(d, options.blend_sharpness),
                                        hn::Sub(agreement, hn::Set(d, options.blend_agreement)))));
  // Few or collinear neighbours have no plane, nor have those that are spread alike along two directions.
  const auto planar = hn::And(hn::And(enough, hn::Gt(dot(eigen.direction, eigen.direction), hn::Set(d, 0.5f))),
                              hn::Gt(eigen.middle, hn::Mul(hn::Set(d, kLeastPcaSpread), eigen.largest)));
  w = hn::IfThenElseZero(planar, w);
  return normalized(combined(scaled(normal, hn::Sub(one, w)), hn::Mul(w, sign), eigen.direction));
}

/// Normals of [Xiao2017] eq. 2 to 6 at the points of a mask, which lie in `at`'s box, from those particles of a list
/// that lie near it; normals of other lanes mean nothing.
template <bool kSizes>
HWY_NOINLINE void normals_near(const RaycastField& field, const PacketList& list, const MomentPoints& at,
                               const PacketPoints& points, PacketMask mask, const PacketPoints& towards,
                               PacketPoints& normals) {
  const Tag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  thread_local NearList near, own;
  find_near<kSizes>(list, at, near);
  PointSums sums;
  for (int first = 0; first < kPacket; first += kFour) {
    const PacketMask some = mask >> first & 0xfu;
    if (some == 0) continue;
    // Points that do not count are copies of one that does.
    alignas(16) float x[kFour], y[kFour], z[kFour];
    for (int k = 0; k < kFour; ++k) {
      const int l = first + ((some >> k & 1u) != 0 ? k : __builtin_ctz(some));
      const vec3 p = at.per_radius * (vec3{points.x[l], points.y[l], points.z[l]} - at.origin);
      x[k] = p.x, y[k] = p.y, z[k] = p.z;
    }
    sums_at_four<kSizes>(near, x, y, z, own, first, sums);
  }
  const Vec fewest = hn::Set(d, static_cast<float>(kFewestNeighboursForPca));
  for (int l = 0; l < kPacket; l += lanes) {
    if ((mask >> l & ((1u << lanes) - 1u)) == 0) continue;
    const Vec3V out{hn::Load(d, towards.x + l), hn::Load(d, towards.y + l), hn::Load(d, towards.z + l)};
    const auto enough = hn::Ge(hn::Load(d, sums.neighbours + l), fewest);
    const Vec3V normal = blended_normal(field.options, sums.at(l), out, enough);
    hn::Store(normal.x, d, normals.x + l);
    hn::Store(normal.y, d, normals.y + l);
    hn::Store(normal.z, d, normals.z + l);
  }
}

HWY_INLINE void normals_near(const RaycastField& field, const PacketList& list, const MomentPoints& at,
                             const PacketPoints& points, PacketMask mask, const PacketPoints& towards,
                             PacketPoints& normals) {
  if (field.has_sizes())
    normals_near<true>(field, list, at, points, mask, towards, normals);
  else
    normals_near<false>(field, list, at, points, mask, towards, normals);
}

/// The same from all of a list that was gathered around some of the points; normals elsewhere mean nothing.
HWY_MAYBE_UNUSED HWY_NOINLINE void normals_from_list(const RaycastField& field, const PacketList& list,
                                                     const PacketPoints& points, const PacketPoints& towards,
                                                     PacketPoints& normals) {
  constexpr float kFar = std::numeric_limits<float>::max();
  const std::size_t middle = list.count / 2;
  const vec3 origin = list.count == 0 ? vec3{points.x[0], points.y[0], points.z[0]}
                                      : vec3{list.x.data()[middle], list.y.data()[middle], list.z.data()[middle]};
  constexpr PacketMask kAll = (1u << kPacket) - 1u;
  normals_near(field, list, {origin, 1.0f / field.options.normal_radius, vec3{-kFar}, vec3{kFar}}, points, kAll,
               towards, normals);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#endif
