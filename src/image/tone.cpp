#include <algorithm>
#include <cmath>

#include "image/tone.h"

namespace meniscus {
namespace {

/// What Narkowicz's curve is fed with, so that it maps 0.18 to 0.18: the positive root of
/// f(0.18 s) = 0.18, a quadratic in s.
constexpr float kGreyScale = 0.72317f;

/// Above this radiance (after exposure) the curve is at 1, and floats stay far from overflow.
constexpr float kBeyondWhite = 1e4f;

/// [Narkowicz2016]: a rational fit of the ACES reference and output transforms. It rises for all x >= 0, as
/// its derivative's numerator 1.408 x^2 + 0.703 x + 0.0042 is positive, and passes 1 at x = 7.24.
float narkowicz(float x) {
  const float value = (x * (2.51f * x + 0.03f)) / (x * (2.43f * x + 0.59f) + 0.14f);
  return std::min(value, 1.0f);
}

/// The part of a channel that is taken to be over-exposed: 0 up to 0.5, then smoothly towards a slope of 1.
float excess(float x) {
  const float above = std::max(x - 0.5f, 0.0f);
  return above * above / (above + 1.0f);
}

/// Half of the saturation of what is over-exposed goes. A curve on single channels alone would turn a bright
/// saturated colour into the nearest of six pure ones. Each output still grows with every input: the slope
/// of excess() is below 1, so its own channel keeps at least 1/2 + 1/6 of its slope.
vec3 highlights_desaturated(vec3 c) {
  const vec3 over{excess(c.x), excess(c.y), excess(c.z)};
  const float mean = (over.x + over.y + over.z) / 3.0f;
  return c + 0.5f * (vec3{mean} - over);
}

/// In [0, kBeyondWhite]; NaN becomes 0.
float exposed(float radiance, float factor) {
  const float value = radiance * factor;
  return value > 0 ? std::min(value, kBeyondWhite) : 0.0f;
}

}  // namespace

vec3 tone_mapped(vec3 radiance, float factor, ToneCurve curve) {
  vec3 c{exposed(radiance.x, factor), exposed(radiance.y, factor), exposed(radiance.z, factor)};
  if (curve == ToneCurve::linear) return {std::min(c.x, 1.0f), std::min(c.y, 1.0f), std::min(c.z, 1.0f)};
  // Equal channels would pick up rounding errors from their mean.
  if (c.x != c.y || c.y != c.z) c = highlights_desaturated(c);
  return {narkowicz(kGreyScale * c.x), narkowicz(kGreyScale * c.y), narkowicz(kGreyScale * c.z)};
}

vec3 tone_mapped(vec3 radiance, const ToneOptions& options) {
  return tone_mapped(radiance, std::exp2(options.exposure_ev), options.curve);
}

}  // namespace meniscus
