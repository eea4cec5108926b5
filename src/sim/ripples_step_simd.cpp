#include "sim/ripples_step.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sim/ripples_step_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

float StepRow(const RippleRow& r) {
  const auto step = [&](auto d, std::size_t i, auto largest) HWY_ATTR {
    const auto zero = hn::Zero(d);
    const auto now = hn::LoadU(d, r.now[1] + i), own = hn::LoadU(d, r.speeds2[1] + i);
    const auto speed2 = [&](int row, std::size_t k) HWY_ATTR { return hn::LoadU(d, r.speeds2[row] + k); };
    // What comes from the eight points around, by 2/3 over edges and 1/6 over corners, so that waves of all directions
    // are equally fast [Patra2006]; c^2 of a pair is the mean of both. Nothing comes from where it is dry: along a
    // shore an edge takes the share of the corners beyond it.
    const auto from = [&](int row, std::size_t k) HWY_ATTR {
      const auto other = speed2(row, k);
      const auto rise = hn::Sub(hn::LoadU(d, r.now[row] + k), now);
      return hn::IfThenElseZero(hn::Gt(other, zero), hn::Mul(hn::Add(own, other), rise));
    };
    const auto dry = [&](int row, std::size_t k, int other_row, std::size_t other) HWY_ATTR {
      const auto sum = hn::Add(speed2(row, k), speed2(other_row, other));
      return hn::IfThenElseZero(hn::Eq(sum, zero), hn::Set(d, 1.0f));
    };
    const auto four = hn::Set(d, 4.0f);
    const auto across = [&](std::size_t k) HWY_ATTR {
      return hn::Mul(hn::Add(four, hn::Add(dry(0, i, 0, k), dry(2, i, 2, k))), from(1, k));
    };
    const auto along = [&](int row) HWY_ATTR {
      return hn::Mul(hn::Add(four, hn::Add(dry(1, i - 1, row, i - 1), dry(1, i + 1, row, i + 1))), from(row, i));
    };
    const auto edges = hn::Add(hn::Add(along(0), along(2)), hn::Add(across(i - 1), across(i + 1)));
    const auto corners = hn::Add(hn::Add(from(0, i - 1), from(0, i + 1)), hn::Add(from(2, i - 1), from(2, i + 1)));
    const auto change = hn::Mul(hn::Add(edges, corners), hn::Set(d, r.scale / 12));
    // u+ = r^2 u- + P (2 (r u - r^2 u-) + r change), where v = u / r^n has no damping but at the border.
    const auto decay = hn::Set(d, r.decay);
    const auto older = hn::Mul(hn::Mul(decay, decay), hn::LoadU(d, r.before + i));
    const auto rest = hn::MulAdd(decay, hn::Add(hn::Add(now, now), change), hn::Neg(hn::Add(older, older)));
    const auto wet = hn::Gt(own, zero);
    const auto next =
        hn::IfThenElseZero(wet, r.keeps ? hn::MulAdd(hn::LoadU(d, r.keeps + i), rest, older) : hn::Add(rest, older));
    hn::StoreU(next, d, r.before + i);
    return hn::Max(largest, hn::Abs(next));
  };
  const hn::ScalableTag<float> d;
  const hn::CappedTag<float, 1> one;
  auto largest = hn::Zero(d);
  std::size_t i = 0;
  for (; i + hn::Lanes(d) <= r.count; i += hn::Lanes(d)) largest = step(d, i, largest);
  float rest = hn::GetLane(hn::MaxOfLanes(d, largest));
  for (; i < r.count; ++i) rest = hn::GetLane(step(one, i, hn::Set(one, rest)));
  return rest;
}

}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace meniscus {

HWY_EXPORT(StepRow);

float step_row(const RippleRow& row) { return HWY_DYNAMIC_DISPATCH(StepRow)(row); }

}  // namespace meniscus
#endif
