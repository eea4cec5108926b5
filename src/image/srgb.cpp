#include <algorithm>
#include <cmath>

#include "meniscus/image.h"

namespace meniscus {
namespace {

/// NaN becomes 0.
float clamped(float value) { return value > 0 ? std::min(value, 1.0f) : 0.0f; }

}  // namespace

// IEC 61966-2-1, with the break at 0.0031308 (linear) and 0.04045 (encoded).

float srgb_from_linear(float linear) {
  const float x = clamped(linear);
  if (x >= 1.0f) return 1.0f;  // 1.055 - 0.055 is not 1 in floats
  return x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1.0f / 2.4f) - 0.055f;
}

float linear_from_srgb(float srgb) {
  const float x = clamped(srgb);
  if (x >= 1.0f) return 1.0f;
  return x <= 0.04045f ? x / 12.92f : std::pow((x + 0.055f) / 1.055f, 2.4f);
}

}  // namespace meniscus
