/// Joints between tiles averaged over a small region, in closed form.
#pragma once

#include <algorithm>
#include <cmath>

#include "meniscus/base.h"
#include "scene/chequer.h"

namespace meniscus {

/// Mean under a tent of half-width `width` around x of the pulses that are 1 on [0, duty) and 0 on [duty, 1), of period
/// 1: duty plus the second difference of the second integral of what differs from duty. See square_wave_mean().
inline float pulse_mean(float x, float width, float duty) {
  // Narrower tents are lost in rounding, wider ones have nothing left to tell.
  const float w = std::max(width, 0.005f);
  if (w > 64.0f || !(std::abs(x) < 1e6f)) return duty;
  const float mean = 0.5f * duty * (1.0f - duty);
  const auto second_integral = [&](float at) {
    const float phase = 0.5f * modulo_two(2.0f * at);
    if (phase < duty) return (0.5f * (1.0f - duty) * phase - mean) * phase;
    // The same from the period's other end.
    const float rest = 1.0f - phase;
    return (mean - 0.5f * duty * rest) * rest;
  };
  return std::clamp(duty + (second_integral(x + w) - 2.0f * second_integral(x) + second_integral(x - w)) / (w * w),
                    0.0f, 1.0f);
}

/// Fraction of joints around a point, tiles of edge 1 with joints of width `joint` centred between them.
inline float joint_fraction(vec2 point, vec2 width, float joint) {
  const float x = pulse_mean(point.x + 0.5f * joint, width.x, joint);
  const float y = pulse_mean(point.y + 0.5f * joint, width.y, joint);
  return 1.0f - (1.0f - x) * (1.0f - y);
}

}  // namespace meniscus
