// Lanes of a mask, packed to the front; included once for each instruction set, after highway.h.

#if defined(MENISCUS_BASE_PACKING_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MENISCUS_BASE_PACKING_INL_H_
#undef MENISCUS_BASE_PACKING_INL_H_
#else
#define MENISCUS_BASE_PACKING_INL_H_
#endif

#include <hwy/highway.h>

#include "base/packing_table.h"

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

/// Moves the lanes of a mask, of 32 bits each, to the front of vectors; what follows them means nothing. For many
/// vectors and one mask. Without AVX-512, hn::Compress() copies its whole table each time, as g++ 12 compiles it.
template <class D>
class Packing {
 public:
  HWY_INLINE Packing([[maybe_unused]] D d, hwy::HWY_NAMESPACE::Mask<D> mask)
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_SSE4
      : indices_(indices_of(d, mask)) {
  }
  template <class V>
  HWY_INLINE V operator()(V values) const {
    namespace hn = hwy::HWY_NAMESPACE;
    const D d;
    return hn::BitCast(hn::DFromV<V>(), hn::TableLookupLanes(hn::BitCast(d, values), indices_));
  }

 private:
  static HWY_INLINE auto indices_of(D d, hwy::HWY_NAMESPACE::Mask<D> mask) {
    namespace hn = hwy::HWY_NAMESPACE;
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, mask, bits);
    const hn::Rebind<std::uint8_t, D> bytes;
    const hn::Rebind<std::int32_t, D> numbers;
    const std::size_t known = bits[0] & ((1u << hn::Lanes(d)) - 1u);
    return hn::IndicesFromVec(d, hn::PromoteTo(numbers, hn::LoadU(bytes, kPackingTable.data() + 8 * known)));
  }
  decltype(indices_of(D(), hwy::HWY_NAMESPACE::Mask<D>())) indices_;
#else
      : mask_(mask) {
  }
  template <class V>
  HWY_INLINE V operator()(V values) const {
    namespace hn = hwy::HWY_NAMESPACE;
    return hn::Compress(values, hn::RebindMask(hn::DFromV<V>(), mask_));
  }

 private:
  hwy::HWY_NAMESPACE::Mask<D> mask_;
#endif
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#endif
