#include "surface/column_gather.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surface/column_gather_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// after highway.h
#include "base/packing-inl.h"

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

std::size_t GatherColumn(const ColumnBins& bins, const ColumnSearch& search, float* weights, float* places,
                         std::size_t count) {
  const HWY_CAPPED(float, 8) d;  // bins seldom hold more that are new
  const std::size_t lanes = hn::Lanes(d);
  const auto a = hn::Set(d, search.a), b = hn::Set(d, search.b), down_to = hn::Set(d, search.down_to);
  const auto per_reach2 = hn::Set(d, search.per_reach2), zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  std::size_t n = 0;
  for (int j = search.j0; j <= search.j1; ++j)
    for (int i = search.i0; i <= search.i1; ++i, ++n) {
      const std::size_t bin =
          static_cast<std::size_t>(j) * static_cast<std::size_t>(bins.bins_a) + static_cast<std::size_t>(i);
      const std::size_t end = bins.start[bin + 1];
      std::size_t at = search.next[n];
      while (at < end) {
        const auto z = hn::LoadU(d, bins.z + at);
        const auto da = hn::Sub(hn::LoadU(d, bins.a + at), a), db = hn::Sub(hn::LoadU(d, bins.b + at), b);
        const auto wanted = hn::And(hn::FirstN(d, end - at), hn::Gt(z, down_to));
        const auto weight = hn::NegMulAdd(hn::MulAdd(da, da, hn::Mul(db, db)), per_reach2, one);
        const auto near = hn::And(wanted, hn::Gt(weight, zero));
        const Packing packed(d, near);
        hn::StoreU(packed(weight), d, weights + count);
        hn::StoreU(packed(z), d, places + count);
        count += hn::CountTrue(d, near);
        const std::size_t seen = hn::CountTrue(d, wanted);
        at += seen;
        if (seen < lanes) break;
      }
      search.next[n] = at;
    }
  return count;
}

}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace meniscus {

HWY_EXPORT(GatherColumn);

std::size_t gather_column(const ColumnBins& bins, const ColumnSearch& search, float* weights, float* places,
                          std::size_t count) {
  return HWY_DYNAMIC_DISPATCH(GatherColumn)(bins, search, weights, places, count);
}

}  // namespace meniscus
#endif
