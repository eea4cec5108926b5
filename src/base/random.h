/// Random numbers that are the same on every machine, whatever the order or the thread in which they are asked for.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace meniscus {

/// Well-mixed bits of a number: one step of SplitMix64.                                          [Steele2014]
inline std::uint64_t mixed(std::uint64_t v) {
  v += 0x9e3779b97f4a7c15u;
  v = (v ^ (v >> 30)) * 0xbf58476d1ce4e5b9u;
  v = (v ^ (v >> 27)) * 0x94d049bb133111ebu;
  return v ^ (v >> 31);
}

/// A sequence of numbers: SplitMix64.                                                            [Steele2014]
struct Draws {
  /// The sequence that starts at a state.
  explicit Draws(std::uint64_t state) : state(state) {}
  /// The sequence that belongs to one thing among many: the same for the same pair, unrelated for any others.
  Draws(std::uint64_t seed, std::uint64_t id) : state(mixed(mixed(seed) ^ id)) {}

  std::uint64_t bits() {
    const std::uint64_t result = mixed(state);
    state += 0x9e3779b97f4a7c15u;
    return result;
  }
  /// In [0, 1), steps of 2^-53.
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  double between(double low, double high) { return low + (high - low) * uniform(); }
  /// Of mean 0 and standard deviation 1; takes two numbers of the sequence.                      [BoxMuller1958]
  double normal() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * uniform());
  }

  std::uint64_t state;
};

}  // namespace meniscus
