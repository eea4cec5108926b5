// Density along one ray from its list; included once for each instruction set, after highway.h.

#if defined(MENISCUS_SURFACE_BEAM_SUMS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MENISCUS_SURFACE_BEAM_SUMS_INL_H_
#undef MENISCUS_SURFACE_BEAM_SUMS_INL_H_
#else
#define MENISCUS_SURFACE_BEAM_SUMS_INL_H_
#endif

#include <hwy/highway.h>

#include "surface/beam_list-inl.h"
#include "surface/packet_kernels-inl.h"

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

constexpr int kRaySamples = 4;  ///< summed at once

/// The sums of four vectors' lanes; the order is the same whatever the vectors hold.
HWY_INLINE void sums_of(Vec a, Vec b, Vec c, Vec e, float* sums) {
#if HWY_TARGET == HWY_SCALAR
  sums[0] = hn::GetLane(a), sums[1] = hn::GetLane(b), sums[2] = hn::GetLane(c), sums[3] = hn::GetLane(e);
#else
  const Tag d;
  const hn::Repartition<double, Tag> pairs;
  const auto fold = [&](Vec p, Vec q) { return hn::Add(hn::InterleaveLower(d, p, q), hn::InterleaveUpper(d, p, q)); };
  const auto ab = hn::BitCast(pairs, fold(a, b)), ce = hn::BitCast(pairs, fold(c, e));
  const Vec all =
      hn::Add(hn::BitCast(d, hn::InterleaveLower(pairs, ab, ce)), hn::BitCast(d, hn::InterleaveUpper(pairs, ab, ce)));
  alignas(64) float blocks[kPacket];
  hn::Store(all, d, blocks);
  const hn::FixedTag<float, 4> four;
  auto sum = hn::Load(four, blocks);
  for (std::size_t l = 4; l < hn::Lanes(d); l += 4) sum = hn::Add(sum, hn::Load(four, blocks + l));
  hn::StoreU(sum, four, sums);
#endif
}

/// rho / scale at k `step` m from the start of a ray's stretch, k = 0 .. 3, to 1e-3.
template <class Shape, bool kSizes>
HWY_NOINLINE void sum_ray_samples(const RayList& list, float per_smoothing, float step, float* rho) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  const Vec zero = hn::Zero(d);
  Vec step_h = hn::Set(d, step * per_smoothing), step_2h = hn::Set(d, 2.0f * step * per_smoothing),
      step_3h = hn::Set(d, 3.0f * step * per_smoothing);
  Vec sum0 = zero, sum1 = zero, sum2 = zero, sum3 = zero;
  for (std::size_t j = 0; j < list.count; j += lanes) {
    const Vec place = hn::Load(d, list.place.data() + j), core = hn::Load(d, list.core.data() + j),
              mass = hn::Load(d, list.mass.data() + j);
    if constexpr (kSizes) {
      step_h = hn::Mul(hn::Set(d, step), hn::Load(d, list.per_h.data() + j));
      step_2h = hn::Add(step_h, step_h);
      step_3h = hn::Add(step_2h, step_h);
    }
    const auto add = [&](Vec off, Vec& sum) {
      sum = hn::Add(sum, Shape::bracket(hn::Max(hn::NegMulAdd(off, off, core), zero), mass));
    };
    add(place, sum0);
    add(hn::Sub(step_h, place), sum1);
    add(hn::Sub(step_2h, place), sum2);
    add(hn::Sub(step_3h, place), sum3);
  }
  sums_of(sum0, sum1, sum2, sum3, rho);
}

/// rho / scale at t m from the start of the ray's stretch.
template <class Shape, bool kSizes>
HWY_NOINLINE float sum_ray_density(const RayList& list, float per_smoothing, float t) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  const Vec one = hn::Set(d, 1.0f);
  Vec at = hn::Set(d, t * per_smoothing);
  Vec sum = hn::Zero(d), slope = hn::Zero(d);
  for (std::size_t j = 0; j < list.count; j += lanes) {
    if constexpr (kSizes) at = hn::Mul(hn::Set(d, t), hn::Load(d, list.per_h.data() + j));
    const Vec along = hn::Sub(at, hn::Load(d, list.place.data() + j));
    const Vec r2 = hn::MulAdd(along, along, hn::Sub(one, hn::Load(d, list.core.data() + j)));
    Shape::exact(r2, along, one, hn::Load(d, list.mass.data() + j), sum, slope);
  }
  return hn::GetLane(hn::SumOfLanes(d, sum));
}

struct SumAndSlope {
  float rho, slope;
};

/// The same and its derivative along the ray, 1/m, both over scale; of particles that are all alike.
template <class Shape>
HWY_NOINLINE SumAndSlope sum_ray_slope(const RayList& list, float per_smoothing, float t) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  const Vec one = hn::Set(d, 1.0f), at = hn::Set(d, t * per_smoothing);
  Vec sum = hn::Zero(d), slope = hn::Zero(d);
  for (std::size_t j = 0; j < list.count; j += lanes) {
    const Vec along = hn::Sub(at, hn::Load(d, list.place.data() + j));
    const Vec r2 = hn::MulAdd(along, along, hn::Sub(one, hn::Load(d, list.core.data() + j)));
    Shape::exact(r2, along, one, hn::Load(d, list.mass.data() + j), sum, slope);
  }
  return {hn::GetLane(hn::SumOfLanes(d, sum)), Shape::kSlope * per_smoothing * hn::GetLane(hn::SumOfLanes(d, slope))};
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#endif
