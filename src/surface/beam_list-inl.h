// The lists of a beam's rays; included once for each instruction set, after highway.h.

#if defined(MENISCUS_SURFACE_BEAM_LIST_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MENISCUS_SURFACE_BEAM_LIST_INL_H_
#undef MENISCUS_SURFACE_BEAM_LIST_INL_H_
#else
#define MENISCUS_SURFACE_BEAM_LIST_INL_H_
#endif

#include <hwy/highway.h>

#include "surface/beam_gather-inl.h"

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

/// Fills a ray's list from what is gathered near it: those whose kernels reach the stretch [first, last], m along the
/// ray; places are from `start`, m along it too.
template <bool kSizes>
HWY_NOINLINE void list_along(const RaycastField& field, const PacketList& near, vec3 origin, vec3 direction,
                             float first, float last, float start, RayList& list) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  const vec3 base = origin + start * direction;
  const Vec base_x = hn::Set(d, base.x), base_y = hn::Set(d, base.y), base_z = hn::Set(d, base.z);
  const Vec dx = hn::Set(d, direction.x), dy = hn::Set(d, direction.y), dz = hn::Set(d, direction.z);
  const Vec one = hn::Set(d, 1.0f), zero = hn::Zero(d);
  Vec per_h = hn::Set(d, 1.0f / field.options.smoothing_length);
  Vec begin = hn::Mul(hn::Set(d, first - start), per_h), end = hn::Mul(hn::Set(d, last - start), per_h);
  list.reserve(near.count + 2 * kPacket, kSizes);
  std::size_t count = 0;
  for (std::size_t j = 0; j < near.count; j += lanes) {
    if constexpr (kSizes) {
      per_h = hn::Load(d, near.per_smoothing.data() + j);
      begin = hn::Mul(hn::Set(d, first - start), per_h);
      end = hn::Mul(hn::Set(d, last - start), per_h);
    }
    const Vec x = hn::Mul(hn::Sub(hn::Load(d, near.x.data() + j), base_x), per_h),
              y = hn::Mul(hn::Sub(hn::Load(d, near.y.data() + j), base_y), per_h),
              z = hn::Mul(hn::Sub(hn::Load(d, near.z.data() + j), base_z), per_h);
    const Vec place = hn::MulAdd(x, dx, hn::MulAdd(y, dy, hn::Mul(z, dz)));
    const Vec off2 = hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
    const Vec core = hn::Sub(one, hn::NegMulAdd(place, place, off2));
    const Vec beyond = hn::Max(hn::Max(hn::Sub(begin, place), hn::Sub(place, end)), zero);
    auto reaches = hn::Gt(core, hn::Mul(beyond, beyond));
    if constexpr (kSizes) reaches = hn::And(reaches, hn::FirstN(d, near.count - j));
    const auto keep = [&](Vec values, const AlignedFloats& to) {
      hn::StoreU(hn::Compress(values, reaches), d, to.data() + count);
    };
    keep(place, list.place);
    keep(core, list.core);
    keep(hn::Load(d, near.mass.data() + j), list.mass);
    if constexpr (kSizes) keep(per_h, list.per_h);
    count += hn::CountTrue(d, reaches);
  }
  hn::StoreU(zero, d, list.place.data() + count);
  hn::StoreU(zero, d, list.core.data() + count);
  hn::StoreU(zero, d, list.mass.data() + count);
  if constexpr (kSizes) hn::StoreU(one, d, list.per_h.data() + count);
  list.count = count;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#endif
