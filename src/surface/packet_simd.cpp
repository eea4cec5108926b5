#include "surface/packet.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surface/packet_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// after highway.h
#include <hwy/contrib/math/math-inl.h>

#include "surface/packet_lanes-inl.h"
#include "surface/packet_normals-inl.h"
#include "surface/packet_slopes-inl.h"
#include "surface/packet_sums-inl.h"

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

/// Calls visit(lanes) for groups of the mask's points that lie within `reach` of the first of them along each
/// axis, with the list gathered around the group.
template <class Visit>
void for_each_cluster(const RaycastField& field, const PacketPoints& points, PacketMask mask, float reach, float radius,
                      bool colours, PacketList& list, Visit visit) {
  while (mask != 0) {
    const int first = __builtin_ctz(mask);
    vec3 low{points.x[first], points.y[first], points.z[first]}, high = low;
    PacketMask group = 0;
    for (int l = 0; l < kPacket; ++l) {
      if (!((mask >> l) & 1u)) continue;
      const vec3 p{points.x[l], points.y[l], points.z[l]};
      if (std::abs(p.x - points.x[first]) > reach || std::abs(p.y - points.y[first]) > reach ||
          std::abs(p.z - points.z[first]) > reach)
        continue;
      group |= 1u << l;
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    gather_list(field, low, high, radius, colours, list);
    visit(group);
    mask &= ~group;
  }
}

/// Corrections of depths foretold, in spacings: the farthest that is believed, one that needs no further step (what is
/// left after a step of Newton's method is about its square), and the least slope of rho for one, per spacing.
constexpr float kFarthestCorrection = 0.25f, kNearCorrection = 0.08f, kLeastSlope = 0.05f;

}  // namespace

PacketMask CorrectPacket(const RaycastField& field, const PacketRays& rays, PacketMask mask, PacketList& list,
                         float* depth) {
  const Tag d;
  const float spacing = field.options.spacing;
  const Vec iso = hn::Set(d, field.options.iso), least_slope = hn::Set(d, kLeastSlope / spacing);
  const Vec farthest = hn::Set(d, kFarthestCorrection * spacing), near = hn::Set(d, kNearCorrection * spacing);
  PacketPoints points;
  for (int l = 0; l < kPacket; l += static_cast<int>(hn::Lanes(d))) {
    const Vec t = hn::Load(d, depth + l);
    hn::Store(hn::MulAdd(t, hn::Load(d, rays.dx + l), hn::Load(d, rays.ox + l)), d, points.x + l);
    hn::Store(hn::MulAdd(t, hn::Load(d, rays.dy + l), hn::Load(d, rays.oy + l)), d, points.y + l);
    hn::Store(hn::MulAdd(t, hn::Load(d, rays.dz + l), hn::Load(d, rays.oz + l)), d, points.z + l);
  }
  alignas(64) float foretold[kPacket], rho[kPacket], slope[kPacket];
  std::copy_n(depth, kPacket, foretold);
  PacketMask found = 0;
  for_each_cluster(field, points, mask, 2.0f * spacing, field.options.smoothing_length + kFarthestCorrection * spacing,
                   false, list, [&](PacketMask group) {
                     PacketMask open = list.near_full ? 0 : group;  // lists there miss particles
                     for (int i = 0; i < 2 && open != 0; ++i) {
                       density_slopes(field, list, rays, depth, rho, slope);
                       PacketMask close = 0, wrong = 0;
                       for_each_chunk(open, [&](int l, auto of) {
                         const Vec steep = hn::Load(d, slope + l), place = hn::Load(d, depth + l);
                         const Vec rise = hn::Div(hn::Sub(iso, hn::Load(d, rho + l)), hn::Max(steep, least_slope));
                         const Vec next = hn::Add(place, rise);
                         const auto good = hn::And(hn::And(of, hn::Gt(steep, least_slope)),
                                                   hn::Le(hn::Abs(hn::Sub(next, hn::Load(d, foretold + l))), farthest));
                         store_in(good, next, depth + l);
                         close |= bits_of(hn::And(good, hn::Le(hn::Abs(rise), near))) << l;
                         wrong |= bits_of(hn::AndNot(good, of)) << l;
                       });
                       found |= close;
                       open &= ~(close | wrong);
                     }
                   });
  return found;
}

void NormalsPacket(const RaycastField& field, const PacketPoints& points, PacketMask mask, const PacketPoints& towards,
                   PacketList& list, PacketPoints& normals) {
  for_each_cluster(field, points, mask, 2.0f * field.options.spacing, field.options.normal_radius, false, list,
                   [&](PacketMask group) {
                     PacketPoints found;
                     normals_from_list(field, list, points, towards, found);
                     for (int l = 0; l < kPacket; ++l)
                       if ((group >> l) & 1u) {
                         normals.x[l] = found.x[l];
                         normals.y[l] = found.y[l];
                         normals.z[l] = found.z[l];
                       }
                   });
}

void DensityPacket(const RaycastField& field, const PacketPoints& points, PacketMask mask, bool unit_mass,
                   PacketList& list, float* density) {
  for_each_cluster(field, points, mask, 2.0f * field.options.smoothing_length, field.options.smoothing_length, false,
                   list, [&](PacketMask group) {
                     if (unit_mass) std::fill_n(list.mass.data(), list.count, 1.0f);
                     alignas(64) float found[kPacket];
                     density_at_points(field, list, points, found);
                     for (int l = 0; l < kPacket; ++l)
                       if ((group >> l) & 1u) density[l] = found[l];
                   });
}

void ColoursPacket(const RaycastField& field, const PacketPoints& points, PacketMask mask, PacketList& list,
                   PacketPoints& colours) {
  for_each_cluster(field, points, mask, 2.0f * field.options.spacing, field.options.smoothing_length, true, list,
                   [&](PacketMask group) {
                     PacketPoints found;
                     colours_from_list(field, list, points, found);
                     for (int l = 0; l < kPacket; ++l)
                       if ((group >> l) & 1u) {
                         colours.x[l] = found.x[l];
                         colours.y[l] = found.y[l];
                         colours.z[l] = found.z[l];
                       }
                   });
}

}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace meniscus {

HWY_EXPORT(CorrectPacket);
HWY_EXPORT(NormalsPacket);
HWY_EXPORT(DensityPacket);
HWY_EXPORT(ColoursPacket);

PacketMask correct_packet(const RaycastField& field, const PacketRays& rays, PacketMask mask, PacketList& list,
                          float* depth) {
  return HWY_DYNAMIC_DISPATCH(CorrectPacket)(field, rays, mask, list, depth);
}

void normals_packet(const RaycastField& field, const PacketPoints& points, PacketMask mask, const PacketPoints& towards,
                    PacketList& list, PacketPoints& normals) {
  HWY_DYNAMIC_DISPATCH(NormalsPacket)(field, points, mask, towards, list, normals);
}

void density_packet(const RaycastField& field, const PacketPoints& points, PacketMask mask, bool unit_mass,
                    PacketList& list, float* density) {
  HWY_DYNAMIC_DISPATCH(DensityPacket)(field, points, mask, unit_mass, list, density);
}

void colours_packet(const RaycastField& field, const PacketPoints& points, PacketMask mask, PacketList& list,
                    PacketPoints& colours) {
  HWY_DYNAMIC_DISPATCH(ColoursPacket)(field, points, mask, list, colours);
}

}  // namespace meniscus
#endif
