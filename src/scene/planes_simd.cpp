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

void PlaneHits(const Planes& planes, const SolidsBox& solids, const RayBlock& rays, const BlockBeams& beams, float tie,
               bool colours, BlockHits& hits) {
  const auto lanes = static_cast<int>(hn::Lanes(Tag()));
  for (int first = 0; first < rays.count; first += lanes)
    Meeting(planes, rays, beams, first).run(solids, tie, colours, hits);
}

void SunPastPlanes(const Planes& planes, const SolidsBox& solids, const SunPath& sun, int count, BlockPoints& points) {
  const auto lanes = static_cast<int>(hn::Lanes(Tag()));
  for (int first = 0; first < count; first += lanes) sun_at(planes, solids, sun, first, points);
}

void LightGround(const BlockHits& hits, vec3 light, int count, BlockVectors& radiance) {
  const Tag d;
  const hn::RebindToSigned<Tag> di;
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); i += hn::Lanes(d)) {
    const auto nothing = hn::RebindMask(d, hn::Lt(hn::Load(di, hits.face + i), hn::Zero(di)));
    const Vec part = hn::IfThenZeroElse(nothing, hn::Load(d, hits.presence + i));
    for (int c = 0; c < 3; ++c) {
      const Vec behind = hn::Load(d, radiance[c] + i);
      const Vec lit = hn::Mul(hn::Load(d, hits.albedo[c] + i), all(light[c]));
      hn::Store(hn::MulAdd(part, hn::Sub(lit, behind), behind), d, radiance[c] + i);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace meniscus {

HWY_EXPORT(PlaneHits);
HWY_EXPORT(SunPastPlanes);
HWY_EXPORT(LightGround);

void plane_hits(const Planes& planes, const SolidsBox& solids, const RayBlock& rays, const BlockBeams& beams, float tie,
                bool colours, BlockHits& hits) {
  HWY_DYNAMIC_DISPATCH(PlaneHits)(planes, solids, rays, beams, tie, colours, hits);
}

void sun_past_planes(const Planes& planes, const SolidsBox& solids, const SunPath& sun, int count,
                     BlockPoints& points) {
  HWY_DYNAMIC_DISPATCH(SunPastPlanes)(planes, solids, sun, count, points);
}

void light_ground(const BlockHits& hits, vec3 light, int count, BlockVectors& radiance) {
  HWY_DYNAMIC_DISPATCH(LightGround)(hits, light, count, radiance);
}

}  // namespace meniscus
#endif
