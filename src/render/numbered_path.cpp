#include "render/numbered_path.h"

#include <fmt/format.h>

#include <algorithm>

namespace meniscus {
namespace {

/// Digits that "{...}" asks for: 0 for "{}", -1 for what is no place for a number.
int digits_of(std::string inside) {
  if (inside.empty()) return 0;
  if (inside.front() != ':') return -1;
  inside.erase(0, 1);
  if (!inside.empty() && inside.back() == 'd') inside.pop_back();
  if (inside.size() > 2) return -1;
  int digits = 0;
  for (const char c : inside) {
    if (c < '0' || c > '9') return -1;
    digits = 10 * digits + (c - '0');
  }
  return digits;
}

}  // namespace

NumberedPath::NumberedPath(std::string pattern) : pattern_(std::move(pattern)) {
  for (std::size_t open = pattern_.find('{'); open != std::string::npos; open = pattern_.find('{', open + 1)) {
    const std::size_t close = pattern_.find('}', open);
    numbered_ = true;
    understood_ &= close != std::string::npos && digits_of(pattern_.substr(open + 1, close - open - 1)) >= 0;
  }
}

std::string NumberedPath::of(std::int64_t number) const {
  std::string path;
  std::size_t at = 0;
  for (std::size_t open = pattern_.find('{'); open != std::string::npos; open = pattern_.find('{', at)) {
    const std::size_t close = pattern_.find('}', open);
    if (close == std::string::npos) break;
    path += pattern_.substr(at, open - at);
    path += fmt::format("{:0{}}", number, std::max(0, digits_of(pattern_.substr(open + 1, close - open - 1))));
    at = close + 1;
  }
  return path + pattern_.substr(at);
}

}  // namespace meniscus
