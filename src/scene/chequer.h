/// Chequers averaged over a small region, in closed form.
#pragma once

#include <algorithm>

#include "meniscus/base.h"

namespace meniscus {

/// x modulo 2 in [0, 2), without the library call that std::floor is on the oldest x86-64; beyond 2^31 any phase does.
inline float modulo_two(float x) {
  const float half = std::clamp(0.5f * x, -1e9f, 1e9f);
  const auto whole = static_cast<int>(half);
  const float fraction = half - static_cast<float>(whole);
  return 2.0f * (fraction < 0 ? fraction + 1.0f : fraction);
}

/// Mean under a tent of half-width `width` around x of the square wave that is +1 on [0, 1), -1 on [1, 2), of period 2.
/// It is the second difference of the wave's second integral, which is quadratic on each half period. A tent and not a
/// box: what a box leaves of far squares falls off only like 1 / width and shows as moire.
inline float square_wave_mean(float x, float width) {
  // Narrower tents are lost in rounding; a fiftieth of a square is sharp enough.
  const float w = std::max(width, 0.02f);
  const auto second_integral = [](float at) {
    const float phase = modulo_two(at);
    const float half = phase < 1.0f ? phase : phase - 1.0f;
    const float value = 0.5f * half * (half - 1.0f);
    return phase < 1.0f ? value : -value;
  };
  return (second_integral(x + w) - 2.0f * second_integral(x) + second_integral(x - w)) / (w * w);
}

/// Fraction of the first colour around a point, squares of edge 1; the square [0, 1)^2 is of the first colour. A
/// chequer is the product of two square waves, and so is its mean.
inline float chequer_fraction(vec2 point, vec2 width) {
  return std::clamp(0.5f + 0.5f * square_wave_mean(point.x, width.x) * square_wave_mean(point.y, width.y), 0.0f, 1.0f);
}

}  // namespace meniscus
