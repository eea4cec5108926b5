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
        samples_(field.step <= kLongestSweep * field.options.spacing ? kRaySamples : 1) {}

  void run() {
    for (int i = 0; i < kBeam; ++i) {
      at_[i] = i < beam_.count ? beam_.entry[i] : 0.0f;
      sample_[i] = before_[i] = earlier_[i] = 0;
    }
    for (int i = 0; i < beam_.count; ++i) {
      beam_.depth[i] = std::numeric_limits<float>::infinity();
      if (beam_.entry[i] <= beam_.exit[i]) active_ |= BeamMask{1} << i;
    }
    const float ahead = ahead_of_sweep();
    float beyond = kMoreSteps * step_;
    while (active_ != 0) {
      BeamMask left = active_;
      BeamMask group = take_group(beam_, at_, left);
      const float last = largest_of(group, at_) + ahead + beyond;
      gather(group, first_of(group), last);
      group = leapt(group, last);
      // Where nothing is near, farther is looked next time.
      const bool nothing = group == 0 || lists_.whole.count == 0;
      beyond = nothing ? std::min(4.0f * beyond, kMostSteps * step_) : kMoreSteps * step_;
      while (group != 0) {
        for_each_part(group, [&](int first, PacketMask rays) { look(first, rays); });
        group = leapt(group, last);
      }
    }
    start_inside();
  }

 private:
  static constexpr float kLongestSweep = 0.67f;  ///< spacings a step, beyond which samples share too few particles
  static constexpr float kNearRoot = 0.04f;      ///< spacings
  static constexpr float kMoreSteps = 4.0f;      ///< gathered beyond the next samples
  static constexpr float kMostSteps = 64.0f;     ///< the same where nothing has been near
  static constexpr std::size_t kFewOfPart = 160, kFewOfFour = 64;  ///< particles that need not be narrowed
  static constexpr int kFours = kPacket / kFour;

  /// Calls visit(first, rays) for the sixteens of rays that hold some of the mask.
  template <class Visit>
  static HWY_INLINE void for_each_part(BeamMask mask, Visit visit) {
    for (int first = 0; first < kBeam; first += kPacket)
      if (const auto rays = static_cast<PacketMask>(mask >> first & 0xffffu); rays != 0) visit(first, rays);
  }
  /// Calls visit(four, rays) for the fours of a part that hold some of the mask.
  template <class Visit>
  static HWY_INLINE void for_each_four(PacketMask mask, Visit visit) {
    for (int four = 0; four < kFours; ++four)
      if (const PacketMask rays = mask & 0xfu << kFour * four; rays != 0) visit(four, rays);
  }

  /// m from the first to the last sample of a sweep.
  float ahead_of_sweep() const { return static_cast<float>(samples_ - 1) * step_; }

  /// From where on the density is asked when rays go on at at_: summits may lie before it.
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
    gather_capsule(field_, capsule_around(beam_, group, first, last, reach), reach, lists_.whole);
  }

  /// What of a list is near a stretch of some rays: the list itself if it is short.
  const PacketList& narrowed(const PacketList& near, BeamMask rays, float first, float last, std::size_t few,
                             PacketList& list) const {
    if (near.count <= few) return near;
    const float reach = field_.options.smoothing_length;
    narrow_list<kSizes>(field_, near, capsule_around(beam_, rays, first, last, reach), reach, list);
    return list;
  }

  /// Takes rays that have left the sphere that they entered to the next one: no density reaches the iso-value before.
  /// @param last  m: as far as particles are gathered
  /// @return  the rays that go on and whose next samples all lie before that
  BeamMask leapt(BeamMask group, float last) {
    group &= active_;
    if (sign_ > 0 && !lists_.whole.near_full)
      for_each_ray(group, [&](int i) {
        if (sample_[i] > 0.0f) leap(i, last);
      });
    const Tag d;
    const float ahead = ahead_of_sweep();
    BeamMask reached = 0;
    for_each_vector(group & active_, [&](int i, auto of) {
      const auto within = hn::Le(hn::Add(hn::LoadU(d, at_ + i), hn::Set(d, ahead)), hn::Set(d, last));
      reached |= BeamMask{bits_of(hn::And(of, within))} << i;
    });
    return reached;
  }

  HWY_INLINE void leap(int i, float last) {
    const float free = std::min(next_entry(i), last - at_[i]);
    // Two samples lie before the sphere, so that a crossing has its bracket, and a summit its three values.
    const float steps = std::floor(free / step_) - 1.0f;
    if (!(steps >= 1.0f)) return;
    sample_[i] += steps;
    at_[i] = beam_.entry[i] + sample_[i] * step_;
    before_[i] = earlier_[i] = -field_.options.iso;
    if (at_[i] > beam_.exit[i]) active_ &= ~(BeamMask{1} << i);
  }

  /// m from at_ to where the ray enters the next of the spheres around the gathered particles; negative inside of one.
  HWY_INLINE float next_entry(int i) const {
    const Tag d;
    const PacketList& near = lists_.whole;
    const vec3 direction = beam_.direction(i), at = beam_.origin(i) + at_[i] * direction;
    const Vec x0 = hn::Set(d, at.x), y0 = hn::Set(d, at.y), z0 = hn::Set(d, at.z), dx = hn::Set(d, direction.x),
              dy = hn::Set(d, direction.y), dz = hn::Set(d, direction.z), zero = hn::Zero(d),
              share = hn::Set(d, field_.widest_entry);
    const float radius = field_.widest_entry * field_.options.smoothing_length;
    Vec radius2 = hn::Set(d, radius * radius), next = hn::Set(d, std::numeric_limits<float>::infinity());
    for (std::size_t j = 0; j < near.count; j += hn::Lanes(d)) {
      const Vec x = hn::Sub(hn::Load(d, near.x.data() + j), x0), y = hn::Sub(hn::Load(d, near.y.data() + j), y0),
                z = hn::Sub(hn::Load(d, near.z.data() + j), z0);
      if constexpr (kSizes) {
        const Vec own = hn::Div(share, hn::Load(d, near.per_smoothing.data() + j));
        radius2 = hn::Mul(own, own);
      }
      const Vec along = hn::MulAdd(x, dx, hn::MulAdd(y, dy, hn::Mul(z, dz)));
      const Vec off2 = hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
      const Vec half2 = hn::Sub(radius2, hn::NegMulAdd(along, along, off2));
      const Vec half = hn::Sqrt(hn::Max(half2, zero));
      const auto ahead = hn::And(hn::Gt(half2, zero), hn::Gt(hn::Add(along, half), zero));
      const auto hit = hn::And(ahead, hn::FirstN(d, near.count - j));
      next = hn::IfThenElse(hit, hn::Min(next, hn::Sub(along, half)), next);
    }
    return hn::GetLane(hn::MinOfLanes(d, next));
  }

  /// Takes the next samples of the rays of a part, and the crossings that lie between them.
  void look(int first, PacketMask rays) {
    const auto next_of = [&](const PacketList& near, PacketMask some, std::size_t few,
                             PacketList& list) -> const PacketList& {
      const BeamMask mask = BeamMask{some} << first;
      return narrowed(near, mask, first_of(mask), largest_of(mask, at_) + ahead_of_sweep(), few, list);
    };
    const PacketList& near = next_of(lists_.whole, rays, kFewOfPart, lists_.part);
    alignas(64) float values[2 + kRaySamples][kPacket];  // the last two, and the next
    std::copy_n(earlier_ + first, kPacket, values[0]);
    std::copy_n(before_ + first, kPacket, values[1]);
    for_each_four(rays, [&](int four, PacketMask some) {
      list_[four] = &next_of(near, some, kFewOfFour, lists_.four[four]);
      const int begin = first + kFour * four;
      alignas(64) float rho[kPacket];
      sum_samples<Shape, kSizes>(field_, *list_[four], rays_of(begin), at_ + begin, step_, rho);
      for (int k = 0; k < kRaySamples; ++k) std::copy_n(rho + kFour * k, kFour, &values[2 + k][kFour * four]);
    });
    Brackets brackets;
    refine(first, find_brackets(first, rays, values, brackets), brackets);
    for_each_chunk(rays, [&](int l, auto of) {
      const Tag d;
      store_in(of, hn::Load(d, values[samples_] + l), earlier_ + first + l);
      store_in(of, hn::Load(d, values[samples_ + 1] + l), before_ + first + l);
    });
    advance(first, rays);
  }

  FourRays rays_of(int begin) const { return {beam_.rays[begin / kPacket], begin % kPacket}; }

  /// The rays' next samples are those after a sweep.
  void advance(int first, PacketMask rays) {
    const Tag d;
    PacketMask ended = 0;
    for_each_chunk(rays, [&](int l, auto of) {
      const int i = first + l;
      const Vec sample = hn::Add(hn::Load(d, sample_ + i), hn::Set(d, static_cast<float>(samples_)));
      const Vec at = hn::MulAdd(sample, hn::Set(d, step_), hn::Load(d, beam_.entry + i));
      store_in(of, sample, sample_ + i);
      store_in(of, at, at_ + i);
      ended |= bits_of(hn::And(of, hn::Gt(at, hn::Load(d, beam_.exit + i)))) << l;
    });
    active_ &= ~(BeamMask{ended} << first);
  }

  /// What holds the crossings of a part's rays: places, m, and sign (rho - iso) there, negative at the low end.
  struct Brackets {
    alignas(64) float low_t[kPacket];
    alignas(64) float low[kPacket];
    alignas(64) float high_t[kPacket];
    alignas(64) float high[kPacket];

    void set(hn::Mask<Tag> of, int l, Vec from, Vec from_value, Vec to, Vec to_value) {
      store_in(of, from, low_t + l);
      store_in(of, from_value, low + l);
      store_in(of, to, high_t + l);
      store_in(of, to_value, high + l);
    }
    /// Where the line through the ends is zero.
    HWY_INLINE Vec secant(int l) const {
      const Tag d;
      const Vec from = hn::Load(d, low_t + l), zero = hn::Zero(d), value = hn::Load(d, low + l);
      const Vec rise = hn::Sub(hn::Load(d, high + l), value);
      const Vec part = hn::IfThenElse(hn::Gt(rise, zero), hn::Div(hn::Neg(value), rise), hn::Set(d, 0.5f));
      const Vec clamped = hn::Min(hn::Max(part, zero), hn::Set(d, 1.0f));
      return hn::MulAdd(clamped, hn::Sub(hn::Load(d, high_t + l), from), from);
    }
    HWY_INLINE void narrow(hn::Mask<Tag> of, int l, Vec t, Vec value) {
      const Tag d;
      const auto below = hn::Lt(value, hn::Zero(d));
      const auto lower = hn::And(of, below), upper = hn::AndNot(below, of);
      store_in(lower, t, low_t + l);
      store_in(lower, value, low + l);
      store_in(upper, t, high_t + l);
      store_in(upper, value, high + l);
    }
  };

  /// The rays of a part that cross between samples of the sweep. Those, and the ones that end, are active no more.
  /// @param values  sign (rho - iso) of the last two samples, rho of the next; then sign (rho - iso) of all
  HWY_INLINE PacketMask find_brackets(int first, PacketMask rays, float (*values)[kPacket], Brackets& brackets) {
    const Tag d;
    const Vec zero = hn::Zero(d), step = hn::Set(d, step_), sign = hn::Set(d, sign_),
              iso = hn::Set(d, field_.options.iso), near_iso = hn::Set(d, -kSummitMargin * field_.options.iso);
    PacketMask open = rays, crossed = 0;
    for (int k = 0; k < samples_; ++k) {
      PacketMask high = 0, ended = 0, started = 0, summits = 0;
      alignas(64) float place[kPacket];
      for_each_chunk(open, [&](int l, auto of) {
        const Vec t = hn::MulAdd(hn::Set(d, static_cast<float>(k)), step, hn::Load(d, at_ + first + l));
        const Vec value = hn::Mul(sign, hn::Sub(hn::Load(d, values[2 + k] + l), iso)),
                  before = hn::Load(d, values[1 + k] + l), earlier = hn::Load(d, values[k] + l);
        hn::Store(value, d, values[2 + k] + l);
        const auto within = hn::And(of, hn::Le(t, hn::Load(d, beam_.exit + first + l)));
        ended |= bits_of(hn::AndNot(within, of)) << l;
        const auto above = hn::And(within, hn::Ge(value, zero));
        high |= bits_of(above) << l;
        if (k == 0) started |= bits_of(hn::And(above, hn::Eq(hn::Load(d, sample_ + first + l), zero))) << l;
        brackets.set(above, l, hn::Sub(t, step), before, t, value);
        // With fewer than two samples before, `earlier` or `before` is zero, above all values that have not crossed.
        const Vec fall = hn::Sub(hn::Add(before, before), hn::Add(earlier, value)), rise = hn::Sub(value, earlier);
        const Vec steps = hn::Div(hn::Mul(hn::Set(d, 0.5f), rise), fall);
        const auto middle = hn::And(hn::And(hn::Gt(before, earlier), hn::Gt(before, value)), hn::Lt(earlier, zero));
        const auto tops = hn::Gt(hn::MulAdd(hn::Mul(hn::Set(d, 0.25f), rise), steps, before), near_iso);
        summits |= bits_of(hn::And(hn::AndNot(above, within), hn::And(middle, tops))) << l;
        hn::Store(hn::MulAdd(steps, step, hn::Sub(t, step)), d, place + l);
      });
      crossed |= high & ~started;
      started_inside_ |= BeamMask{started} << first;
      if (HWY_UNLIKELY(summits != 0)) {
        const PacketMask over = climb(first, summits, k, place, values, brackets);
        crossed |= over;
        high |= over;
      }
      open &= ~(high | ended);
      active_ &= ~(BeamMask{high | ended} << first);
      if (open == 0) break;
    }
    return crossed;
  }

  /// Asks the density at summits between samples k - 2, k - 1 and k of some rays; brackets those that cross there.
  HWY_NOINLINE PacketMask climb(int first, PacketMask rays, int k, const float* place, const float (*values)[kPacket],
                                Brackets& brackets) {
    const Tag d;
    alignas(64) float highest[kPacket], slopes[kPacket];
    values_at(first, rays, place, highest, slopes);
    PacketMask crossed = 0;
    for_each_chunk(rays, [&](int l, auto of) {
      const Vec step = hn::Set(d, step_), at = hn::Load(d, place + l), value = hn::Load(d, highest + l);
      const Vec middle = hn::MulAdd(hn::Set(d, static_cast<float>(k - 1)), step, hn::Load(d, at_ + first + l));
      const auto over = hn::And(of, hn::Ge(value, hn::Zero(d))), after = hn::Gt(at, middle);
      const Vec from = hn::IfThenElse(after, middle, hn::Sub(middle, step));
      const Vec from_value = hn::IfThenElse(after, hn::Load(d, values[1 + k] + l), hn::Load(d, values[k] + l));
      brackets.set(over, l, from, from_value, at, value);
      crossed |= bits_of(over) << l;
    });
    return crossed;
  }

  /// sign (rho - iso) and its derivative along the ray, 1/m, at t of some rays of a part, from the lists of its fours.
  void values_at(int first, PacketMask rays, const float* t, float* values, float* rises) const {
    for_each_four(rays, [&](int four, PacketMask some) {
      const int l = kFour * four;
      sum_slopes<Shape, kSizes>(field_, *list_[four], rays_of(first + l), t + l, values + l, rises + l);
      if (HWY_UNLIKELY(list_[four]->near_full))
        for_each_lane(some, [&](int i) {
          if (field_.grid.full_at(beam_.origin(first + i) + t[i] * beam_.direction(first + i))) values[i] = 1.0f;
        });
    });
    const Tag d;
    const Vec sign = hn::Set(d, sign_), iso = hn::Set(d, field_.options.iso);
    for_each_chunk(rays, [&](int l, auto) {
      hn::Store(hn::Mul(sign, hn::Sub(hn::Load(d, values + l), iso)), d, values + l);
      hn::Store(hn::Mul(sign, hn::Load(d, rises + l)), d, rises + l);
    });
  }

  /// Narrows the brackets of some rays of a part and takes their depths.
  HWY_INLINE void refine(int first, PacketMask rays, Brackets& brackets) {
    if (rays == 0) return;
    const Tag d;
    const RaycastOptions& options = field_.options;
    const bool by_secant = options.refinement == Refinement::secant;
    int left = options.refinement_steps;
    if (by_secant && left == 2 && samples_ > 1) {
      rays = find_steep_roots(first, rays, brackets);
      if (rays == 0) return;
      left = 1;
    }
    alignas(64) float t[kPacket], values[kPacket], rises[kPacket];
    for (; left > 0; --left) {
      for_each_chunk(rays, [&](int l, auto) {
        const Vec middle =
            hn::Mul(hn::Set(d, 0.5f), hn::Add(hn::Load(d, brackets.low_t + l), hn::Load(d, brackets.high_t + l)));
        hn::Store(by_secant ? brackets.secant(l) : middle, d, t + l);
      });
      values_at(first, rays, t, values, rises);
      for_each_chunk(rays,
                     [&](int l, auto of) { brackets.narrow(of, l, hn::Load(d, t + l), hn::Load(d, values + l)); });
    }
    for_each_chunk(rays, [&](int l, auto of) { store_in(of, brackets.secant(l), beam_.depth + first + l); });
  }

  /// Takes the depths of rays by one sum with its derivative: that and the end of the bracket beyond the root make a
  /// parabola. The brackets of the others, whose root is not near, are narrowed by the sum.
  /// @return  the others
  HWY_INLINE PacketMask find_steep_roots(int first, PacketMask rays, Brackets& brackets) {
    const Tag d;
    const Vec zero = hn::Zero(d), one = hn::Set(d, 1.0f), near = hn::Set(d, kNearRoot * field_.options.spacing);
    alignas(64) float places[kPacket] = {};
    alignas(64) float values[kPacket], rises[kPacket];
    for_each_chunk(rays, [&](int l, auto) { hn::Store(brackets.secant(l), d, places + l); });
    values_at(first, rays, places, values, rises);
    PacketMask others = rays;
    for_each_chunk(rays, [&](int l, auto of) {
      const Vec t = hn::Load(d, places + l), value = hn::Load(d, values + l), rise = hn::Load(d, rises + l);
      brackets.narrow(of, l, t, value);
      const auto below = hn::Lt(value, zero);
      const auto other_end = [&](const float* high, const float* low) {
        return hn::IfThenElse(below, hn::Load(d, high + l), hn::Load(d, low + l));
      };
      const Vec end = hn::Sub(other_end(brackets.high_t, brackets.low_t), t),
                end_value = other_end(brackets.high, brackets.low);
      const Vec newton = hn::Div(hn::Neg(value), rise);
      // The parabola through (0, value) with this rise and (end, end_value).
      const Vec bend = hn::Div(hn::Sub(hn::Sub(end_value, value), hn::Mul(rise, end)), hn::Mul(end, end));
      const Vec step = hn::Div(hn::Neg(value), hn::MulAdd(bend, newton, rise));
      const Vec part = hn::Div(step, end);
      const auto good =
          hn::And(hn::And(of, hn::Lt(hn::Abs(newton), near)), hn::And(hn::Ge(part, zero), hn::Le(part, one)));
      store_in(good, hn::Add(t, step), beam_.depth + first + l);
      others &= ~(bits_of(good) << l);
    });
    return others;
  }

  /// Rays whose very first sample had crossed (particles packed closer than expected): steps back, a smoothing length
  /// at most, until outside.
  void start_inside() {
    const int steps = static_cast<int>(std::ceil(field_.options.smoothing_length / step_));
    const float back = static_cast<float>(steps) * step_;
    while (started_inside_ != 0) {
      const BeamMask group = take_group(beam_, beam_.entry, started_inside_);
      gather(group, std::max(least_of(group, beam_.entry) - back, 0.0f), largest_of(group, beam_.entry));
      for_each_part(group, [&](int first, PacketMask rays) {
        for_each_four(rays, [&](int four, PacketMask some) {
          const BeamMask mask = BeamMask{some} << first;
          list_[four] = &narrowed(lists_.whole, mask, std::max(least_of(mask, beam_.entry) - back, 0.0f),
                                  largest_of(mask, beam_.entry), kFewOfFour, lists_.four[four]);
        });
        walk_back(first, rays, steps);
      });
    }
  }

  void walk_back(int first, PacketMask rays, int steps) {
    Brackets brackets;
    alignas(64) float t[kPacket], values[kPacket], rises[kPacket];
    std::copy_n(beam_.entry + first, kPacket, t);
    values_at(first, rays, t, values, rises);
    PacketMask open = rays, crossed = 0;
    for (int n = 1; n <= steps && open != 0; ++n) {
      for_each_lane(open, [&](int l) {
        brackets.high_t[l] = t[l];
        brackets.high[l] = values[l];
        t[l] = std::max(beam_.entry[first + l] - static_cast<float>(n) * step_, 0.0f);
      });
      values_at(first, open, t, values, rises);
      for_each_lane(open, [&](int l) {
        if (values[l] < 0.0f) {
          brackets.low_t[l] = t[l];
          brackets.low[l] = values[l];
          crossed |= 1u << l;
        } else if (t[l] > 0.0f && n < steps)
          return;
        else
          beam_.depth[first + l] = t[l];
        open &= ~(1u << l);
      });
    }
    refine(first, crossed, brackets);
  }

  const RaycastField& field_;
  BeamLists& lists_;
  Beam& beam_;
  float sign_, step_;
  int samples_;                     ///< of a sweep
  const PacketList* list_[kFours];  ///< of the fours of the part that is looked at
  BeamMask active_ = 0, started_inside_ = 0;
  alignas(64) float sample_[kBeam];   ///< the ray's next sample,
  alignas(64) float at_[kBeam];       ///< and where it lies
  alignas(64) float earlier_[kBeam];  ///< values of the last two samples
  alignas(64) float before_[kBeam];
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#endif
