// What is gathered for a beam, and the lists of its rays; included once for each instruction set, after highway.h.

#if defined(MENISCUS_SURFACE_BEAM_LIST_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MENISCUS_SURFACE_BEAM_LIST_INL_H_
#undef MENISCUS_SURFACE_BEAM_LIST_INL_H_
#else
#define MENISCUS_SURFACE_BEAM_LIST_INL_H_
#endif

#include <hwy/highway.h>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "surface/beam.h"
#include "surface/packet_sizes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

/// Calls visit(i) for the rays of a mask.
template <class Visit>
HWY_INLINE void for_each_ray(BeamMask mask, Visit visit) {
  for (; mask != 0; mask &= mask - 1) visit(__builtin_ctzll(mask));
}

/// What lies within `radius` of the straight line between two points.
struct Capsule {
  vec3 from, to;
  float radius;
};

/// Holds all that is within `reach` of stretches [first, last] of some rays of a beam.
HWY_INLINE Capsule capsule_around(const Beam& beam, BeamMask mask, float first, float last, float reach) {
  // The mean ray; no ray strays farther from it in between than it does at one of the ends.
  vec3 origin{0}, direction{0};
  float rays = 0;
  for_each_ray(mask, [&](int i) {
    origin += beam.origin(i);
    direction += beam.direction(i);
    rays += 1.0f;
  });
  const float per_ray = 1.0f / rays;
  origin *= per_ray;
  direction *= per_ray;
  float apart2 = 0;
  for_each_ray(mask, [&](int i) {
    const vec3 off = beam.origin(i) - origin, turn = beam.direction(i) - direction;
    const vec3 a = off + first * turn, b = off + last * turn;
    apart2 = std::max(apart2, std::max(glm::dot(a, a), glm::dot(b, b)));
  });
  return {origin + first * direction, origin + last * direction, reach + std::sqrt(apart2)};
}

/// Fills the list with the particles in the capsule, in their sorted order.
/// @param reach  m: smoothing length, or some more, of the capsule's radius
HWY_NOINLINE void gather_capsule(const RaycastField& field, const Capsule& capsule, float reach, PacketList& list) {
  const vec3 low = glm::min(capsule.from, capsule.to), high = glm::max(capsule.from, capsule.to);
  if (HWY_UNLIKELY(field.has_sizes())) {
    const float apart = capsule.radius - reach;
    return gather_sizes(field, low - apart, high + apart, reach, false, list);
  }
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  const BandGrid& grid = field.grid;
  const vec3 along = capsule.to - capsule.from;
  const float length2 = glm::dot(along, along);
  const Vec from_x = hn::Set(d, capsule.from.x), from_y = hn::Set(d, capsule.from.y),
            from_z = hn::Set(d, capsule.from.z);
  const Vec along_x = hn::Set(d, along.x), along_y = hn::Set(d, along.y), along_z = hn::Set(d, along.z);
  const Vec per_length2 = hn::Set(d, length2 > 0.0f ? 1.0f / length2 : 0.0f);
  const Vec radius2 = hn::Set(d, capsule.radius * capsule.radius), zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  list.count = 0;
  list.near_full = grid.touches_full(low - (capsule.radius - reach), high + (capsule.radius - reach));
  grid.for_each_run(low - capsule.radius, high + capsule.radius, [&](std::size_t begin, std::size_t end) {
    list.reserve(list.count + (end - begin) + 2 * kPacket, false);
    for (std::size_t i = begin; i < end; i += lanes) {
      const Vec x = hn::LoadU(d, grid.x() + i), y = hn::LoadU(d, grid.y() + i), z = hn::LoadU(d, grid.z() + i);
      const Vec off_x = hn::Sub(x, from_x), off_y = hn::Sub(y, from_y), off_z = hn::Sub(z, from_z);
      const Vec part =
          hn::Mul(hn::MulAdd(off_x, along_x, hn::MulAdd(off_y, along_y, hn::Mul(off_z, along_z))), per_length2);
      const Vec at = hn::Min(hn::Max(part, zero), one);
      const Vec across_x = hn::NegMulAdd(at, along_x, off_x), across_y = hn::NegMulAdd(at, along_y, off_y),
                across_z = hn::NegMulAdd(at, along_z, off_z);
      const Vec off2 = hn::MulAdd(across_x, across_x, hn::MulAdd(across_y, across_y, hn::Mul(across_z, across_z)));
      // Lanes past the run's end belong to other cells, which may be part of the box and come again.
      const auto near = hn::And(hn::Lt(off2, radius2), hn::FirstN(d, end - i));
      if (hn::AllFalse(d, near)) continue;
      const auto keep = [&](Vec values, const AlignedFloats& to) {
        hn::StoreU(hn::Compress(values, near), d, to.data() + list.count);
      };
      keep(x, list.x);
      keep(y, list.y);
      keep(z, list.z);
      keep(hn::LoadU(d, field.mass.data() + i), list.mass);
      list.count += hn::CountTrue(d, near);
    }
  });
  // Whole vectors are read; what is beyond the end lies far away.
  list.reserve(list.count + 2 * kPacket, false);
  hn::StoreU(hn::Set(d, 1e18f), d, list.x.data() + list.count);
}

/// Fills a ray's list from the beam's: those whose kernels reach the stretch [first, last], m along the ray; places are
/// from `start`, m along it too.
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
