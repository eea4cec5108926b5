// Chequers and joints over many points; included once for each instruction set, after highway.h.

#if defined(MENISCUS_SCENE_PLANES_PATTERNS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MENISCUS_SCENE_PLANES_PATTERNS_INL_H_
#undef MENISCUS_SCENE_PLANES_PATTERNS_INL_H_
#else
#define MENISCUS_SCENE_PLANES_PATTERNS_INL_H_
#endif

#include <hwy/highway.h>

#include "scene/ray_block.h"

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = HWY_CAPPED(float, 16);
using Vec = hn::Vec<Tag>;
using Mask = hn::Mask<Tag>;

HWY_INLINE Vec all(float value) { return hn::Set(Tag(), value); }
HWY_INLINE Vec clamped(Vec v, float low, float high) { return hn::Min(hn::Max(v, all(low)), all(high)); }
HWY_INLINE Vec mixed(float a, float b, Vec t) {
  return hn::Add(hn::Mul(all(a), hn::Sub(all(1.0f), t)), hn::Mul(all(b), t));
}

/// See footprint().
HWY_INLINE Vec footprint_of(Vec width, Vec cos_in, Vec along) {
  const Vec slope = hn::Div(along, cos_in);
  return hn::Mul(width, hn::Sqrt(hn::MulAdd(slope, slope, all(1.0f))));
}

/// See modulo_two(): half of it.
HWY_INLINE Vec modulo_one(Vec x) {
  const Vec bounded = clamped(x, -1e9f, 1e9f);
  return hn::Sub(bounded, hn::Floor(bounded));
}

/// See square_wave_mean().
HWY_INLINE Vec square_wave_mean_of(Vec x, Vec width) {
  const Vec one = all(1.0f), w = hn::Max(width, all(0.02f));
  const auto second_integral = [&](Vec at) HWY_ATTR {
    const Vec phase = hn::Mul(all(2.0f), modulo_one(hn::Mul(all(0.5f), at)));
    const Mask first = hn::Lt(phase, one);
    const Vec half = hn::IfThenElse(first, phase, hn::Sub(phase, one));
    const Vec value = hn::Mul(hn::Mul(all(0.5f), half), hn::Sub(half, one));
    return hn::IfThenElse(first, value, hn::Neg(value));
  };
  const Vec middle = hn::Mul(all(2.0f), second_integral(x));
  const Vec rise = hn::Sub(second_integral(hn::Add(x, w)), middle);
  return hn::Div(hn::Add(rise, second_integral(hn::Sub(x, w))), hn::Mul(w, w));
}

/// See pulse_mean().
HWY_INLINE Vec pulse_mean_of(Vec x, Vec width, float duty) {
  const Vec w = hn::Max(width, all(0.005f));
  const Mask told = hn::AndNot(hn::Gt(w, all(64.0f)), hn::Lt(hn::Abs(x), all(1e6f)));
  const Vec mean = all(0.5f * duty * (1.0f - duty));
  const auto second_integral = [&](Vec at) HWY_ATTR {
    const Vec phase = modulo_one(at);
    const Vec rest = hn::Sub(all(1.0f), phase);
    const Vec on = hn::Mul(hn::Sub(hn::Mul(all(0.5f * (1.0f - duty)), phase), mean), phase);
    const Vec off = hn::Mul(hn::Sub(mean, hn::Mul(all(0.5f * duty), rest)), rest);
    return hn::IfThenElse(hn::Lt(phase, all(duty)), on, off);
  };
  const Vec middle = hn::Mul(all(2.0f), second_integral(x));
  const Vec rise = hn::Sub(second_integral(hn::Add(x, w)), middle);
  const Vec second = hn::Div(hn::Add(rise, second_integral(hn::Sub(x, w))), hn::Mul(w, w));
  return hn::IfThenElse(told, clamped(hn::Add(all(duty), second), 0.0f, 1.0f), all(duty));
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#endif
