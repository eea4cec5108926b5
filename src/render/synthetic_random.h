/// Random numbers for made-up scenes.
#pragma once

#include "base/random.h"

namespace meniscus {

/// Independent of libraries, so that a scene is the same everywhere.
class Random {
 public:
  explicit Random(std::uint64_t seed) : draws_(seed) {}
  std::uint64_t bits() { return draws_.bits(); }
  /// In [0, 1).
  float unit() { return static_cast<float>(bits() >> 40) * 0x1p-24f; }
  float between(float low, float high) { return low + (high - low) * unit(); }

 private:
  Draws draws_;
};

}  // namespace meniscus
