// Records of four floats, read for a vector of neighbours at once; included once for each instruction set, after
// highway.h.
//
// Whole records are loaded and turned within the vector's 128-bit blocks. Measured with AVX-512 on a Sapphire Rapids
// core, four values of 16 neighbours cost 12 ns in this way and 21 ns by gathers, which smaller instruction sets have
// not even got.

#if defined(MENISCUS_SIM_RECORDS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MENISCUS_SIM_RECORDS_INL_H_
#undef MENISCUS_SIM_RECORDS_INL_H_
#else
#define MENISCUS_SIM_RECORDS_INL_H_
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = HWY_CAPPED(float, 16);
using Vec = hn::Vec<Tag>;

/// The four floats of as many records as a vector has lanes.
struct Records {
  Vec a, b, c, d;
};

/// The sums over the lanes of four vectors.
struct Sums {
  float of[4];
};

#if HWY_HAVE_SCALABLE || HWY_TARGET == HWY_SCALAR

HWY_INLINE Sums sums_of(Vec a, Vec b, Vec c, Vec e) {
  const Tag d;
  return {{hn::GetLane(hn::SumOfLanes(d, a)), hn::GetLane(hn::SumOfLanes(d, b)), hn::GetLane(hn::SumOfLanes(d, c)),
           hn::GetLane(hn::SumOfLanes(d, e))}};
}

/// Records records[kStride index[0]], records[kStride index[1]] ...
template <int kStride>
HWY_INLINE Records load_records(const float* records, const std::int32_t* index) {
  const Tag d;
  const hn::RebindToSigned<Tag> di;
  const auto first = hn::Mul(hn::LoadU(di, index), hn::Set(di, kStride));
  return {hn::GatherIndex(d, records, first), hn::GatherIndex(d, records + 1, first),
          hn::GatherIndex(d, records + 2, first), hn::GatherIndex(d, records + 3, first)};
}

#else

/// The sum of the vector's 128-bit blocks.
template <class D>
HWY_INLINE void store_sum_of_blocks(D d, hn::Vec<D> v, float* to) {
  if constexpr (hn::MaxLanes(D()) <= 4) {
    hn::StoreU(v, d, to);
  } else {
    const hn::Half<D> half;
    store_sum_of_blocks(half, hn::Add(hn::UpperHalf(half, v), hn::LowerHalf(half, v)), to);
  }
}

/// Together they cost little more than one alone.
HWY_INLINE Sums sums_of(Vec a, Vec b, Vec c, Vec e) {
  const Tag d;
  const hn::RepartitionToWide<Tag> pairs;
  const auto ab = hn::BitCast(pairs, hn::Add(hn::InterleaveLower(d, a, b), hn::InterleaveUpper(d, a, b)));
  const auto ce = hn::BitCast(pairs, hn::Add(hn::InterleaveLower(d, c, e), hn::InterleaveUpper(d, c, e)));
  Sums sums;
  store_sum_of_blocks(
      d,
      hn::Add(hn::BitCast(d, hn::InterleaveLower(pairs, ab, ce)), hn::BitCast(d, hn::InterleaveUpper(pairs, ab, ce))),
      sums.of);
  return sums;
}

/// One record in each block: those of index[0], index[4] ...
template <int kStride, class D>
HWY_INLINE hn::Vec<D> load_blocks(D d, const float* records, const std::int32_t* index) {
  constexpr std::size_t kLanes = hn::MaxLanes(D());
  if constexpr (kLanes <= 4) {
    return hn::LoadU(d, records + kStride * static_cast<std::ptrdiff_t>(index[0]));
  } else {
    const hn::Half<D> half;
    return hn::Combine(d, load_blocks<kStride>(half, records, index + kLanes / 2),
                       load_blocks<kStride>(half, records, index));
  }
}

/// Records records[kStride index[0]], records[kStride index[1]] ...
template <int kStride>
HWY_INLINE Records load_records(const float* records, const std::int32_t* index) {
  const Tag d;
  const hn::RepartitionToWide<Tag> pairs;
  const Vec first = load_blocks<kStride>(d, records, index), second = load_blocks<kStride>(d, records, index + 1),
            third = load_blocks<kStride>(d, records, index + 2), fourth = load_blocks<kStride>(d, records, index + 3);
  const auto low = hn::BitCast(pairs, hn::InterleaveLower(d, first, second));
  const auto high = hn::BitCast(pairs, hn::InterleaveUpper(d, first, second));
  const auto low_others = hn::BitCast(pairs, hn::InterleaveLower(d, third, fourth));
  const auto high_others = hn::BitCast(pairs, hn::InterleaveUpper(d, third, fourth));
  return {hn::BitCast(d, hn::InterleaveLower(pairs, low, low_others)),
          hn::BitCast(d, hn::InterleaveUpper(pairs, low, low_others)),
          hn::BitCast(d, hn::InterleaveLower(pairs, high, high_others)),
          hn::BitCast(d, hn::InterleaveUpper(pairs, high, high_others))};
}

#endif

/// 1 / sqrt(v) to nearly float precision by one Newton step; v > 0.
HWY_INLINE Vec reciprocal_root(Vec v) {
  const Tag d;
  const Vec guess = hn::ApproximateReciprocalSqrt(v);
  const Vec half = hn::Mul(hn::Set(d, 0.5f), hn::Mul(v, guess));
  return hn::Mul(guess, hn::NegMulAdd(half, guess, hn::Set(d, 1.5f)));
}

HWY_INLINE float sum_of(Vec v) { return hn::GetLane(hn::SumOfLanes(Tag(), v)); }

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#endif
