#include "surface/packet.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surface/packet_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// after highway.h
#include <hwy/contrib/math/math-inl.h>

#include "surface/packet_normals-inl.h"
#include "surface/packet_sums-inl.h"

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

/// The march of one packet. Sample n of a lane lies at entry + n step, as in the plain method; only which lanes
/// are summed together differs. Lanes that are near each other share a list of the particles around a segment
/// of their beam.
class March {
 public:
  March(const RaycastField& field, const PacketRays& rays, const float* entry, const float* exit, bool from_inside,
        PacketList& list)
      : field_(field), rays_(rays), entry_(entry), exit_(exit), sign_(from_inside ? -1.0f : 1.0f), list_(list) {}

  void run(PacketMask mask, float* depth) {
    for (int l = 0; l < kPacket; ++l) {
      depth[l] = std::numeric_limits<float>::infinity();
      count_[l] = 0;
      at_[l] = entry_[l];
      before_[l] = earlier_[l] = 0.0f;
      if (((mask >> l) & 1u) && !(entry_[l] <= exit_[l])) mask &= ~(1u << l);
    }
    fresh_ = mask;
    active_ = mask;
    while (active_ != 0) {
      // The lanes whose next sample lies in the first stretch of the beam go on together.
      float first = std::numeric_limits<float>::infinity();
      for_each_lane(active_, [&](int l) { first = std::min(first, at_[l]); });
      const float last = first + kStretch * field_.options.spacing;
      PacketMask group = 0;
      for_each_lane(active_, [&](int l) { group |= at_[l] < last ? 1u << l : 0u; });
      gather_around(
          group, [&](int l) { return std::max(at_[l] - 2.0f * field_.step, entry_[l]); },
          [&](int l) { return std::min(last, exit_[l]); });
      if (list_.count == 0 && sign_ > 0 && !list_.near_full)
        skip(group, last);
      else
        walk(group, last, depth);
    }
    start_inside(depth);
  }

 private:
  static constexpr float kStretch = 1.0f;  ///< spacings; longer lists cost more than more of them

  template <class Visit>
  static void for_each_lane(PacketMask mask, Visit visit) {
    for (; mask != 0; mask &= mask - 1) visit(__builtin_ctz(mask));
  }

  /// Fills the list with the particles within the smoothing length of the box around the lanes' segments.
  template <class From, class To>
  void gather_around(PacketMask lanes, From from, To to) {
    vec3 low{std::numeric_limits<float>::infinity()}, high{-std::numeric_limits<float>::infinity()};
    for_each_lane(lanes, [&](int l) {
      for (const float t : {from(l), to(l)}) {
        const float x = rays_.ox[l] + t * rays_.dx[l], y = rays_.oy[l] + t * rays_.dy[l],
                    z = rays_.oz[l] + t * rays_.dz[l];
        low = {std::min(low.x, x), std::min(low.y, y), std::min(low.z, z)};
        high = {std::max(high.x, x), std::max(high.y, y), std::max(high.z, z)};
      }
    });
    gather_list(field_, low, high, field_.options.smoothing_length, false, list_);
  }

  /// Values are sign (rho - iso): a lane has crossed when its value is not negative.
  void values_at(const float* t, float* values) {
    density_along_rays(field_, list_, rays_, t, values);
    for (int l = 0; l < kPacket; ++l) values[l] = sign_ * (values[l] - field_.options.iso);
  }

  void advance(int l) {
    ++count_[l];
    at_[l] = entry_[l] + static_cast<float>(count_[l]) * field_.step;
    fresh_ &= ~(1u << l);
  }

  /// No particle is near: every sample of the stretch has density zero.
  void skip(PacketMask group, float last) {
    for_each_lane(group, [&](int l) {
      while (at_[l] < last && at_[l] <= exit_[l]) advance(l);
      before_[l] = earlier_[l] = -field_.options.iso;
      if (at_[l] > exit_[l]) active_ &= ~(1u << l);
    });
  }

  void walk(PacketMask group, float last, float* depth) {
    alignas(64) float values[kPacket];
    PacketMask bracketed = 0;
    for (;;) {
      PacketMask walking = 0;
      for_each_lane(group & active_ & ~bracketed, [&](int l) {
        if (at_[l] > exit_[l])
          active_ &= ~(1u << l);
        else if (at_[l] < last)
          walking |= 1u << l;
      });
      if (walking == 0) break;
      values_at(at_, values);
      PacketMask summits = 0;
      alignas(64) float summit[kPacket];
      std::copy_n(at_, kPacket, summit);
      for_each_lane(walking, [&](int l) {
        if (values[l] < 0.0f) {
          if (count_[l] >= 2 && before_[l] > earlier_[l] && before_[l] > values[l]) {
            const Summit found = summit_of(earlier_[l], before_[l], values[l]);
            if (found.value > -kSummitMargin * field_.options.iso) {
              summit[l] = at_[l] - field_.step + found.place * field_.step;
              summits |= 1u << l;
            }
          }
        } else if ((fresh_ >> l) & 1u) {
          started_inside_ |= 1u << l;
          active_ &= ~(1u << l);
        } else {
          bracketed |= 1u << l;
          bracket(l, at_[l] - field_.step, before_[l], at_[l], values[l]);
        }
      });
      if (summits != 0) bracketed |= climb(summits, summit);
      for_each_lane(walking & ~bracketed & active_, [&](int l) {
        earlier_[l] = before_[l];
        before_[l] = values[l];
        advance(l);
      });
    }
    refine(bracketed, depth);
    active_ &= ~bracketed;
  }

  void bracket(int l, float low_t, float low_value, float high_t, float high_value) {
    low_t_[l] = low_t;
    low_value_[l] = low_value;
    high_t_[l] = high_t;
    high_value_[l] = high_value;
  }

  /// Looks at summits between the last samples; brackets the lanes that have crossed there, and tells which.
  PacketMask climb(PacketMask lanes, const float* summit) {
    alignas(64) float values[kPacket];
    values_at(summit, values);
    PacketMask crossed = 0;
    for_each_lane(lanes, [&](int l) {
      if (values[l] < 0.0f) return;
      const float middle = at_[l] - field_.step;
      if (summit[l] > middle)
        bracket(l, middle, before_[l], summit[l], values[l]);
      else
        bracket(l, middle - field_.step, earlier_[l], summit[l], values[l]);
      crossed |= 1u << l;
    });
    return crossed;
  }

  /// Where the line through the ends of the bracket is zero.
  float secant(int l) const {
    const float rise = high_value_[l] - low_value_[l];
    const float part = rise > 0.0f ? -low_value_[l] / rise : 0.5f;
    return low_t_[l] + std::clamp(part, 0.0f, 1.0f) * (high_t_[l] - low_t_[l]);
  }

  void refine(PacketMask bracketed, float* depth) {
    if (bracketed == 0) return;
    alignas(64) float t[kPacket], values[kPacket];
    const bool by_secant = field_.options.refinement == Refinement::secant;
    std::copy_n(at_, kPacket, t);
    for (int i = 0; i < field_.options.refinement_steps; ++i) {
      for_each_lane(bracketed, [&](int l) { t[l] = by_secant ? secant(l) : 0.5f * (low_t_[l] + high_t_[l]); });
      values_at(t, values);
      for_each_lane(bracketed, [&](int l) {
        (values[l] < 0.0f ? low_t_ : high_t_)[l] = t[l];
        (values[l] < 0.0f ? low_value_ : high_value_)[l] = values[l];
      });
    }
    for_each_lane(bracketed, [&](int l) { depth[l] = secant(l); });
  }

  /// Lanes whose very first sample had crossed (particles packed closer than expected): steps back, a smoothing
  /// length at most, until outside.
  void start_inside(float* depth) {
    alignas(64) float t[kPacket], values[kPacket];
    const int steps = static_cast<int>(std::ceil(field_.options.smoothing_length / field_.step));
    while (started_inside_ != 0) {
      float first = std::numeric_limits<float>::infinity();
      for_each_lane(started_inside_, [&](int l) { first = std::min(first, entry_[l]); });
      PacketMask group = 0;
      for_each_lane(started_inside_,
                    [&](int l) { group |= entry_[l] < first + field_.options.smoothing_length ? 1u << l : 0u; });
      started_inside_ &= ~group;
      gather_around(
          group, [&](int l) { return std::max(entry_[l] - static_cast<float>(steps) * field_.step, 0.0f); },
          [&](int l) { return entry_[l]; });
      std::copy_n(entry_, kPacket, t);
      values_at(t, high_value_);
      PacketMask bracketed = 0;
      for_each_lane(group, [&](int l) { high_t_[l] = depth[l] = entry_[l]; });
      for (int n = 1; n <= steps && group != 0; ++n) {
        for_each_lane(group, [&](int l) { t[l] = std::max(entry_[l] - static_cast<float>(n) * field_.step, 0.0f); });
        values_at(t, values);
        PacketMask done = 0;
        for_each_lane(group, [&](int l) {
          if (values[l] < 0.0f) {
            low_t_[l] = t[l];
            low_value_[l] = values[l];
            bracketed |= 1u << l;
            done |= 1u << l;
          } else {
            high_t_[l] = depth[l] = t[l];
            high_value_[l] = values[l];
            if (t[l] == 0.0f) done |= 1u << l;
          }
        });
        group &= ~done;
      }
      refine(bracketed, depth);
    }
  }

  const RaycastField& field_;
  const PacketRays& rays_;
  const float* entry_;
  const float* exit_;
  float sign_;
  PacketList& list_;
  PacketMask active_ = 0, fresh_ = 0, started_inside_ = 0;
  int count_[kPacket];
  alignas(64) float at_[kPacket];
  float earlier_[kPacket], before_[kPacket];  ///< values of the last two samples
  float low_t_[kPacket], low_value_[kPacket], high_t_[kPacket], high_value_[kPacket];
};

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

}  // namespace

void MarchPacket(const RaycastField& field, const PacketRays& rays, PacketMask mask, const float* entry,
                 const float* exit, bool from_inside, PacketList& list, float* depth) {
  March(field, rays, entry, exit, from_inside, list).run(mask, depth);
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

HWY_EXPORT(MarchPacket);
HWY_EXPORT(NormalsPacket);
HWY_EXPORT(DensityPacket);
HWY_EXPORT(ColoursPacket);

void march_packet(const RaycastField& field, const PacketRays& rays, PacketMask mask, const float* entry,
                  const float* exit, bool from_inside, PacketList& list, float* depth) {
  HWY_DYNAMIC_DISPATCH(MarchPacket)(field, rays, mask, entry, exit, from_inside, list, depth);
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
