/// Chequers averaged over a rectangle, in closed form.
#pragma once

#include <algorithm>
#include <cmath>

#include "meniscus/base.h"

namespace meniscus {

/// Mean over [x - width / 2, x + width / 2] of the square wave that is +1 on [0, 1), -1 on [1, 2), of period 2.
/// Its integral is the triangle wave 1 - |mod(x, 2) - 1|.
inline float square_wave_mean(float x, float width) {
  const float w = std::max(width, 1e-3f);
  const auto integral = [](float at) { return 1.0f - std::abs(at - 2.0f * std::floor(0.5f * at) - 1.0f); };
  return (integral(x + 0.5f * w) - integral(x - 0.5f * w)) / w;
}

/// Fraction of the first colour in a rectangle around a point, squares of edge 1; the square [0, 1)^2 is of the first
/// colour. A chequer is the product of two square waves, and so is its mean.
inline float chequer_fraction(vec2 point, vec2 width) {
  return std::clamp(0.5f + 0.5f * square_wave_mean(point.x, width.x) * square_wave_mean(point.y, width.y), 0.0f, 1.0f);
}

}  // namespace meniscus
