/// Numbers within ranges, as splashes draw them.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/random.h"

namespace meniscus {

/// Normal, but drawn again where it is not within [low, high]; the mean must lie within.
inline double normal_within(Draws& draws, double mean, double sigma, double low, double high) {
  if (!(sigma > 0)) return std::clamp(mean, low, high);
  for (int i = 0; i < 64; ++i) {  // a mean within the range is accepted every second time at least
    const double value = mean + sigma * draws.normal();
    if (value >= low && value <= high) return value;
  }
  return std::clamp(mean, low, high);
}

/// Whole numbers fewest .. most: the nearest to a normal one within half of one beyond them.
inline int number_within(Draws& draws, double mean, double sigma, int fewest, int most) {
  const double value = normal_within(draws, mean, sigma, fewest - 0.5, most + 0.5);
  return std::clamp(static_cast<int>(std::floor(value + 0.5)), fewest, most);
}

}  // namespace meniscus
