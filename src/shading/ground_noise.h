/// Noise on a plane, by hashed places: the same everywhere, without tables.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "meniscus/base.h"

namespace meniscus {

/// A value and how it changes along both axes of the plane.
struct PlaneNoise {
  float value = 0;
  vec2 slope{0.0f};
};

/// Bits of a place of an integer grid.
inline std::uint64_t place_bits(std::int32_t i, std::int32_t j, std::uint64_t seed) {
  return mixed(seed ^ (std::uint64_t{static_cast<std::uint32_t>(i)} << 32 | static_cast<std::uint32_t>(j)));
}
/// A number in [0, 1) from sixteen of those bits, the part 0 .. 3.
inline float unit_of(std::uint64_t bits, int part) {
  return static_cast<float>(bits >> (16 * part) & 0xFFFFu) * (1.0f / 65536.0f);
}

/// The cell that holds a coordinate; places without end or value are somewhere all the same.
inline std::int32_t cell_of(float x) {
  constexpr float kFarthest = 1e9f;
  return static_cast<std::int32_t>(std::floor(x > -kFarthest ? std::min(x, kFarthest) : -kFarthest));
}

/// Numbers in [-1, 1) at integer places, between them by quintics: smooth, its mean zero, its variance about 0.18 and
/// that of each slope 0.74.                                                                    [Perlin2002]
inline PlaneNoise value_noise(vec2 p, std::uint64_t seed) {
  const std::int32_t i = cell_of(p.x), j = cell_of(p.y);
  const float x = std::clamp(p.x - static_cast<float>(i), 0.0f, 1.0f);
  const float y = std::clamp(p.y - static_cast<float>(j), 0.0f, 1.0f);
  const auto node = [&](std::int32_t di, std::int32_t dj) {
    return 2.0f * unit_of(place_bits(i + di, j + dj, seed), 0) - 1.0f;
  };
  const float a = node(0, 0), b = node(1, 0), c = node(0, 1), d = node(1, 1);
  const auto quintic = [](float t) { return t * t * t * (t * (6.0f * t - 15.0f) + 10.0f); };
  const auto by_t = [](float t) { return 30.0f * t * t * (t - 1.0f) * (t - 1.0f); };
  const float u = quintic(x), v = quintic(y), twist = a - b - c + d;
  return {a + (b - a) * u + (c - a) * v + twist * u * v,
          {by_t(x) * (b - a + twist * v), by_t(y) * (c - a + twist * u)}};
}

/// What is left of a pattern of this length under a beam as wide: all while the beam is narrow, nothing before its
/// samples would miss it.
inline float resolved(float length, float width) {
  const float t = std::clamp(1.6f - 2.0f * width / length, 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

}  // namespace meniscus
