#include "scene/planes.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "scene/planes_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// after highway.h
#include "scene/planes_light-inl.h"
#include "scene/planes_meet-inl.h"

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {

void PlaneHits(const Planes& planes, const SolidsBox& solids, const RayBlock& rays, Beam beam, float tie, bool colours,
               BlockHits& hits) {
  const auto lanes = static_cast<int>(hn::Lanes(Tag()));
  for (int first = 0; first < rays.count; first += lanes)
    Meeting(planes, rays, first).run(solids, beam, tie, colours, hits);
}

void SunPastPlanes(const Planes& planes, const SolidsBox& solids, const SunPath& sun, int count, BlockPoints& points) {
  const auto lanes = static_cast<int>(hn::Lanes(Tag()));
  for (int first = 0; first < count; first += lanes) sun_at(planes, solids, sun, first, points);
}

}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace meniscus {

HWY_EXPORT(PlaneHits);
HWY_EXPORT(SunPastPlanes);

void plane_hits(const Planes& planes, const SolidsBox& solids, const RayBlock& rays, Beam beam, float tie, bool colours,
                BlockHits& hits) {
  HWY_DYNAMIC_DISPATCH(PlaneHits)(planes, solids, rays, beam, tie, colours, hits);
}

void sun_past_planes(const Planes& planes, const SolidsBox& solids, const SunPath& sun, int count,
                     BlockPoints& points) {
  HWY_DYNAMIC_DISPATCH(SunPastPlanes)(planes, solids, sun, count, points);
}

}  // namespace meniscus
#endif
