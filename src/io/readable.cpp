#include "io/readable.h"

#include <algorithm>
#include <string_view>

namespace meniscus::io {
namespace {

/// The length of the UTF-8 character at the start of `text`, 1 to 4; 0: there is none.
std::size_t character_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  if (byte(0) < 0x80) return byte(0) >= 0x20 && byte(0) != 0x7f ? 1 : 0;
  const std::size_t length = byte(0) >= 0xf0 ? 4 : byte(0) >= 0xe0 ? 3 : 2;
  if (byte(0) < 0xc2 || byte(0) > 0xf4 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(i) & 0xc0) != 0x80) return 0;
  // Longer forms of short characters, halves of pairs, and what is beyond the last character.
  const unsigned start = byte(0), second = byte(1);
  const bool wrong = (start == 0xe0 && second < 0xa0) || (start == 0xed && second > 0x9f) ||
                     (start == 0xf0 && second < 0x90) || (start == 0xf4 && second > 0x8f);
  return wrong ? 0 : length;
}

}  // namespace

void make_readable(std::string& text) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = character_length(std::string_view(text).substr(at));
    if (length == 0) text[at] = '?';
    at += std::max<std::size_t>(length, 1);
  }
}

Error readable(const Error& error) {
  ErrorDetail detail = error.detail();
  for (std::string* text : {&detail.problem, &detail.expected, &detail.found, &detail.advice}) make_readable(*text);
  return {error.code(), std::move(detail)};
}

}  // namespace meniscus::io
