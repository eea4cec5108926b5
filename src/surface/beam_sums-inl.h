// Density at places along four rays of a beam; included once for each instruction set, after highway.h.

#if defined(MENISCUS_SURFACE_BEAM_SUMS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MENISCUS_SURFACE_BEAM_SUMS_INL_H_
#undef MENISCUS_SURFACE_BEAM_SUMS_INL_H_
#else
#define MENISCUS_SURFACE_BEAM_SUMS_INL_H_
#endif

#include <hwy/highway.h>

#include "surface/beam_gather-inl.h"
#include "surface/fours-inl.h"
#include "surface/packet_kernels-inl.h"

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

constexpr int kRaySamples = 4;  ///< summed at once
static_assert(kFour * kRaySamples == kPacket);

/// Four of a packet's rays.
class FourRays {
 public:
  FourRays(const PacketRays& rays, int first) : rays_(rays), first_(first) {}

  /// Lanes l and after of sixteen points of which lane 4 k + r lies at t[r] + k step of ray r.
  HWY_INLINE void samples(const float* t, float step, int l, Vec& x, Vec& y, Vec& z) const {
    alignas(64) static constexpr float kSample[kPacket] = {0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3};
    const Tag d;
    const Vec at = hn::MulAdd(hn::Load(d, kSample + l), hn::Set(d, step), in_turn(t, l));
    place(
        at, [&](const float* values) { return in_turn(values + first_, l); }, x, y, z);
  }

  /// Places t[r] in vector v of those that hold each of the four kCopies times over, and the rays' directions.
  struct Copies {
    Vec x, y, z, dx, dy, dz;
  };
  HWY_INLINE Copies copies(const float* t, int v) const {
    Copies of;
    place(
        copied(t, v), [&](const float* values) { return copied(values + first_, v); }, of.x, of.y, of.z);
    of.dx = copied(rays_.dx + first_, v);
    of.dy = copied(rays_.dy + first_, v);
    of.dz = copied(rays_.dz + first_, v);
    return of;
  }

 private:
  template <class Get>
  HWY_INLINE void place(Vec at, Get get, Vec& x, Vec& y, Vec& z) const {
    x = hn::MulAdd(at, get(rays_.dx), get(rays_.ox));
    y = hn::MulAdd(at, get(rays_.dy), get(rays_.oy));
    z = hn::MulAdd(at, get(rays_.dz), get(rays_.oz));
  }
  static HWY_INLINE Vec in_turn(const float* values, int l) {
    const Tag d;
    return kCopies == 1 ? hn::LoadU(d, values + l % kFour) : hn::LoadDup128(d, values);
  }

  const PacketRays& rays_;
  int first_;
};

/// Shape::bracket() as a kernel that sum_density() takes.
template <class Shape>
struct BracketShape {
  static HWY_INLINE Vec at(Vec r2, Vec per_h) {
    const Tag d;
    const Vec one = hn::Set(d, 1.0f);
    return Shape::bracket(hn::Max(hn::NegMulAdd(r2, hn::Mul(per_h, per_h), one), hn::Zero(d)), one);
  }
};

/// rho to 1e-3 at sixteen places, rho[4 k + r] at t[r] + k step of ray r.
template <class Shape, bool kSizes>
HWY_NOINLINE void sum_samples(const RaycastField& field, const PacketList& list, const FourRays& rays, const float* t,
                              float step, float* rho) {
  sum_density<BracketShape<Shape>, kSizes>(
      field, list, [&](int l, Vec& x, Vec& y, Vec& z) { rays.samples(t, step, l, x, y, z); }, rho);
}

/// rho and its derivative along the ray, 1/m, at t[r] of ray r.
template <class Shape, bool kSizes>
HWY_NOINLINE void sum_slopes(const RaycastField& field, const PacketList& list, const FourRays& rays, const float* t,
                             float* rho, float* slope) {
  const Tag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const Vec scale = hn::Set(d, field.scale), slope_scale = hn::Set(d, field.scale * Shape::kSlope);
  Vec per_h = hn::Set(d, 1.0f / field.options.smoothing_length);
  const float *lx = list.x.data(), *ly = list.y.data(), *lz = list.z.data(), *lm = list.mass.data();
  const int blocks = lanes / kCopies;
  alignas(64) float totals[kPacket];
  for (int v = 0; v * lanes < kFour * kCopies; ++v) {
    const auto of = rays.copies(t, v);
    Vec sum = hn::Zero(d), rise = hn::Zero(d);
    for (std::size_t j = 0; j < list.count; j += kCopies) {
      const Vec x = hn::Sub(of.x, side_by_side(lx + j)), y = hn::Sub(of.y, side_by_side(ly + j)),
                z = hn::Sub(of.z, side_by_side(lz + j));
      if constexpr (kSizes) per_h = side_by_side(list.per_smoothing.data() + j);
      const Vec r2 = hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
      const Vec along = hn::MulAdd(x, of.dx, hn::MulAdd(y, of.dy, hn::Mul(z, of.dz)));
      Shape::exact(r2, along, per_h, side_by_side(lm + j), sum, rise);
    }
    sum_copies(hn::Mul(sum, scale), hn::Mul(rise, slope_scale), hn::Zero(d), hn::Zero(d), totals);
    for (int r = 0; r < blocks; ++r) {
      rho[v * blocks + r] = totals[4 * r];
      slope[v * blocks + r] = totals[4 * r + 1];
    }
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#endif
