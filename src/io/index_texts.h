/// Texts that an attribute gives as numbers, for a note.
#pragma once

#include <string>
#include <string_view>

namespace meniscus::io {

/// What the first numbers of an index mean: "0 'water', 1 'oil'".
class IndexTexts {
 public:
  /// The text of the next number.
  void add(std::string_view text);
  /// "attribute 'kind' gives its texts as numbers: 0 'water', 1 'oil'"
  std::string note(std::string_view attribute) const;

 private:
  std::string shown_;
  std::size_t count_ = 0;
};

}  // namespace meniscus::io
