#include "io/index_texts.h"

#include <fmt/format.h>

namespace meniscus::io {

constexpr std::size_t kShown = 6;

void IndexTexts::add(std::string_view text) {
  if (count_ < kShown) shown_ += fmt::format("{}{} '{}'", count_ > 0 ? ", " : "", count_, text.substr(0, 40));
  ++count_;
}

std::string IndexTexts::note(std::string_view attribute) const {
  return fmt::format("attribute '{}' gives its texts as numbers: {}{}", attribute.substr(0, 60), shown_,
                     count_ > kShown ? " ..." : "");
}

}  // namespace meniscus::io
