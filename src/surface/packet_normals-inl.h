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
#include "surface/vector3-inl.h"

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

/// A symmetric matrix a lane.
struct Symmetric3V {
  Vec xx, yy, zz, xy, xz, yz;
};

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

/// Particles of a list relative to an origin near them and in units of R, with the products that sums need.
struct MomentList {
  static constexpr std::size_t kCapacity = 512;
  enum Array { x, y, z, size2, xx, yy, zz, xy, xz, yz, per2, volume, kArrays };
  alignas(64) float values[kArrays][kCapacity + kPacket];
  std::size_t count = 0;
};

/// The sums of [Xiao2017] eq. 2 to 4, about the list's origin.
struct MomentSums {
  Vec3V gradient, mean;
  Vec slopes, weights;
  Symmetric3V squares;
};

/// 1 / sqrt(v) for weights: to 2^-14 where one instruction gives that, which turns normals by less than 1e-4.
HWY_INLINE Vec weight_root(Vec v) {
#if HWY_TARGET <= HWY_AVX3
  return hn::ApproximateReciprocalSqrt(v);
#else
  return reciprocal_root(v);
#endif
}

/// Adds a list's particles to the sums at points `p`. With sizes, a particle counts by its volume s_j^3 and to its
/// own radius R_j.
template <bool kSizes>
HWY_INLINE void add_moments(const MomentList& list, Vec3V p, MomentSums& sums) {
  const Tag d;
  const Vec zero = hn::Zero(d), one = hn::Set(d, 1.0f), least = hn::Set(d, 1e-6f), p2 = dot(p, p);
  const Vec3V twice = scaled(p, hn::Set(d, -2.0f));
  MomentSums s = sums;
  for (std::size_t j = 0; j < list.count; ++j) {
    const auto of = [&](MomentList::Array array) { return hn::Set(d, list.values[array][j]); };
    const Vec x = of(MomentList::x), y = of(MomentList::y), z = of(MomentList::z);
    Vec q2 = hn::MulAdd(twice.x, x, hn::MulAdd(twice.y, y, hn::MulAdd(twice.z, z, hn::Add(p2, of(MomentList::size2)))));
    if (kSizes) q2 = hn::Mul(q2, of(MomentList::per2));
    q2 = hn::Min(hn::Max(q2, least), one);
    const Vec per_q = weight_root(q2);
    const Vec q = hn::Mul(q2, per_q);
    // Eq. 2 with the spiky kernel: the gradient's size is proportional to (1 - q)^2.
    const Vec rest = hn::Max(hn::Sub(one, q), zero);
    Vec slope = hn::Mul(hn::Mul(rest, rest), per_q);
    // Eq. 3 and 4 with W = 1 - q^3.
    Vec w = hn::Max(hn::NegMulAdd(q2, q, one), zero);
    if (kSizes) {
      slope = hn::Mul(slope, of(MomentList::per2));
      w = hn::Mul(w, of(MomentList::volume));
    }
    s.slopes = hn::Add(s.slopes, slope);
    s.gradient = {hn::MulAdd(slope, x, s.gradient.x), hn::MulAdd(slope, y, s.gradient.y),
                  hn::MulAdd(slope, z, s.gradient.z)};
    s.weights = hn::Add(s.weights, w);
    s.mean = {hn::MulAdd(w, x, s.mean.x), hn::MulAdd(w, y, s.mean.y), hn::MulAdd(w, z, s.mean.z)};
    s.squares.xx = hn::MulAdd(w, of(MomentList::xx), s.squares.xx);
    s.squares.yy = hn::MulAdd(w, of(MomentList::yy), s.squares.yy);
    s.squares.zz = hn::MulAdd(w, of(MomentList::zz), s.squares.zz);
    s.squares.xy = hn::MulAdd(w, of(MomentList::xy), s.squares.xy);
    s.squares.xz = hn::MulAdd(w, of(MomentList::xz), s.squares.xz);
    s.squares.yz = hn::MulAdd(w, of(MomentList::yz), s.squares.yz);
  }
  sums = s;
}

/// Sixteen points and the box around them, relative to an origin and in units of R.
struct MomentPoints {
  vec3 origin;
  float per_radius;
  vec3 low, high;  ///< particles farther than R from this box are passed over
};

/// Fills `moments` from particle `first` on until it is full; returns the first particle that is left.
template <bool kSizes>
HWY_INLINE std::size_t fill_moments(const PacketList& list, const MomentPoints& at, std::size_t first,
                                    MomentList& moments) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  const Vec3V origin = set(at.origin), low = set(at.low), high = set(at.high);
  const Vec per_radius = hn::Set(d, at.per_radius), one = hn::Set(d, 1.0f), zero = hn::Zero(d);
  const auto outside = [&](Vec v, Vec from, Vec to) {
    return hn::Max(hn::Max(hn::Sub(from, v), hn::Sub(v, to)), zero);
  };
  moments.count = 0;
  for (; first < list.count && moments.count + lanes <= MomentList::kCapacity; first += lanes) {
    const Vec x = hn::Mul(hn::Sub(hn::LoadU(d, list.x.data() + first), origin.x), per_radius);
    const Vec y = hn::Mul(hn::Sub(hn::LoadU(d, list.y.data() + first), origin.y), per_radius);
    const Vec z = hn::Mul(hn::Sub(hn::LoadU(d, list.z.data() + first), origin.z), per_radius);
    const Vec3V off{outside(x, low.x, high.x), outside(y, low.y, high.y), outside(z, low.z, high.z)};
    Vec per = one;
    if (kSizes) per = hn::Div(hn::LoadU(d, list.per_normal_radius.data() + first), per_radius);
    const Vec per2 = hn::Mul(per, per);
    const auto near = hn::And(hn::Lt(hn::Mul(dot(off, off), per2), one), hn::FirstN(d, list.count - first));
    const Vec squares[] = {x,
                           y,
                           z,
                           hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z))),
                           hn::Mul(x, x),
                           hn::Mul(y, y),
                           hn::Mul(z, z),
                           hn::Mul(x, y),
                           hn::Mul(x, z),
                           hn::Mul(y, z)};
    for (int a = 0; a < MomentList::per2; ++a)
      hn::StoreU(hn::Compress(squares[a], near), d, moments.values[a] + moments.count);
    if (kSizes) {
      hn::StoreU(hn::Compress(per2, near), d, moments.values[MomentList::per2] + moments.count);
      hn::StoreU(hn::Compress(hn::Div(one, hn::Mul(per2, per)), near), d,
                 moments.values[MomentList::volume] + moments.count);
    }
    moments.count += hn::CountTrue(d, near);
  }
  return first;
}

/// Particles within their radius of each point.
template <bool kSizes>
HWY_NOINLINE void count_neighbours(const PacketList& list, float per_radius, const PacketPoints& points, int l,
                                   float* neighbours) {
  const Tag d;
  const Vec px = hn::Load(d, points.x + l), py = hn::Load(d, points.y + l), pz = hn::Load(d, points.z + l);
  Vec count = hn::Zero(d);
  for (std::size_t j = 0; j < list.count; ++j) {
    const Vec3V off{hn::Sub(hn::Set(d, list.x.data()[j]), px), hn::Sub(hn::Set(d, list.y.data()[j]), py),
                    hn::Sub(hn::Set(d, list.z.data()[j]), pz)};
    const Vec per = hn::Set(d, kSizes ? list.per_normal_radius.data()[j] : per_radius);
    const auto inside = hn::Lt(hn::Mul(dot(off, off), hn::Mul(per, per)), hn::Set(d, 1.0f));
    count = hn::Add(count, hn::IfThenElseZero(inside, hn::Set(d, 1.0f)));
  }
  hn::Store(count, d, neighbours);
}

/// Eq. 5 and 6 from the sums; `planar` masks the lanes with neighbours enough.
template <class Mask>
HWY_INLINE Vec3V blended_normal(const RaycastOptions& options, const MomentSums& sums, Vec3V p, Vec3V towards,
                                Mask enough) {
  const Tag d;
  const Vec zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  const Vec3V outwards =
      combined({hn::Neg(sums.gradient.x), hn::Neg(sums.gradient.y), hn::Neg(sums.gradient.z)}, sums.slopes, p);
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

/// Normals of [Xiao2017] eq. 2 to 6 at sixteen points from those particles of a list that lie near `at`'s box. The
/// points that count lie in that box.
template <bool kSizes>
HWY_NOINLINE void normals_near(const RaycastField& field, const PacketList& list, const MomentPoints& at,
                               const PacketPoints& points, const PacketPoints& towards, PacketPoints& normals) {
  const Tag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  thread_local MomentList moments;
  const Vec zero = hn::Zero(d), per_radius = hn::Set(d, at.per_radius);
  const Vec3V origin = set(at.origin), nothing{zero, zero, zero};
  MomentSums sums[kPacket];  // as many as vectors make a packet
  Vec3V p[kPacket];
  for (int l = 0, v = 0; l < kPacket; l += lanes, ++v) {
    p[v] = {hn::Mul(hn::Sub(hn::Load(d, points.x + l), origin.x), per_radius),
            hn::Mul(hn::Sub(hn::Load(d, points.y + l), origin.y), per_radius),
            hn::Mul(hn::Sub(hn::Load(d, points.z + l), origin.z), per_radius)};
    sums[v] = {nothing, nothing, zero, zero, {zero, zero, zero, zero, zero, zero}};
  }
  for (std::size_t first = 0; first < list.count;) {
    first = fill_moments<kSizes>(list, at, first, moments);
    for (int v = 0; v * lanes < kPacket; ++v) add_moments<kSizes>(moments, p[v], sums[v]);
  }
  for (int l = 0, v = 0; l < kPacket; l += lanes, ++v) {
    // No weight is above one: a sum above four has five neighbours.
    const Vec fewest = hn::Set(d, static_cast<float>(kFewestNeighboursForPca));
    auto enough = hn::Gt(sums[v].weights, hn::Sub(fewest, hn::Set(d, 1.0f)));
    if (kSizes || !hn::AllTrue(d, enough)) {
      alignas(64) float neighbours[kPacket];
      count_neighbours<kSizes>(list, at.per_radius, points, l, neighbours);
      enough = hn::Ge(hn::Load(d, neighbours), fewest);
    }
    const Vec3V out{hn::Load(d, towards.x + l), hn::Load(d, towards.y + l), hn::Load(d, towards.z + l)};
    const Vec3V normal = blended_normal(field.options, sums[v], p[v], out, enough);
    hn::Store(normal.x, d, normals.x + l);
    hn::Store(normal.y, d, normals.y + l);
    hn::Store(normal.z, d, normals.z + l);
  }
}

HWY_INLINE void normals_near(const RaycastField& field, const PacketList& list, const MomentPoints& at,
                             const PacketPoints& points, const PacketPoints& towards, PacketPoints& normals) {
  if (field.has_sizes())
    normals_near<true>(field, list, at, points, towards, normals);
  else
    normals_near<false>(field, list, at, points, towards, normals);
}

/// The same from all of a list that was gathered around some of the points; normals elsewhere mean nothing.
HWY_MAYBE_UNUSED HWY_NOINLINE void normals_from_list(const RaycastField& field, const PacketList& list,
                                                     const PacketPoints& points, const PacketPoints& towards,
                                                     PacketPoints& normals) {
  constexpr float kFar = std::numeric_limits<float>::max();
  const std::size_t middle = list.count / 2;
  const vec3 origin = list.count == 0 ? vec3{points.x[0], points.y[0], points.z[0]}
                                      : vec3{list.x.data()[middle], list.y.data()[middle], list.z.data()[middle]};
  normals_near(field, list, {origin, 1.0f / field.options.normal_radius, vec3{-kFar}, vec3{kFar}}, points, towards,
               normals);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#endif
