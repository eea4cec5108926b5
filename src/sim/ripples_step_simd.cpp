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
    const auto now = hn::LoadU(d, r.now + i);
    // What flows in over the four faces.
    auto change = hn::Mul(hn::LoadU(d, r.faces_a + i + 1), hn::Sub(hn::LoadU(d, r.now + i + 1), now));
    change = hn::MulAdd(hn::LoadU(d, r.faces_a + i), hn::Sub(hn::LoadU(d, r.now + i - 1), now), change);
    change = hn::MulAdd(hn::LoadU(d, r.faces_above + i), hn::Sub(hn::LoadU(d, r.above + i), now), change);
    change = hn::MulAdd(hn::LoadU(d, r.faces_below + i), hn::Sub(hn::LoadU(d, r.below + i), now), change);
    // u+ = r^2 u- + P (2 (r u - r^2 u-) + r change), where v = u / r^n has no damping but at the border.
    const auto kept = hn::LoadU(d, r.keeps + i), decay = hn::Set(d, r.decay);
    const auto older = hn::Mul(hn::Mul(decay, decay), hn::LoadU(d, r.before + i));
    const auto moved = hn::MulAdd(hn::Set(d, r.scale), change, hn::Add(now, now));
    const auto rest = hn::MulAdd(decay, moved, hn::Neg(hn::Add(older, older)));
    const auto next = hn::MulAdd(kept, rest, older);
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
