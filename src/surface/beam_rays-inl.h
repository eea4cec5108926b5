// Rays of a beam by masks, many at once; included once for each instruction set, after highway.h.

#if defined(MENISCUS_SURFACE_BEAM_RAYS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MENISCUS_SURFACE_BEAM_RAYS_INL_H_
#undef MENISCUS_SURFACE_BEAM_RAYS_INL_H_
#else
#define MENISCUS_SURFACE_BEAM_RAYS_INL_H_
#endif

#include <hwy/highway.h>

#include <glm/geometric.hpp>

#include "surface/beam.h"
#include "surface/packet_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

/// Calls visit(i) for the rays of a mask.
template <class Visit>
HWY_INLINE void for_each_ray(BeamMask mask, Visit visit) {
  for (; mask != 0; mask &= mask - 1) visit(__builtin_ctzll(mask));
}

/// Calls visit(i, of) for the vectors of rays that hold rays of the mask, `of` being those; the first is ray i.
template <class Visit>
HWY_INLINE void for_each_vector(BeamMask mask, Visit visit) {
  for (int first = 0; first < kBeam; first += kPacket)
    for_each_chunk(static_cast<PacketMask>(mask >> first & 0xffffu), [&](int l, auto of) { visit(first + l, of); });
}

/// Least and largest of values[i] over the rays of a mask.
HWY_INLINE float least_of(BeamMask mask, const float* values) {
  const Tag d;
  Vec least = hn::Set(d, std::numeric_limits<float>::infinity());
  for_each_vector(mask,
                  [&](int i, auto of) { least = hn::IfThenElse(of, hn::Min(least, hn::LoadU(d, values + i)), least); });
  return hn::GetLane(hn::MinOfLanes(d, least));
}
HWY_INLINE float largest_of(BeamMask mask, const float* values) {
  const Tag d;
  Vec largest = hn::Set(d, -std::numeric_limits<float>::infinity());
  for_each_vector(
      mask, [&](int i, auto of) { largest = hn::IfThenElse(of, hn::Max(largest, hn::LoadU(d, values + i)), largest); });
  return hn::GetLane(hn::MaxOfLanes(d, largest));
}

/// Takes rays off the mask whose places, m along each, lie near that of the first of them.
HWY_INLINE BeamMask take_group(const Beam& beam, const float* at, BeamMask& left) {
  const Tag d;
  const float first = least_of(left, at);
  int seed = __builtin_ctzll(left);
  for_each_ray(left, [&](int i) { seed = at[i] == first ? i : seed; });
  const vec3 centre = beam.origin(seed) + first * beam.direction(seed);
  const Vec place = hn::Set(d, first), last = hn::Set(d, first + beam.along),
            across2 = hn::Set(d, beam.across * beam.across), x = hn::Set(d, centre.x), y = hn::Set(d, centre.y),
            z = hn::Set(d, centre.z);
  BeamMask group = BeamMask{1} << seed;  // whatever its place is
  for_each_vector(left, [&](int i, auto of) {
    const PacketRays& rays = beam.rays[i / kPacket];
    const int l = i % kPacket;
    const Vec off_x = hn::Sub(hn::MulAdd(place, hn::Load(d, rays.dx + l), hn::Load(d, rays.ox + l)), x),
              off_y = hn::Sub(hn::MulAdd(place, hn::Load(d, rays.dy + l), hn::Load(d, rays.oy + l)), y),
              off_z = hn::Sub(hn::MulAdd(place, hn::Load(d, rays.dz + l), hn::Load(d, rays.oz + l)), z);
    const Vec off2 = hn::MulAdd(off_x, off_x, hn::MulAdd(off_y, off_y, hn::Mul(off_z, off_z)));
    const auto near = hn::And(hn::And(of, hn::Lt(hn::LoadU(d, at + i), last)), hn::Le(off2, across2));
    group |= BeamMask{bits_of(near)} << i;
  });
  left &= ~group;
  return group;
}

/// What lies within `radius` of the straight line between two points.
struct Capsule {
  vec3 from, to;
  float radius;
};

/// Holds all that is within `reach` of stretches [first, last] of some rays of a beam.
HWY_INLINE Capsule capsule_around(const Beam& beam, BeamMask mask, float first, float last, float reach) {
  const Tag d;
  const Vec zero = hn::Zero(d);
  // The mean ray; no ray strays farther from it in between than it does at one of the ends.
  Vec ox = zero, oy = zero, oz = zero, dx = zero, dy = zero, dz = zero;
  for_each_vector(mask, [&](int i, auto of) {
    const PacketRays& rays = beam.rays[i / kPacket];
    const auto add = [&](const float* values, Vec& sum) {
      sum = hn::Add(sum, hn::IfThenElseZero(of, hn::Load(d, values + i % kPacket)));
    };
    add(rays.ox, ox), add(rays.oy, oy), add(rays.oz, oz);
    add(rays.dx, dx), add(rays.dy, dy), add(rays.dz, dz);
  });
  const float per_ray = 1.0f / static_cast<float>(__builtin_popcountll(mask));
  const auto mean = [&](Vec sum) { return per_ray * hn::GetLane(hn::SumOfLanes(d, sum)); };
  const vec3 origin{mean(ox), mean(oy), mean(oz)}, direction{mean(dx), mean(dy), mean(dz)};
  const vec3 from = origin + first * direction, to = origin + last * direction;
  Vec apart2 = zero;
  for_each_vector(mask, [&](int i, auto of) {
    const PacketRays& rays = beam.rays[i / kPacket];
    const int l = i % kPacket;
    const auto apart2_at = [&](float t, vec3 centre) {
      const Vec at = hn::Set(d, t);
      const auto off = [&](const float* o, const float* v, float c) {
        return hn::Sub(hn::MulAdd(at, hn::Load(d, v + l), hn::Load(d, o + l)), hn::Set(d, c));
      };
      const Vec x = off(rays.ox, rays.dx, centre.x), y = off(rays.oy, rays.dy, centre.y),
                z = off(rays.oz, rays.dz, centre.z);
      return hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
    };
    apart2 = hn::Max(apart2, hn::IfThenElseZero(of, hn::Max(apart2_at(first, from), apart2_at(last, to))));
  });
  return {from, to, reach + std::sqrt(hn::GetLane(hn::MaxOfLanes(d, apart2)))};
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#endif
