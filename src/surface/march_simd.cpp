#include "surface/march_simd.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surface/march_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// after highway.h
#include "surface/packet_sums-inl.h"

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {

void GatherNear(const RaycastField& field, vec3 low, vec3 high, PacketList& list) {
  gather_list(field, low, high, field.options.smoothing_length, false, list);
}

void DensityFrom(const RaycastField& field, const PacketList& list, const PacketPoints& points, float* density) {
  density_at_points(field, list, points, density);
}

}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace meniscus {

HWY_EXPORT(GatherNear);
HWY_EXPORT(DensityFrom);

void gather_near(const RaycastField& field, vec3 low, vec3 high, PacketList& list) {
  HWY_DYNAMIC_DISPATCH(GatherNear)(field, low, high, list);
}

void density_from(const RaycastField& field, const PacketList& list, const PacketPoints& points, float* density) {
  HWY_DYNAMIC_DISPATCH(DensityFrom)(field, list, points, density);
}

}  // namespace meniscus
#endif
