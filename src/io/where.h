/// Conditions on particles: "type == 3 && density >= 900 || mk != 11".
#pragma once

#include <span>
#include <string>

#include "meniscus/base.h"

namespace meniscus::io {

/// Comparisons of attributes with numbers (==, !=, <, <=, >, >=), joined by && and || (&& binds tighter).
///
/// Names are those of attributes in any case, as they are in the file or here; x, y and z are the position, m; vectors
/// have components: velocity[0]. Names with other characters than letters, digits, _ . : stand between quotes.
class Condition {
 public:
  /// @throws Error  invalid_argument: the text is no condition; the message says where
  explicit Condition(std::string_view text);

  /// Sets `fits`, one a particle, to 1 where the condition holds, else to 0. No comparison holds for NaN, but for !=.
  /// @throws Error  invalid_argument: particles have no such attribute or component; the message lists those they have
  void judge(const Particles& particles, std::span<std::uint8_t> fits) const;

 private:
  enum class Operator { equal, unequal, less, less_equal, greater, greater_equal };
  struct Comparison {
    std::string name;
    std::optional<std::size_t> component;
    Operator how = Operator::equal;
    double value = 0;
  };
  /// Numbers of all particles: first[i * stride] + origin.
  struct Numbers {
    const float* first;
    std::size_t stride;
    double origin;
  };
  friend class ConditionParser;
  static bool holds(const Comparison& comparison, const Numbers& numbers, std::size_t particle);
  static Numbers numbers_of(const Comparison& comparison, const Particles& particles);

  std::vector<std::vector<Comparison>> alternatives_;  ///< one of which must hold in all its comparisons
};

}  // namespace meniscus::io
