// Sums over the particles near points that normals follow from; included once for each instruction set, after
// highway.h.

#if defined(MENISCUS_SURFACE_MOMENTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MENISCUS_SURFACE_MOMENTS_INL_H_
#undef MENISCUS_SURFACE_MOMENTS_INL_H_
#else
#define MENISCUS_SURFACE_MOMENTS_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>

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

/// The particles near some points, relative to an origin among these and in units of R. Whole vectors may be read:
/// what is beyond the end is far away. One for each thread, kept from call to call.
struct NearList {
  enum Array { x, y, z, per2, volume, size2, xx, yy, zz, xy, xz, yz, kArrays };
  static constexpr int kPlaces = per2;     ///< arrays before this one are always filled
  static constexpr int kProducts = size2;  ///< arrays from this one on are filled by multiply()
  AlignedFloats values[kArrays];
  std::size_t count = 0;

  float* operator[](Array array) const { return values[array].data(); }
  void reserve(std::size_t wanted) {
    for (AlignedFloats& array : values) array.reserve(wanted, 0);
  }
};

/// The sums of [Xiao2017] eq. 2 to 4, about the list's origin.
struct MomentSums {
  Vec3V gradient, mean;
  Vec slopes, weights;
  Symmetric3V squares;
};

/// 1 / sqrt(v) for weights: to 2^-14 where one instruction gives that, which turns normals by less than 1e-4. Without
/// vectors even an iteration leaves 5e-6, always too little, and drops with two nearly equal axes turn with it.
HWY_INLINE Vec weight_root(Vec v) {
#if HWY_TARGET <= HWY_AVX3
  return hn::ApproximateReciprocalSqrt(v);
#elif HWY_TARGET == HWY_SCALAR
  return hn::Div(hn::Set(Tag(), 1.0f), hn::Sqrt(v));
#else
  return reciprocal_root(v);
#endif
}

/// Points and the box around those that count, relative to an origin and in units of R.
struct MomentPoints {
  vec3 origin;
  float per_radius;
  vec3 low, high;  ///< particles farther than R from this box are passed over
};

/// Fills `near` with those particles of a list that reach into the box. With sizes, a particle reaches as far as its
/// own radius R_j.
template <bool kSizes>
HWY_NOINLINE void find_near(const PacketList& list, const MomentPoints& at, NearList& near) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  const Vec3V origin = set(at.origin), low = set(at.low), high = set(at.high);
  const Vec per_radius = hn::Set(d, at.per_radius), one = hn::Set(d, 1.0f), zero = hn::Zero(d);
  const auto outside = [&](Vec v, Vec from, Vec to) {
    return hn::Max(hn::Max(hn::Sub(from, v), hn::Sub(v, to)), zero);
  };
  near.reserve(list.count + 2 * kPacket);
  std::size_t count = 0;
  const auto keep = [&](Vec values, auto of, NearList::Array array) {
    hn::StoreU(hn::Compress(values, of), d, near[array] + count);
  };
  for (std::size_t i = 0; i < list.count; i += lanes) {
    const Vec x = hn::Mul(hn::Sub(hn::LoadU(d, list.x.data() + i), origin.x), per_radius);
    const Vec y = hn::Mul(hn::Sub(hn::LoadU(d, list.y.data() + i), origin.y), per_radius);
    const Vec z = hn::Mul(hn::Sub(hn::LoadU(d, list.z.data() + i), origin.z), per_radius);
    const Vec3V off{outside(x, low.x, high.x), outside(y, low.y, high.y), outside(z, low.z, high.z)};
    Vec per = one;
    if (kSizes) per = hn::Div(hn::LoadU(d, list.per_normal_radius.data() + i), per_radius);
    const Vec per2 = hn::Mul(per, per);
    const auto reaches = hn::And(hn::Lt(hn::Mul(dot(off, off), per2), one), hn::FirstN(d, list.count - i));
    keep(x, reaches, NearList::x);
    keep(y, reaches, NearList::y);
    keep(z, reaches, NearList::z);
    if (kSizes) {
      keep(per2, reaches, NearList::per2);
      keep(hn::Div(one, hn::Mul(per2, per)), reaches, NearList::volume);
    }
    count += hn::CountTrue(d, reaches);
  }
  near.count = count;
  for (int a = 0; a < (kSizes ? NearList::kProducts : NearList::kPlaces); ++a)
    hn::StoreU(hn::Set(d, a < NearList::kPlaces ? 1e9f : 1.0f), d, near.values[a].data() + count);
}

/// Fills in the products of the particles' coordinates.
HWY_INLINE void multiply(NearList& near) {
  const Tag d;
  for (std::size_t i = 0; i < near.count; i += hn::Lanes(d)) {
    const Vec x = hn::Load(d, near[NearList::x] + i), y = hn::Load(d, near[NearList::y] + i),
              z = hn::Load(d, near[NearList::z] + i);
    const Vec xx = hn::Mul(x, x), yy = hn::Mul(y, y), zz = hn::Mul(z, z);
    hn::Store(hn::Add(xx, hn::Add(yy, zz)), d, near[NearList::size2] + i);
    hn::Store(xx, d, near[NearList::xx] + i);
    hn::Store(yy, d, near[NearList::yy] + i);
    hn::Store(zz, d, near[NearList::zz] + i);
    hn::Store(hn::Mul(x, y), d, near[NearList::xy] + i);
    hn::Store(hn::Mul(x, z), d, near[NearList::xz] + i);
    hn::Store(hn::Mul(y, z), d, near[NearList::yz] + i);
  }
}

/// Weights at q^2 = |x - p_j|^2 / R_j^2, which must be in (0, 1].
struct MomentWeights {
  Vec slope, w;

  HWY_INLINE explicit MomentWeights(Vec q2) {
    const Tag d;
    const Vec per_q = weight_root(q2), q = hn::Mul(q2, per_q);
    // Eq. 2 with the spiky kernel: the gradient's size is proportional to (1 - q)^2, its vector to that over q.
    const Vec rest = hn::Max(hn::Sub(hn::Set(d, 1.0f), q), hn::Zero(d));
    slope = hn::Mul(hn::Mul(rest, rest), per_q);
    // Eq. 3 and 4 with W = 1 - q^3.
    w = hn::Max(hn::NegMulAdd(q2, q, hn::Set(d, 1.0f)), hn::Zero(d));
  }
};
constexpr float kLeastQ2 = 1e-6f;

/// The sums at a vector of points `p`: a particle after the other. With sizes, a particle counts by its volume s_j^3.
template <bool kSizes>
HWY_INLINE MomentSums sums_across_points(const NearList& near, Vec3V p) {
  const Tag d;
  const Vec zero = hn::Zero(d), one = hn::Set(d, 1.0f), least = hn::Set(d, kLeastQ2), p2 = dot(p, p);
  const Vec3V twice = scaled(p, hn::Set(d, -2.0f)), nothing{zero, zero, zero};
  MomentSums s{nothing, nothing, zero, zero, {zero, zero, zero, zero, zero, zero}};
  for (std::size_t j = 0; j < near.count; ++j) {
    const auto of = [&](NearList::Array array) { return hn::Set(d, near[array][j]); };
    const Vec x = of(NearList::x), y = of(NearList::y), z = of(NearList::z);
    Vec q2 = hn::MulAdd(twice.x, x, hn::MulAdd(twice.y, y, hn::MulAdd(twice.z, z, hn::Add(p2, of(NearList::size2)))));
    if (kSizes) q2 = hn::Mul(q2, of(NearList::per2));
    auto [slope, w] = MomentWeights(hn::Min(hn::Max(q2, least), one));
    if (kSizes) {
      slope = hn::Mul(slope, of(NearList::per2));
      w = hn::Mul(w, of(NearList::volume));
    }
    s.slopes = hn::Add(s.slopes, slope);
    s.gradient = {hn::MulAdd(slope, x, s.gradient.x), hn::MulAdd(slope, y, s.gradient.y),
                  hn::MulAdd(slope, z, s.gradient.z)};
    s.weights = hn::Add(s.weights, w);
    s.mean = {hn::MulAdd(w, x, s.mean.x), hn::MulAdd(w, y, s.mean.y), hn::MulAdd(w, z, s.mean.z)};
    s.squares.xx = hn::MulAdd(w, of(NearList::xx), s.squares.xx);
    s.squares.yy = hn::MulAdd(w, of(NearList::yy), s.squares.yy);
    s.squares.zz = hn::MulAdd(w, of(NearList::zz), s.squares.zz);
    s.squares.xy = hn::MulAdd(w, of(NearList::xy), s.squares.xy);
    s.squares.xz = hn::MulAdd(w, of(NearList::xz), s.squares.xz);
    s.squares.yz = hn::MulAdd(w, of(NearList::yz), s.squares.yz);
  }
  return s;
}

/// The particles within reach of one point, relative to it.
struct PointList {
  AlignedFloats x, y, z, per2, volume;
  void reserve(std::size_t wanted, bool sizes) {
    for (AlignedFloats* array : {&x, &y, &z}) array->reserve(wanted, 0);
    if (!sizes) return;
    per2.reserve(wanted, 0);
    volume.reserve(wanted, 0);
  }
};

/// The sums at up to sixteen points, each about its point; by lane.
struct PointSums {
  enum Sum { gradient_x, gradient_y, gradient_z, weights, mean_x, mean_y, mean_z, xx, yy, zz, xy, xz, yz, kSums };
  alignas(64) float values[kSums][kPacket] = {};
  alignas(64) float neighbours[kPacket] = {};

  HWY_INLINE MomentSums at(int l) const {
    const Tag d;
    const auto of = [&](Sum sum) { return hn::Load(d, values[sum] + l); };
    return {{of(gradient_x), of(gradient_y), of(gradient_z)},
            {of(mean_x), of(mean_y), of(mean_z)},
            hn::Zero(d),
            of(weights),
            {of(xx), of(yy), of(zz), of(xy), of(xz), of(yz)}};
  }
};

/// Sums of the lanes of up to sixteen vectors.
HWY_INLINE void sum_lanes(const Vec (&v)[16], float* sums) {
  const Tag d;
#if HWY_TARGET <= HWY_AVX3
  // Vectors are folded into one another, so that each step serves two: first lanes of a block of four, then blocks.
  const hn::Repartition<double, Tag> pairs;
  const auto folded = [&](Vec a, Vec b)
                          HWY_ATTR { return hn::Add(hn::InterleaveLower(d, a, b), hn::InterleaveUpper(d, a, b)); };
  const auto folded_pairs = [&](Vec a, Vec b) HWY_ATTR {
    const auto x = hn::BitCast(pairs, a), y = hn::BitCast(pairs, b);
    return hn::Add(hn::BitCast(d, hn::InterleaveLower(pairs, x, y)), hn::BitCast(d, hn::InterleaveUpper(pairs, x, y)));
  };
  const auto folded_halves = [&](Vec a, Vec b) HWY_ATTR {
    return hn::Add(hn::ConcatLowerLower(d, b, a), hn::ConcatUpperUpper(d, b, a));
  };
  Vec four[4];
  for (int k = 0; k < 4; ++k)
    four[k] = folded_pairs(folded(v[4 * k], v[4 * k + 1]), folded(v[4 * k + 2], v[4 * k + 3]));
  alignas(64) float out[32];
  for (int k = 0; k < 2; ++k) {
    const Vec halves = folded_halves(four[2 * k], four[2 * k + 1]);
    hn::Store(hn::Add(halves, hn::SwapAdjacentBlocks(halves)), d, out + 16 * k);
  }
  for (int k = 0; k < 4; ++k) std::copy_n(out + 8 * k, 4, sums + 4 * k);
#else
  for (int k = 0; k < 16; ++k) sums[k] = hn::GetLane(hn::SumOfLanes(d, v[k]));
#endif
}

/// Lane `l` of the sums, at a point p: the particles within reach are picked from the list first.
template <bool kSizes>
HWY_INLINE void sums_at_point(const NearList& near, vec3 p, PointList& own, int l, PointSums& sums) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  const Vec px = hn::Set(d, p.x), py = hn::Set(d, p.y), pz = hn::Set(d, p.z), one = hn::Set(d, 1.0f);
  own.reserve(near.count + 2 * kPacket, kSizes);
  float *ox = own.x.data(), *oy = own.y.data(), *oz = own.z.data();
  std::size_t count = 0;
  for (std::size_t j = 0; j < near.count; j += lanes) {
    const Vec3V off{hn::Sub(hn::Load(d, near[NearList::x] + j), px), hn::Sub(hn::Load(d, near[NearList::y] + j), py),
                    hn::Sub(hn::Load(d, near[NearList::z] + j), pz)};
    Vec q2 = dot(off, off);
    if (kSizes) q2 = hn::Mul(q2, hn::Load(d, near[NearList::per2] + j));
    const auto inside = hn::Lt(q2, one);
    hn::StoreU(hn::Compress(off.x, inside), d, ox + count);
    hn::StoreU(hn::Compress(off.y, inside), d, oy + count);
    hn::StoreU(hn::Compress(off.z, inside), d, oz + count);
    if (kSizes) {
      hn::StoreU(hn::Compress(hn::Load(d, near[NearList::per2] + j), inside), d, own.per2.data() + count);
      hn::StoreU(hn::Compress(hn::Load(d, near[NearList::volume] + j), inside), d, own.volume.data() + count);
    }
    count += hn::CountTrue(d, inside);
  }
  // What fills up the last vector lies just out of reach.
  const Vec zero = hn::Zero(d);
  hn::StoreU(one, d, ox + count);
  hn::StoreU(zero, d, oy + count);
  hn::StoreU(zero, d, oz + count);
  if (kSizes) {
    hn::StoreU(one, d, own.per2.data() + count);
    hn::StoreU(zero, d, own.volume.data() + count);
  }
  Vec s[16];
  std::fill_n(s, 16, zero);
  for (std::size_t j = 0; j < count; j += lanes) {
    const Vec x = hn::Load(d, ox + j), y = hn::Load(d, oy + j), z = hn::Load(d, oz + j);
    Vec q2 = hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
    if (kSizes) q2 = hn::Mul(q2, hn::Load(d, own.per2.data() + j));
    auto [slope, w] = MomentWeights(hn::Max(q2, hn::Set(d, kLeastQ2)));
    if (kSizes) {
      slope = hn::Mul(slope, hn::Load(d, own.per2.data() + j));
      w = hn::Mul(w, hn::Load(d, own.volume.data() + j));
    }
    const Vec wx = hn::Mul(w, x), wy = hn::Mul(w, y), wz = hn::Mul(w, z);
    s[PointSums::gradient_x] = hn::MulAdd(slope, x, s[PointSums::gradient_x]);
    s[PointSums::gradient_y] = hn::MulAdd(slope, y, s[PointSums::gradient_y]);
    s[PointSums::gradient_z] = hn::MulAdd(slope, z, s[PointSums::gradient_z]);
    s[PointSums::weights] = hn::Add(s[PointSums::weights], w);
    s[PointSums::mean_x] = hn::Add(s[PointSums::mean_x], wx);
    s[PointSums::mean_y] = hn::Add(s[PointSums::mean_y], wy);
    s[PointSums::mean_z] = hn::Add(s[PointSums::mean_z], wz);
    s[PointSums::xx] = hn::MulAdd(wx, x, s[PointSums::xx]);
    s[PointSums::yy] = hn::MulAdd(wy, y, s[PointSums::yy]);
    s[PointSums::zz] = hn::MulAdd(wz, z, s[PointSums::zz]);
    s[PointSums::xy] = hn::MulAdd(wx, y, s[PointSums::xy]);
    s[PointSums::xz] = hn::MulAdd(wx, z, s[PointSums::xz]);
    s[PointSums::yz] = hn::MulAdd(wy, z, s[PointSums::yz]);
  }
  alignas(64) float total[16];
  sum_lanes(s, total);
  for (int k = 0; k < PointSums::kSums; ++k) sums.values[k][l] = total[k];
  sums.neighbours[l] = static_cast<float>(count);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#endif
