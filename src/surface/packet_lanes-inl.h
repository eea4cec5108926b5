// Masks of a packet's lanes as bits; included once for each instruction set, after highway.h.

#if defined(MENISCUS_SURFACE_PACKET_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MENISCUS_SURFACE_PACKET_LANES_INL_H_
#undef MENISCUS_SURFACE_PACKET_LANES_INL_H_
#else
#define MENISCUS_SURFACE_PACKET_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include "surface/packet_sums-inl.h"

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

/// Calls visit(l) for the lanes of a mask.
template <class Visit>
HWY_INLINE void for_each_lane(PacketMask mask, Visit visit) {
  for (; mask != 0; mask &= mask - 1) visit(__builtin_ctz(mask));
}

/// A vector's mask as bits.
HWY_INLINE PacketMask bits_of(hn::Mask<Tag> mask) {
  const Tag d;
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  return (bytes[0] | static_cast<PacketMask>(bytes[1]) << 8) & ((1u << hn::Lanes(d)) - 1u);
}

/// The lanes for which test(l) is true; it gives the mask of the lanes from l on that fill a vector.
template <class Test>
HWY_INLINE PacketMask lanes_where(Test test) {
  const Tag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  PacketMask result = 0;
  for (int l = 0; l < kPacket; l += lanes) result |= bits_of(test(l)) << l;
  return result;
}

/// Calls visit(l, of) for the vectors of lanes that hold lanes of the mask, `of` being those.
template <class Visit>
HWY_INLINE void for_each_chunk(PacketMask mask, Visit visit) {
  const Tag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int l = 0; l < kPacket; l += lanes) {
    const PacketMask bits = mask >> l & ((1u << lanes) - 1u);
    if (bits == 0) continue;
    const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(bits & 0xffu), static_cast<std::uint8_t>(bits >> 8)};
    visit(l, hn::LoadMaskBits(d, bytes));
  }
}

/// Stores the lanes `of`.
HWY_INLINE void store_in(hn::Mask<Tag> of, Vec values, float* to) { hn::BlendedStore(values, of, Tag(), to); }

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#endif
