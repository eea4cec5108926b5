#include "surface/beam.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surface/beam_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// after highway.h
#include "surface/beam_march-inl.h"

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {

void MarchBeam(const RaycastField& field, bool from_inside, BeamLists& lists, Beam& beam) {
  with_kernel(field.options.kernel, [&](auto shape) {
    if (field.has_sizes())
      BeamMarch<decltype(shape), true>(field, from_inside, lists, beam).run();
    else
      BeamMarch<decltype(shape), false>(field, from_inside, lists, beam).run();
  });
}

}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace meniscus {

HWY_EXPORT(MarchBeam);

void march_beam(const RaycastField& field, bool from_inside, BeamLists& lists, Beam& beam) {
  HWY_DYNAMIC_DISPATCH(MarchBeam)(field, from_inside, lists, beam);
}

}  // namespace meniscus
#endif
