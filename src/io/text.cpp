#include "io/text.h"

#include <fast_float/fast_float.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <system_error>

#include "io/file_bytes.h"

namespace meniscus::io {
namespace {

template <class T>
bool parse(std::string_view word, T& value) {
  if (word.starts_with('+')) word.remove_prefix(1);
  const auto result = fast_float::from_chars(word.data(), word.data() + word.size(), value);
  // Numbers too large or too small for the type come back as infinity and zero, whatever the error code says.
  const bool ok = result.ec == std::errc() || result.ec == std::errc::result_out_of_range;
  return ok && result.ptr == word.data() + word.size();
}

}  // namespace

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return result;
}

bool parse_number(std::string_view word, float& value) { return parse(word, value); }
bool parse_number(std::string_view word, double& value) { return parse(word, value); }

bool parse_count(std::string_view word, std::uint64_t& value) {
  const auto result = std::from_chars(word.data(), word.data() + word.size(), value);
  return result.ec == std::errc() && result.ptr == word.data() + word.size();
}

std::vector<std::string_view> words_of(std::string_view line) {
  constexpr std::size_t kMost = 64;  // lines of headers have a few; a line as long as the file must not fill the memory
  std::vector<std::string_view> words;
  std::size_t at = 0;
  while (true) {
    while (at < line.size() && is_blank(line[at])) ++at;
    if (at == line.size() || words.size() == kMost) return words;
    const std::size_t start = at;
    while (at < line.size() && !is_blank(line[at])) ++at;
    words.push_back(line.substr(start, at - start));
  }
}

bool TextCursor::fetch(std::size_t at) {
  const std::size_t size = source_.bytes.size();
  if (at >= size) return false;
  source_.need(at, kBlockBytes);
  ready_ = std::min(size, at + kBlockBytes);
  return true;
}

void TextCursor::skip_blanks() {
  while (has(at_) && is_blank(source_.bytes[at_])) ++at_;
}

std::string_view TextCursor::word() {
  skip_blanks();
  const std::size_t start = at_;
  while (has(at_) && !is_blank(source_.bytes[at_])) ++at_;
  return {source_.bytes.data() + start, at_ - start};
}

std::string_view TextCursor::peek() {
  const std::size_t before = at_;
  const std::string_view result = word();
  at_ = before;  // what was fetched is from there on
  return result;
}

std::string_view TextCursor::line() {
  const char* first = source_.bytes.data() + at_;
  const void* end = nullptr;
  std::size_t length = 0;
  while (end == nullptr && has(at_ + length)) {
    end = std::memchr(first + length, '\n', ready_ - at_ - length);
    length = end != nullptr ? static_cast<std::size_t>(static_cast<const char*>(end) - first) : ready_ - at_;
  }
  at_ += length + (end != nullptr ? 1 : 0);
  if (length > 0 && first[length - 1] == '\r') --length;
  return {first, length};
}

void TextCursor::fail(std::string_view what, std::size_t start, std::string_view found) const {
  if (found.empty()) source_.malformed(fmt::format("the file ends inside its {}", what), start);
  std::string shown(found.substr(0, 24));
  for (char& c : shown) {
    if (c < ' ' || c > '~') c = '?';
  }
  source_.malformed(fmt::format("there is something wrong in the {}", what), start, "a number", "'" + shown + "'");
}

float TextCursor::number(std::string_view what) {
  const std::string_view found = word();
  float value = 0;
  if (!parse(found, value)) fail(what, at_ - found.size(), found);
  return value;
}

double TextCursor::wide_number(std::string_view what) {
  const std::string_view found = word();
  double value = 0;
  if (!parse(found, value)) fail(what, at_ - found.size(), found);
  return value;
}

std::uint64_t TextCursor::count(std::string_view what) {
  const std::string_view found = word();
  std::uint64_t value = 0;
  if (!parse_count(found, value)) fail(what, at_ - found.size(), found);
  return value;
}

void TextCursor::numbers(float* target, std::size_t values, std::string_view what) {
  for (std::size_t i = 0; i < values; ++i) target[i] = number(what);
}

void TextCursor::skip_words(std::uint64_t values, std::string_view what) {
  for (std::uint64_t i = 0; i < values; ++i) {
    if (word().empty()) fail(what, at_, {});
  }
}

}  // namespace meniscus::io
