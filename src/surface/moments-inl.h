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

#include "base/packing-inl.h"
#include "surface/fours-inl.h"
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
  AlignedFloats x, y, z;
  AlignedFloats per2, volume;  ///< R^2 / R_j^2 and s_j^3 by that of R, of particles with sizes
  std::size_t count = 0;

  void reserve(std::size_t wanted, bool sizes) {
    for (AlignedFloats* array : {&x, &y, &z}) array->reserve(wanted, 0);
    if (!sizes) return;
    per2.reserve(wanted, 0);
    volume.reserve(wanted, 0);
  }
  /// Fills up the last vector with particles at a place.
  HWY_INLINE void end(bool sizes, vec3 place) const {
    const Tag d;
    const auto fill = [&](const AlignedFloats& array, float value) {
      hn::StoreU(hn::Set(d, value), d, array.data() + count);
    };
    fill(x, place.x);
    fill(y, place.y);
    fill(z, place.z);
    if (!sizes) return;
    fill(per2, 1.0f);
    fill(volume, 0.0f);
  }
};

/// The sums of [Xiao2017] eq. 2 to 4, about each point.
struct MomentSums {
  Vec3V gradient, mean;
  Vec weights;
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
  near.reserve(list.count + 2 * kPacket, kSizes);
  near.count = 0;
  const auto keep = [&](Vec values, const auto& packed, const AlignedFloats& array) {
    hn::StoreU(packed(values), d, array.data() + near.count);
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
    const Packing packed(d, reaches);
    keep(x, packed, near.x);
    keep(y, packed, near.y);
    keep(z, packed, near.z);
    if (kSizes) {
      keep(per2, packed, near.per2);
      keep(hn::Div(one, hn::Mul(per2, per)), packed, near.volume);
    }
    near.count += hn::CountTrue(d, reaches);
  }
  near.end(kSizes, vec3{1e9f});
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
            of(weights),
            {of(xx), of(yy), of(zz), of(xy), of(xz), of(yz)}};
  }
};

/// Lanes first .. first + 3 of the sums, at four points x, y, z: the particles within reach of any of them are picked
/// from the list, and each is added at all four, whose copies stand side by side.
template <bool kSizes>
HWY_INLINE void sums_at_four(const NearList& near, const float* x, const float* y, const float* z, NearList& own,
                             int first, PointSums& sums) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  const Vec zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  // All within the ball around their middle.
  const vec3 middle = 0.25f * vec3{x[0] + x[1] + x[2] + x[3], y[0] + y[1] + y[2] + y[3], z[0] + z[1] + z[2] + z[3]};
  float apart2 = 0;
  for (int k = 0; k < kFour; ++k) {
    const vec3 off = vec3{x[k], y[k], z[k]} - middle;
    apart2 = std::max(apart2, off.x * off.x + off.y * off.y + off.z * off.z);
  }
  const float apart = std::sqrt(apart2) + 1e-5f;
  const Vec mx = hn::Set(d, middle.x), my = hn::Set(d, middle.y), mz = hn::Set(d, middle.z);
  Vec reach2 = hn::Set(d, (1.0f + apart) * (1.0f + apart));
  own.reserve(near.count + 2 * kPacket, kSizes);
  own.count = 0;
  const auto keep = [&](Vec values, const auto& packed, const AlignedFloats& array) {
    hn::StoreU(packed(values), d, array.data() + own.count);
  };
  for (std::size_t j = 0; j < near.count; j += lanes) {
    const Vec3V at{hn::Load(d, near.x.data() + j), hn::Load(d, near.y.data() + j), hn::Load(d, near.z.data() + j)};
    const Vec3V off{hn::Sub(at.x, mx), hn::Sub(at.y, my), hn::Sub(at.z, mz)};
    if constexpr (kSizes) {
      const Vec reach = hn::Add(hn::Div(one, hn::Sqrt(hn::Load(d, near.per2.data() + j))), hn::Set(d, apart));
      reach2 = hn::Mul(reach, reach);
    }
    const auto inside = hn::Lt(dot(off, off), reach2);
    const Packing packed(d, inside);
    keep(at.x, packed, own.x);
    keep(at.y, packed, own.y);
    keep(at.z, packed, own.z);
    if constexpr (kSizes) {
      keep(hn::Load(d, near.per2.data() + j), packed, own.per2);
      keep(hn::Load(d, near.volume.data() + j), packed, own.volume);
    }
    own.count += hn::CountTrue(d, inside);
  }
  own.end(kSizes, middle + vec3{apart + 1.5f, 0, 0});  // out of reach, but not far: rounding may weigh it
  for (int v = 0; v * static_cast<int>(lanes) < kFour * kCopies; ++v) {
    const Vec px = copied(x, v), py = copied(y, v), pz = copied(z, v);
    Vec s[16], neighbours = zero;
    std::fill_n(s, 16, zero);
    for (std::size_t j = 0; j < own.count; j += kCopies) {
      const Vec rx = hn::Sub(side_by_side(own.x.data() + j), px), ry = hn::Sub(side_by_side(own.y.data() + j), py),
                rz = hn::Sub(side_by_side(own.z.data() + j), pz);
      Vec q2 = hn::MulAdd(rx, rx, hn::MulAdd(ry, ry, hn::Mul(rz, rz)));
      if constexpr (kSizes) q2 = hn::Mul(q2, side_by_side(own.per2.data() + j));
      neighbours = hn::Add(neighbours, hn::IfThenElseZero(hn::Lt(q2, one), one));
      auto [slope, w] = MomentWeights(hn::Min(hn::Max(q2, hn::Set(d, kLeastQ2)), one));
      if constexpr (kSizes) {
        slope = hn::Mul(slope, side_by_side(own.per2.data() + j));
        w = hn::Mul(w, side_by_side(own.volume.data() + j));
      }
      const Vec wx = hn::Mul(w, rx), wy = hn::Mul(w, ry), wz = hn::Mul(w, rz);
      s[PointSums::gradient_x] = hn::MulAdd(slope, rx, s[PointSums::gradient_x]);
      s[PointSums::gradient_y] = hn::MulAdd(slope, ry, s[PointSums::gradient_y]);
      s[PointSums::gradient_z] = hn::MulAdd(slope, rz, s[PointSums::gradient_z]);
      s[PointSums::weights] = hn::Add(s[PointSums::weights], w);
      s[PointSums::mean_x] = hn::Add(s[PointSums::mean_x], wx);
      s[PointSums::mean_y] = hn::Add(s[PointSums::mean_y], wy);
      s[PointSums::mean_z] = hn::Add(s[PointSums::mean_z], wz);
      s[PointSums::xx] = hn::MulAdd(wx, rx, s[PointSums::xx]);
      s[PointSums::yy] = hn::MulAdd(wy, ry, s[PointSums::yy]);
      s[PointSums::zz] = hn::MulAdd(wz, rz, s[PointSums::zz]);
      s[PointSums::xy] = hn::MulAdd(wx, ry, s[PointSums::xy]);
      s[PointSums::xz] = hn::MulAdd(wx, rz, s[PointSums::xz]);
      s[PointSums::yz] = hn::MulAdd(wy, rz, s[PointSums::yz]);
    }
    const int blocks = static_cast<int>(lanes) / kCopies, lane = first + v * blocks;
    alignas(64) float total[4 * kPacket];
    for (int k = 0; k < PointSums::kSums; k += 4) {
      sum_copies(s[k], s[k + 1], s[k + 2], s[k + 3], total);
      for (int r = 0; r < blocks; ++r)
        for (int of = 0; of < 4 && k + of < PointSums::kSums; ++of) sums.values[k + of][lane + r] = total[4 * r + of];
    }
    sum_copies(neighbours, zero, zero, zero, total);
    for (int r = 0; r < blocks; ++r) sums.neighbours[lane + r] = total[4 * r];
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#endif
