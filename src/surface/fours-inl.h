// Four points or rays, each for four particles side by side; included once for each instruction set, after highway.h.

#if defined(MENISCUS_SURFACE_FOURS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MENISCUS_SURFACE_FOURS_INL_H_
#undef MENISCUS_SURFACE_FOURS_INL_H_
#else
#define MENISCUS_SURFACE_FOURS_INL_H_
#endif

#include <hwy/highway.h>

#include "surface/packet_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

constexpr int kFour = 4;  ///< points or rays that share a list
/// Copies of one of them that stand side by side, each for another particle: lane c of block r of sixteen lanes.
constexpr int kCopies = HWY_TARGET == HWY_SCALAR ? 1 : 4;
static_assert(kFour * 4 == kPacket);

/// Vector v of those that hold each of four values kCopies times; the values are aligned to 16 bytes.
HWY_INLINE Vec copied(const float* values, int v) {
  const Tag d;
  if (kCopies == 1) return hn::LoadU(d, values + v);
  alignas(64) static constexpr std::int32_t kBlock[kPacket] = {0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3};
  return hn::TableLookupLanes(hn::LoadDup128(d, values),
                              hn::SetTableIndices(d, kBlock + v * static_cast<int>(hn::Lanes(d))));
}

/// The next kCopies particles, for each of the four.
HWY_INLINE Vec side_by_side(const float* values) { return hn::LoadDup128(Tag(), values); }

/// Sums over the copies of four vectors: sums[4 r + k] is that of vector k in block r.
HWY_INLINE void sum_copies(Vec a, Vec b, Vec c, Vec e, float* sums) {
#if HWY_TARGET == HWY_SCALAR
  sums[0] = hn::GetLane(a), sums[1] = hn::GetLane(b), sums[2] = hn::GetLane(c), sums[3] = hn::GetLane(e);
#else
  const Tag d;
  const hn::Repartition<double, Tag> pairs;
  const auto fold = [&](Vec p, Vec q) HWY_ATTR {
    return hn::BitCast(pairs, hn::Add(hn::InterleaveLower(d, p, q), hn::InterleaveUpper(d, p, q)));
  };
  const auto ab = fold(a, b), ce = fold(c, e);
  hn::StoreU(
      hn::Add(hn::BitCast(d, hn::InterleaveLower(pairs, ab, ce)), hn::BitCast(d, hn::InterleaveUpper(pairs, ab, ce))),
      d, sums);
#endif
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#endif
