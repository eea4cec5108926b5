// Solids met by the rays of a block, sixteen at a time.
#include <algorithm>

#include "scene/placed_solids.h"

namespace meniscus {
namespace {

constexpr unsigned kPacket = 16;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// Packets are not said to be coherent: Embree's traversal for those (3.13.5) has not returned from rays that start far
// apart, on a ground without end.

/// What packets of rays and of rays with hits have in common.
void put(RTCRay16& r, unsigned k, vec3 origin, vec3 direction, float limit) {
  r.org_x[k] = origin.x;
  r.org_y[k] = origin.y;
  r.org_z[k] = origin.z;
  r.dir_x[k] = direction.x;
  r.dir_y[k] = direction.y;
  r.dir_z[k] = direction.z;
  r.tnear[k] = 0;
  r.tfar[k] = limit;
  r.time[k] = 0;
  r.mask[k] = 0xFFFFFFFFu;
  r.id[k] = k;
  r.flags[k] = 0;
}

}  // namespace

void PlacedSolids::hits(const RayBlock& rays, const BlockBeams& beams, bool described_too, BlockHits& hits) const {
  int lanes[RayBlock::kRays];
  unsigned count = 0;
  for (int lane = 0; lane < rays.count; ++lane)
    if (hits.near_solids[lane] != 0) lanes[count++] = lane;
  for (unsigned first = 0; first < count; first += kPacket) {
    const unsigned here = std::min(kPacket, count - first);
    RTCRayHit16 r;
    alignas(64) int valid[kPacket] = {};
    for (unsigned k = 0; k < here; ++k) {
      const int lane = lanes[first + k];
      const Ray ray = rays.ray(lane);
      put(r.ray, k, ray.origin, ray.direction, hits.distance[lane]);
      r.hit.geomID[k] = r.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
      valid[k] = -1;
    }
    // Rays that are not valid have values all the same.
    const Ray spare = rays.ray(lanes[first]);
    for (unsigned k = here; k < kPacket; ++k) put(r.ray, k, spare.origin, spare.direction, 0.0f);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect16(valid, scene_.get(), &context, &r);
    for (unsigned k = 0; k < here; ++k) {
      if (r.hit.geomID[k] == RTC_INVALID_GEOMETRY_ID) continue;
      const int lane = lanes[first + k];
      hits.distance[lane] = r.ray.tfar[k];
      hits.face[lane] = kSolidFace;
      hits.presence[lane] = 1.0f;
      if (!described_too) continue;
      hits.solids[lane] =
          described(rays.ray(lane), beams.of(lane), r.ray.tfar[k], r.hit.instID[0][k], r.hit.primID[k], r.hit.u[k], r.hit.v[k]);
      for (int c = 0; c < 3; ++c) hits.albedo[c][lane] = hits.solids[lane].albedo[c];
    }
  }
}

unsigned PlacedSolids::passing(std::span<const Ray> rays) const {
  RTCRay16 r;
  alignas(64) int valid[kPacket] = {};
  const auto count = static_cast<unsigned>(std::min<std::size_t>(rays.size(), kPacket));
  for (unsigned k = 0; k < count; ++k) {
    put(r, k, rays[k].origin, rays[k].direction, kInfinity);
    valid[k] = -1;
  }
  for (unsigned k = count; k < kPacket; ++k) put(r, k, rays[0].origin, rays[0].direction, 0.0f);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded16(valid, scene_.get(), &context, &r);
  unsigned bits = 0;
  for (unsigned k = 0; k < count; ++k) bits |= r.tfar[k] < 0 ? 0u : 1u << k;
  return bits;
}

}  // namespace meniscus
