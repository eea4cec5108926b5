// The march of one beam; included once for each instruction set, after highway.h.

#if defined(MENISCUS_SURFACE_BEAM_MARCH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MENISCUS_SURFACE_BEAM_MARCH_INL_H_
#undef MENISCUS_SURFACE_BEAM_MARCH_INL_H_
#else
#define MENISCUS_SURFACE_BEAM_MARCH_INL_H_
#endif

#include <hwy/highway.h>

#include "surface/beam_sums-inl.h"

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

/// The march of one beam by the rules of the plain method: sample n of a ray lies at entry + n step.
template <class Shape, bool kSizes>
class BeamMarch {
 public:
  BeamMarch(const RaycastField& field, bool from_inside, BeamLists& lists, Beam& beam)
      : field_(field),
        lists_(lists),
        beam_(beam),
        sign_(from_inside ? -1.0f : 1.0f),
        step_(field.step),
        per_h_(1.0f / field.options.smoothing_length),
        samples_(field.step <= kLongestSweep * field.options.spacing ? kRaySamples : 1) {}

  void run() {
    for (int i = 0; i < beam_.count; ++i) {
      beam_.depth[i] = std::numeric_limits<float>::infinity();
      at_[i] = beam_.entry[i];
      sample_[i] = 0;
      before_[i] = earlier_[i] = 0;
      if (beam_.entry[i] <= beam_.exit[i]) active_ |= BeamMask{1} << i;
    }
    const float ahead = ahead_of_sweep();
    float beyond = kMoreSteps * step_;
    while (active_ != 0) {
      BeamMask left = active_;
      BeamMask group = take_group(beam_, at_, left);
      const float last = largest_of(group, at_) + ahead + beyond;
      gather(group, first_of(group), last);
      // Where nothing is near, farther is looked next time.
      beyond = lists_.near[0].count == 0 ? std::min(4.0f * beyond, kMostSteps * step_) : kMoreSteps * step_;
      do {
        look_from(group, lists_.near[0], 0, 0);
        group &= active_;
        BeamMask reached = 0;
        for_each_vector(group, [&](int i, auto of) {
          const Tag d;
          const auto within = hn::Le(hn::Add(hn::LoadU(d, at_ + i), hn::Set(d, ahead)), hn::Set(d, last));
          reached |= BeamMask{bits_of(hn::And(of, within))} << i;
        });
        group = reached;
      } while (group != 0);
    }
    start_inside();
  }

 private:
  static constexpr float kLongestSweep = 0.67f;  ///< spacings a step, beyond which samples share too few particles
  static constexpr int kRays = BeamLists::kRays;
  static constexpr float kNearRoot = 0.04f;     ///< spacings
  static constexpr float kMoreSteps = 4.0f;     ///< gathered beyond the next samples
  static constexpr float kMostSteps = 64.0f;    ///< the same where nothing has been near
  static constexpr std::size_t kFewNear = 160;  ///< particles, of which every ray makes its own list at once
  static constexpr int kWorthNarrowing = 3;     ///< rays

  /// m from the first to the last sample of a sweep.
  float ahead_of_sweep() const { return static_cast<float>(samples_ - 1) * step_; }

  /// From where on the density is asked when a ray goes on at at_: summits may lie before it.
  float back(int i) const { return std::max(at_[i] - 2.0f * step_, beam_.entry[i]); }
  float first_of(BeamMask group) const {
    const Tag d;
    const Vec two_steps = hn::Set(d, 2.0f * step_);
    Vec first = hn::Set(d, std::numeric_limits<float>::infinity());
    for_each_vector(group, [&](int i, auto of) {
      const Vec back = hn::Max(hn::Sub(hn::LoadU(d, at_ + i), two_steps), hn::LoadU(d, beam_.entry + i));
      first = hn::IfThenElse(of, hn::Min(first, back), first);
    });
    return hn::GetLane(hn::MinOfLanes(d, first));
  }

  void gather(BeamMask group, float first, float last) {
    const float reach = field_.options.smoothing_length;
    gather_capsule(field_, capsule_around(beam_, group, first, last, reach), reach, lists_.near[0]);
  }

  /// The next samples of some rays, of those that are left of kBeam / 4^level from `begin` on.
  /// @param near  what is gathered around all that they look at
  void look_from(BeamMask group, const PacketList& near, int level, int begin) {
    if (near.count == 0 && sign_ > 0 && !near.near_full) return for_each_ray(group, [&](int i) { skip(i); });
    const int part = kBeam >> (2 * level + 2);
    if (level + 1 == BeamLists::kLevels || near.count <= kFewNear || __builtin_popcountll(group) < kWorthNarrowing) {
      const float ahead = ahead_of_sweep();
      return in_turn(
          group, near, [&](int i) { return back(i); }, [&](int i) { return at_[i] + ahead; }, at_,
          [&](const int* rays, int count) { sweep(rays, count); });
    }
    for (; group != 0; begin += part) {
      const BeamMask some = group & (((BeamMask{1} << part) - 1) << begin);
      group &= ~some;
      if (some == 0) continue;
      const float reach = field_.options.smoothing_length;
      const Capsule capsule =
          capsule_around(beam_, some, first_of(some), largest_of(some, at_) + ahead_of_sweep(), reach);
      narrow_list<kSizes>(field_, near, capsule, reach, lists_.near[level + 1]);
      look_from(some, lists_.near[level + 1], level + 1, begin);
    }
  }

  /// Makes the lists of a few rays at a time for their stretches, places counted from start[i], and visits those.
  template <class First, class Last, class Visit>
  HWY_INLINE void in_turn(BeamMask group, const PacketList& near, First first, Last last, const float* start,
                          Visit visit) {
    near_full_ = near.near_full;
    while (group != 0) {
      int rays[kRays], count = 0;
      for (; count < kRays && group != 0; group &= group - 1) {
        const int i = __builtin_ctzll(group);
        list_along<kSizes>(field_, near, beam_.origin(i), beam_.direction(i), first(i), last(i), start[i],
                           lists_.ray[count]);
        start_[i] = start[i];
        rays[count++] = i;
      }
      visit(rays, count);
    }
  }

  /// sign (rho - iso): a ray has crossed when this is not negative.
  HWY_INLINE float value_of(float sum, int i, float t) const {
    float rho = sum * field_.scale;
    if (HWY_UNLIKELY(near_full_) && field_.grid.full_at(beam_.origin(i) + t * beam_.direction(i))) rho = 1.0f;
    return sign_ * (rho - field_.options.iso);
  }

  HWY_INLINE float value_at(const RayList& list, int i, float t) const {
    return value_of(sum_ray_density<Shape, kSizes>(list, per_h_, t - start_[i]), i, t);
  }

  /// The ray's next sample is the one `samples` on.
  void advance(int i) {
    sample_[i] += static_cast<float>(samples_);
    at_[i] = beam_.entry[i] + sample_[i] * step_;
    if (at_[i] > beam_.exit[i]) active_ &= ~(BeamMask{1} << i);
  }

  /// No particle is near: every sample of the stretch has density zero.
  void skip(int i) {
    before_[i] = earlier_[i] = -field_.options.iso;
    advance(i);
  }

  struct Bracket {
    float low_t, low, high_t, high;
    /// Where the line through the ends is zero.
    float secant() const {
      const float part = high > low ? -low / (high - low) : 0.5f;
      return low_t + std::clamp(part, 0.0f, 1.0f) * (high_t - low_t);
    }
    void narrow(float t, float value) {
      (value < 0.0f ? low_t : high_t) = t;
      (value < 0.0f ? low : high) = value;
    }
  };

  /// The next samples of a few rays, and the crossings that lie between them.
  void sweep(const int* rays, int count) {
    float sums[kRays][kRaySamples];
    for (int r = 0; r < count; ++r) sum_ray_samples<Shape, kSizes>(lists_.ray[r], per_h_, step_, sums[r]);
    Bracket brackets[kRays];
    int crossed[kRays], crossings = 0;
    for (int r = 0; r < count; ++r)
      if (look(rays[r], lists_.ray[r], sums[r], brackets[r])) crossed[crossings++] = r;
    refine(rays, crossed, crossings, brackets);
  }

  /// Whether a ray crosses between its next samples.
  HWY_INLINE bool look(int i, const RayList& list, const float* sums, Bracket& bracket) {
    const BeamMask bit = BeamMask{1} << i;
    float before = before_[i], earlier = earlier_[i];
    for (int k = 0; k < samples_; ++k) {
      const float t = at_[i] + static_cast<float>(k) * step_;
      if (t > beam_.exit[i]) {
        active_ &= ~bit;
        return false;
      }
      const float value = value_of(sums[k], i, t);
      if (value >= 0.0f) {
        active_ &= ~bit;
        if (k == 0 && sample_[i] == 0.0f) {
          started_inside_ |= bit;
          return false;
        }
        bracket = {t - step_, before, t, value};
        return true;
      }
      // With fewer than two samples before, `earlier` or `before` is zero, above all values that have not crossed.
      if (HWY_UNLIKELY(before > earlier && before > value && earlier < 0.0f)) {
        const Summit summit = summit_of(earlier, before, value);
        if (summit.value > -kSummitMargin * field_.options.iso) {
          const float middle = t - step_, at = middle + summit.place * step_;
          const float highest = value_at(list, i, at);
          if (highest >= 0.0f) {
            bracket =
                at > middle ? Bracket{middle, before, at, highest} : Bracket{middle - step_, earlier, at, highest};
            active_ &= ~bit;
            return true;
          }
        }
      }
      earlier = before;
      before = value;
    }
    before_[i] = before;
    earlier_[i] = earlier;
    advance(i);
    return false;
  }

  /// Narrows the brackets of `count` of some rays and takes their depths.
  HWY_INLINE void refine(const int* rays, const int* crossed, int count, Bracket* brackets) {
    const RaycastOptions& options = field_.options;
    if (!kSizes && options.refinement == Refinement::secant && options.refinement_steps == 2 && !near_full_ &&
        samples_ > 1) {
      for (int c = 0; c < count; ++c)
        beam_.depth[rays[crossed[c]]] = steep_root(lists_.ray[crossed[c]], rays[crossed[c]], brackets[crossed[c]]);
      return;
    }
    for (int n = 0; n < options.refinement_steps; ++n)
      for (int c = 0; c < count; ++c) {
        Bracket& of = brackets[crossed[c]];
        const float t = options.refinement == Refinement::secant ? of.secant() : 0.5f * (of.low_t + of.high_t);
        of.narrow(t, value_at(lists_.ray[crossed[c]], rays[crossed[c]], t));
      }
    for (int c = 0; c < count; ++c) beam_.depth[rays[crossed[c]]] = brackets[crossed[c]].secant();
  }

  /// Where a ray crosses, by one sum with its derivative: that and the end of the bracket beyond the root make a
  /// parabola. Where the root is not near, by two sums and the secant, as the plain method does it.
  HWY_INLINE float steep_root(const RayList& list, int i, Bracket of) const {
    const float t = of.secant();
    const SumAndSlope found = sum_ray_slope<Shape>(list, per_h_, t - start_[i]);
    const float value = sign_ * (found.rho * field_.scale - field_.options.iso);
    const float rise = sign_ * found.slope * field_.scale;
    of.narrow(t, value);
    const float end = (value < 0.0f ? of.high_t : of.low_t) - t, end_value = value < 0.0f ? of.high : of.low;
    const float newton = -value / rise;
    // The parabola through (0, value) with this rise and (end, end_value).
    const float bend = (end_value - value - rise * end) / (end * end);
    const float step = -value / (rise + bend * newton);
    if (std::abs(newton) < kNearRoot * field_.options.spacing && step / end >= 0.0f && step / end <= 1.0f)
      return t + step;
    const float next = of.secant();
    of.narrow(next, value_at(list, i, next));
    return of.secant();
  }

  /// Rays whose very first sample had crossed (particles packed closer than expected): steps back, a smoothing length
  /// at most, until outside.
  void start_inside() {
    const int steps = static_cast<int>(std::ceil(field_.options.smoothing_length / step_));
    const auto first = [&](int i) { return std::max(beam_.entry[i] - static_cast<float>(steps) * step_, 0.0f); };
    while (started_inside_ != 0) {
      const BeamMask group = take_group(beam_, beam_.entry, started_inside_);
      float from = std::numeric_limits<float>::infinity(), to = 0;
      for_each_ray(group, [&](int i) {
        from = std::min(from, first(i));
        to = std::max(to, beam_.entry[i]);
      });
      gather(group, from, to);
      in_turn(
          group, lists_.near[0], first, [&](int i) { return beam_.entry[i]; }, beam_.entry,
          [&](const int* rays, int count) {
            Bracket brackets[kRays];
            int crossed[kRays], crossings = 0;
            for (int r = 0; r < count; ++r)
              if (walk_back(rays[r], lists_.ray[r], steps, brackets[r])) crossed[crossings++] = r;
            refine(rays, crossed, crossings, brackets);
          });
    }
  }

  /// Whether a ray has been outside before its entry.
  bool walk_back(int i, const RayList& list, int steps, Bracket& bracket) {
    float high_t = beam_.entry[i], high = value_at(list, i, high_t);
    for (int n = 1; n <= steps; ++n) {
      const float t = std::max(beam_.entry[i] - static_cast<float>(n) * step_, 0.0f), value = value_at(list, i, t);
      if (value < 0.0f) {
        bracket = {t, value, high_t, high};
        return true;
      }
      high_t = t;
      high = value;
      if (t == 0.0f) break;
    }
    beam_.depth[i] = high_t;
    return false;
  }

  const RaycastField& field_;
  BeamLists& lists_;
  Beam& beam_;
  float sign_, step_, per_h_;
  int samples_;             ///< of a sweep
  bool near_full_ = false;  ///< of what the lists were made of
  BeamMask active_ = 0, started_inside_ = 0;
  float sample_[kBeam], at_[kBeam];       ///< the ray's next sample, and where it lies
  float start_[kBeam];                    ///< what the places of its list are counted from
  float earlier_[kBeam], before_[kBeam];  ///< values of the last two samples
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#endif
