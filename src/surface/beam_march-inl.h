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

/// Rays whose stretches begin within so many spacings of each other, along and across, share what is gathered.
constexpr float kAlong = 2.5f, kAcross = 3.0f;

/// Takes rays off the mask whose places, m along each, lie near that of the first of them.
HWY_INLINE BeamMask take_group(const Beam& beam, const float* at, float spacing, BeamMask& left) {
  int seed = __builtin_ctzll(left);
  for_each_ray(left, [&](int i) { seed = at[i] < at[seed] ? i : seed; });
  const float last = at[seed] + kAlong * spacing, across2 = kAcross * kAcross * spacing * spacing;
  const vec3 centre = beam.origin(seed) + at[seed] * beam.direction(seed);
  BeamMask group = BeamMask{1} << seed;  // whatever its place is
  for_each_ray(left, [&](int i) {
    const vec3 off = beam.origin(i) + at[seed] * beam.direction(i) - centre;
    if (at[i] < last && glm::dot(off, off) <= across2) group |= BeamMask{1} << i;
  });
  left &= ~group;
  return group;
}

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
    const float ahead = static_cast<float>(samples_ - 1) * step_;
    while (active_ != 0) {
      BeamMask left = active_;
      const BeamMask group = take_group(beam_, at_, field_.options.spacing, left);
      float first = std::numeric_limits<float>::infinity(), last = 0;
      for_each_ray(group, [&](int i) {
        first = std::min(first, back(i));
        last = std::max(last, at_[i] + ahead);
      });
      gather(group, first, last);
      if (lists_.near.count == 0 && sign_ > 0 && !lists_.near.near_full)
        for_each_ray(group, [&](int i) { skip(i); });
      else
        in_turn(
            group, [&](int i) { return back(i); }, [&](int i) { return at_[i] + ahead; }, at_,
            [&](const int* rays, int count) { sweep(rays, count); });
    }
    start_inside();
  }

 private:
  static constexpr float kLongestSweep = 0.67f;  ///< spacings a step, beyond which samples share too few particles
  static constexpr int kRays = BeamLists::kRays;

  /// From where on the density is asked when a ray goes on at at_: summits may lie before it.
  float back(int i) const { return std::max(at_[i] - 2.0f * step_, beam_.entry[i]); }

  void gather(BeamMask group, float first, float last) {
    const float reach = field_.options.smoothing_length;
    gather_capsule(field_, capsule_around(beam_, group, first, last, reach), reach, lists_.near);
  }

  /// Makes the lists of a few rays at a time for their stretches, places counted from start[i], and visits those.
  template <class First, class Last, class Visit>
  HWY_INLINE void in_turn(BeamMask group, First first, Last last, const float* start, Visit visit) {
    while (group != 0) {
      int rays[kRays], count = 0;
      for (; count < kRays && group != 0; group &= group - 1) {
        const int i = __builtin_ctzll(group);
        list_along<kSizes>(field_, lists_.near, beam_.origin(i), beam_.direction(i), first(i), last(i), start[i],
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
    if (HWY_UNLIKELY(lists_.near.near_full) && field_.grid.full_at(beam_.origin(i) + t * beam_.direction(i)))
      rho = 1.0f;
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
    for (int n = 0; n < options.refinement_steps; ++n)
      for (int c = 0; c < count; ++c) {
        Bracket& of = brackets[crossed[c]];
        const float t = options.refinement == Refinement::secant ? of.secant() : 0.5f * (of.low_t + of.high_t);
        of.narrow(t, value_at(lists_.ray[crossed[c]], rays[crossed[c]], t));
      }
    for (int c = 0; c < count; ++c) beam_.depth[rays[crossed[c]]] = brackets[crossed[c]].secant();
  }

  /// Rays whose very first sample had crossed (particles packed closer than expected): steps back, a smoothing length
  /// at most, until outside.
  void start_inside() {
    const int steps = static_cast<int>(std::ceil(field_.options.smoothing_length / step_));
    const auto first = [&](int i) { return std::max(beam_.entry[i] - static_cast<float>(steps) * step_, 0.0f); };
    while (started_inside_ != 0) {
      const BeamMask group = take_group(beam_, beam_.entry, field_.options.spacing, started_inside_);
      float from = std::numeric_limits<float>::infinity(), to = 0;
      for_each_ray(group, [&](int i) {
        from = std::min(from, first(i));
        to = std::max(to, beam_.entry[i]);
      });
      gather(group, from, to);
      in_turn(
          group, first, [&](int i) { return beam_.entry[i]; }, beam_.entry,
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
  int samples_;  ///< of a sweep
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
