/// Paths with the number of a frame in them.
#pragma once

#include <cstdint>
#include <string>

namespace meniscus {

/// "rb_{}.obj", "rb_{:04}.obj" (also {:04d}); or a path without a number, which is any other.
class NumberedPath {
 public:
  explicit NumberedPath(std::string pattern);
  bool is_numbered() const { return numbered_; }
  bool understood() const { return understood_; }  ///< false: braces that are no place for a number
  const std::string& pattern() const { return pattern_; }
  /// The path of one frame; `{}` becomes the number, wherever it stands.
  std::string of(std::int64_t number) const;

 private:
  std::string pattern_;
  bool numbered_ = false;
  bool understood_ = true;
};

}  // namespace meniscus
