// The march of one packet; included once for each instruction set, after highway.h.

#if defined(MENISCUS_SURFACE_PACKET_MARCH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MENISCUS_SURFACE_PACKET_MARCH_INL_H_
#undef MENISCUS_SURFACE_PACKET_MARCH_INL_H_
#else
#define MENISCUS_SURFACE_PACKET_MARCH_INL_H_
#endif

#include <hwy/highway.h>

#include "surface/packet_lanes-inl.h"
#include "surface/packet_samples-inl.h"

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

/// The march of one packet. Sample n of a lane lies at entry + n step, as in the plain method; only which lanes are
/// summed together differs, and that kSamples samples are summed at once. Lanes that are near each other share a list
/// of the particles around a segment of their beam.
class March {
 public:
  March(const RaycastField& field, const PacketRays& rays, const float* entry, const float* exit, bool from_inside,
        PacketList& list)
      : field_(field),
        rays_(rays),
        entry_(entry),
        exit_(exit),
        sign_(from_inside ? -1.0f : 1.0f),
        samples_(field.step <= kLongestSweep * field.options.spacing ? kSamples : 1),
        list_(list) {}

  void run(PacketMask mask, float* depth) {
    const Tag d;
    active_ = mask & lanes_where([&](int l) { return hn::Le(hn::Load(d, entry_ + l), hn::Load(d, exit_ + l)); });
    std::copy_n(entry_, kPacket, at_);
    std::fill_n(count_, kPacket, 0.0f);
    std::fill_n(before_, kPacket, 0.0f);
    std::fill_n(earlier_, kPacket, 0.0f);
    std::fill_n(depth, kPacket, std::numeric_limits<float>::infinity());
    float stretch = kStretch * field_.options.spacing;
    while (active_ != 0) {
      // The lanes whose next sample lies in the first stretch of the beam go on together.
      float first = std::numeric_limits<float>::infinity();
      for_each_lane(active_, [&](int l) { first = std::min(first, at_[l]); });
      const Vec last = hn::Set(d, first + stretch);
      const PacketMask group = active_ & lanes_where([&](int l) { return hn::Lt(hn::Load(d, at_ + l), last); });
      const float ahead = static_cast<float>(samples_ - 1) * field_.step;
      gather_around(
          group, [&](int l) { return std::max(at_[l] - 1.5f * field_.step, entry_[l]); },
          [&](int l) { return std::min(at_[l] + ahead, exit_[l]); });
      if (list_.count == 0 && sign_ > 0 && !list_.near_full)
        skip(group);
      else
        sweep(group, depth);
    }
    start_inside(depth);
  }

 private:
  static constexpr int kSamples = 4;             ///< summed at once
  static constexpr float kLongestSweep = 0.67f;  ///< spacings a step, beyond which samples share too few particles
  static constexpr float kStretch = 1.0f;        ///< spacings between the lanes of a group

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

  /// The lanes' next sample is the one `samples` on.
  void advance(PacketMask lanes, float samples) {
    const Tag d;
    for_each_chunk(lanes, [&](int l, auto of) {
      const Vec count = hn::Add(hn::Load(d, count_ + l), hn::Set(d, samples));
      store_in(of, count, count_ + l);
      store_in(of, hn::MulAdd(count, hn::Set(d, field_.step), hn::Load(d, entry_ + l)), at_ + l);
    });
    active_ &= ~(lanes & lanes_where([&](int l) { return hn::Gt(hn::Load(d, at_ + l), hn::Load(d, exit_ + l)); }));
  }

  /// No particle is near: every sample of the stretch has density zero.
  void skip(PacketMask group) {
    const Tag d;
    for_each_chunk(group, [&](int l, auto of) {
      store_in(of, hn::Set(d, -field_.options.iso), before_ + l);
      store_in(of, hn::Set(d, -field_.options.iso), earlier_ + l);
    });
    advance(group, static_cast<float>(samples_));
  }

  /// The group's next samples, and the crossings that lie between them.
  void sweep(PacketMask group, float* depth) {
    const Tag d;
    alignas(64) float values[kSamples][kPacket];
    if (samples_ == 1)
      density_samples<1>(field_, list_, rays_, at_, field_.step, values);
    else
      density_samples<kSamples>(field_, list_, rays_, at_, field_.step, values);
    const Vec sign = hn::Set(d, sign_), minus_iso = hn::Set(d, -sign_ * field_.options.iso);
    const Vec least_summit = hn::Set(d, -kSummitMargin * field_.options.iso), zero = hn::Zero(d);
    PacketMask open = group, bracketed = 0;
    for (int k = 0; k < samples_ && open != 0; ++k) {
      if (k > 0) {
        const Vec ahead = hn::Set(d, static_cast<float>(k) * field_.step);
        const PacketMask beyond = open & lanes_where([&](int l) {
                                    return hn::Gt(hn::Add(hn::Load(d, at_ + l), ahead), hn::Load(d, exit_ + l));
                                  });
        active_ &= ~beyond;
        open &= ~beyond;
      }
      for (int l = 0; l < kPacket; l += static_cast<int>(hn::Lanes(d)))
        hn::Store(hn::MulAdd(sign, hn::Load(d, values[k] + l), minus_iso), d, values[k] + l);
      const PacketMask crossed = open & lanes_where([&](int l) { return hn::Ge(hn::Load(d, values[k] + l), zero); });
      const PacketMask summits = open & ~crossed & lanes_where([&](int l) {
                                   const Vec earlier = hn::Load(d, earlier_ + l), here = hn::Load(d, before_ + l),
                                             after = hn::Load(d, values[k] + l);
                                   return summit_between(earlier, here, after, least_summit);
                                 });
      bracketed |= take_crossings(crossed, k, values[k]);
      open &= ~crossed;
      if (summits != 0) {
        const PacketMask climbed = climb(summits, k, values[k]);
        bracketed |= climbed;
        open &= ~climbed;
      }
      for_each_chunk(open, [&](int l, auto of) {
        store_in(of, hn::Load(d, before_ + l), earlier_ + l);
        store_in(of, hn::Load(d, values[k] + l), before_ + l);
      });
    }
    refine(bracketed, depth);
    active_ &= ~bracketed;
    advance(open, static_cast<float>(samples_));
  }

  /// Whether the parabola through three samples rises above its middle one far enough. Lanes with fewer than two
  /// samples before have `earlier` = 0 or `here` = 0, above all values that have not crossed.
  static HWY_INLINE hn::Mask<Tag> summit_between(Vec earlier, Vec here, Vec after, Vec least) {
    const Tag d;
    const Vec difference = hn::Sub(after, earlier), fall = hn::Sub(hn::Add(here, here), hn::Add(earlier, after));
    // here + difference^2 / (8 fall) > least, fall > 0
    const auto high =
        hn::Gt(hn::MulAdd(difference, difference, hn::Mul(hn::Mul(hn::Set(d, 8.0f), fall), hn::Sub(here, least))),
               hn::Zero(d));
    return hn::And(high, hn::And(hn::And(hn::Gt(here, earlier), hn::Gt(here, after)), hn::Lt(earlier, hn::Zero(d))));
  }

  /// Brackets lanes that have crossed at their k-th sample; those whose very first has crossed are for start_inside().
  PacketMask take_crossings(PacketMask crossed, int k, const float* values) {
    if (crossed == 0) return 0;
    const Tag d;
    PacketMask fresh = 0;
    if (k == 0) fresh = crossed & lanes_where([&](int l) { return hn::Eq(hn::Load(d, count_ + l), hn::Zero(d)); });
    started_inside_ |= fresh;
    active_ &= ~fresh;
    crossed &= ~fresh;
    const Vec ahead = hn::Set(d, static_cast<float>(k) * field_.step), step = hn::Set(d, field_.step);
    for_each_chunk(crossed, [&](int l, auto of) {
      const Vec high = hn::Add(hn::Load(d, at_ + l), ahead);
      store_in(of, high, high_t_ + l);
      store_in(of, hn::Sub(high, step), low_t_ + l);
      store_in(of, hn::Load(d, values + l), high_value_ + l);
      store_in(of, hn::Load(d, before_ + l), low_value_ + l);
    });
    return crossed;
  }

  /// Looks at summits between the last samples; brackets the lanes that have crossed there, and tells which.
  PacketMask climb(PacketMask lanes, int k, const float* after) {
    alignas(64) float summit[kPacket], values[kPacket];
    std::copy_n(at_, kPacket, summit);
    const float step = field_.step;
    for_each_lane(lanes, [&](int l) {
      const float middle = at_[l] + static_cast<float>(k - 1) * step;
      summit[l] = middle + summit_of(earlier_[l], before_[l], after[l]).place * step;
    });
    values_at(summit, values);
    PacketMask crossed = 0;
    for_each_lane(lanes, [&](int l) {
      if (values[l] < 0.0f) return;
      const float middle = at_[l] + static_cast<float>(k - 1) * step;
      const bool beyond = summit[l] > middle;
      low_t_[l] = beyond ? middle : middle - step;
      low_value_[l] = beyond ? before_[l] : earlier_[l];
      high_t_[l] = summit[l];
      high_value_[l] = values[l];
      crossed |= 1u << l;
    });
    return crossed;
  }

  /// Where the line through the ends of the bracket is zero.
  HWY_INLINE Vec secant(int l) const {
    const Tag d;
    const Vec low = hn::Load(d, low_value_ + l), rise = hn::Sub(hn::Load(d, high_value_ + l), low);
    const Vec low_t = hn::Load(d, low_t_ + l), width = hn::Sub(hn::Load(d, high_t_ + l), low_t);
    const Vec part = hn::IfThenElse(hn::Gt(rise, hn::Zero(d)), hn::Div(hn::Neg(low), rise), hn::Set(d, 0.5f));
    return hn::MulAdd(hn::Min(hn::Max(part, hn::Zero(d)), hn::Set(d, 1.0f)), width, low_t);
  }

  void refine(PacketMask bracketed, float* depth) {
    if (bracketed == 0) return;
    const Tag d;
    alignas(64) float t[kPacket], values[kPacket];
    std::copy_n(at_, kPacket, t);
    const RaycastOptions& options = field_.options;
    for (int i = 0; i < options.refinement_steps; ++i) {
      const Vec half = hn::Set(d, 0.5f);
      for_each_chunk(bracketed, [&](int l, auto of) {
        const Vec middle = hn::Mul(half, hn::Add(hn::Load(d, low_t_ + l), hn::Load(d, high_t_ + l)));
        store_in(of, options.refinement == Refinement::secant ? secant(l) : middle, t + l);
      });
      values_at(t, values);
      narrow(bracketed, t, values);
    }
    for_each_chunk(bracketed, [&](int l, auto of) { store_in(of, secant(l), depth + l); });
  }

  void narrow(PacketMask bracketed, const float* t, const float* values) {
    const Tag d;
    for_each_chunk(bracketed, [&](int l, auto of) {
      const Vec value = hn::Load(d, values + l), place = hn::Load(d, t + l);
      const auto below = hn::Lt(value, hn::Zero(d));
      store_in(hn::And(of, below), place, low_t_ + l);
      store_in(hn::And(of, below), value, low_value_ + l);
      store_in(hn::AndNot(below, of), place, high_t_ + l);
      store_in(hn::AndNot(below, of), value, high_value_ + l);
    });
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
  int samples_;  ///< of a sweep
  PacketList& list_;
  PacketMask active_ = 0, started_inside_ = 0;
  alignas(64) float count_[kPacket];  ///< of the lane's next sample, which lies at at_
  alignas(64) float at_[kPacket];
  alignas(64) float earlier_[kPacket], before_[kPacket];  ///< values of the last two samples
  alignas(64) float low_t_[kPacket], low_value_[kPacket], high_t_[kPacket], high_value_[kPacket];
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#endif
