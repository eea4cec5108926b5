#include "io/text_numbers.h"

#include <fast_float/fast_float.h>

#include <algorithm>
#include <array>
#include <system_error>

#include "io/text.h"

namespace meniscus::io {
namespace {

constexpr std::size_t kChunk = std::size_t{1} << 17;  ///< bytes
constexpr std::size_t kChunks = 64;                   ///< at once

/// Without branches, so that many are looked at in one instruction.
constexpr std::uint8_t blank(char c) {
  const auto byte = static_cast<std::uint8_t>(c);
  return static_cast<std::uint8_t>((byte == ' ') | (static_cast<std::uint8_t>(byte - '\t') < 5));
}

/// How many words begin in [begin, end); begin[-1] can be read.
std::size_t words_behind(const char* begin, const char* end) {
  constexpr std::ptrdiff_t kMost = 254;  // that a byte can count
  std::size_t words = 0;
  while (begin != end) {
    const std::ptrdiff_t length = std::min(kMost, end - begin);
    std::uint8_t some = 0;
    for (std::ptrdiff_t i = 0; i < length; ++i)
      some = static_cast<std::uint8_t>(some + (blank(begin[i - 1]) & (blank(begin[i]) ^ 1)));
    words += some;
    begin += length;
  }
  return words;
}

/// The number that begins at `at` and ends before a blank or at `last`. Returns its end; null: it is none.
template <class T>
const char* parse_at(const char* at, const char* last, T& value) {
  if (*at == '+') ++at;
  const auto result = fast_float::from_chars(at, last, value);
  // Numbers too large or too small for the type come back as infinity and zero, whatever the error code says.
  const bool good = result.ec == std::errc() || result.ec == std::errc::result_out_of_range;
  return good && (result.ptr == last || blank(*result.ptr)) ? result.ptr : nullptr;
}

/// The words that begin in [begin, end) of a text.
struct Chunk {
  const char* first;
  const char* begin;
  const char* end;
  const char* last;  ///< end of the text: a word may reach beyond its chunk

  std::size_t count() const {
    if (begin == end) return 0;
    const bool at_first = begin == first;
    return words_behind(begin + (at_first ? 1 : 0), end) + (at_first && !blank(*begin) ? 1 : 0);
  }
  /// Parses up to `most` words. Returns where it stopped; `bad` is where a word begins that is no number, or null.
  template <class T>
  const char* parse(T* target, std::size_t most, const char*& bad) const {
    const char* at = begin;
    if (at != first && !blank(at[-1]))
      while (at != end && !blank(*at)) ++at;
    const char* behind = at;
    for (std::size_t i = 0; i < most; ++i) {
      while (at < end && blank(*at)) ++at;
      if (at >= end) break;
      const char* number_end = parse_at(at, last, target[i]);
      if (number_end == nullptr) {
        bad = at;
        return at;
      }
      behind = at = number_end;
    }
    return behind;
  }
};

template <class T>
TextNumbers read_all(const Source& source, std::size_t begin, std::size_t end, std::span<T> target,
                     std::string_view what) {
  const char* bytes = source.bytes.data();
  TextNumbers read{0, begin};
  for (std::size_t at = begin; at < end && read.count < target.size(); at += kChunk * kChunks) {
    const std::size_t window_end = std::min(end, at + kChunk * kChunks);
    const std::size_t chunks = (window_end - at + kChunk - 1) / kChunk;
    const auto chunk_of = [&](std::size_t i) {
      return Chunk{bytes + begin, bytes + at + i * kChunk, bytes + std::min(window_end, at + (i + 1) * kChunk),
                   bytes + end};
    };
    // How many words begin before each chunk, then each chunk by itself.
    std::array<std::size_t, kChunks + 1> before{};
    parallel_for(chunks, 1, [&](std::size_t i, std::size_t) { before[i + 1] = chunk_of(i).count(); });
    before[0] = read.count;
    for (std::size_t i = 0; i < chunks; ++i) before[i + 1] += before[i];
    std::array<const char*, kChunks> ends{}, bad{};
    parallel_for(chunks, 1, [&](std::size_t i, std::size_t) {
      const std::size_t most = std::min(before[i + 1], target.size());
      if (before[i] < most) ends[i] = chunk_of(i).parse(target.data() + before[i], most - before[i], bad[i]);
    });
    for (std::size_t i = 0; i < chunks; ++i) {
      if (bad[i] != nullptr) {
        const Source text{source.path, source.bytes.first(end)};
        TextCursor(text, static_cast<std::size_t>(bad[i] - bytes)).number(what);
      }
      if (ends[i] != nullptr) read.end = static_cast<std::size_t>(ends[i] - bytes);
    }
    read.count = std::min(before[chunks], target.size());
  }
  return read;
}

}  // namespace

TextNumbers read_numbers(const Source& source, std::size_t begin, std::size_t end, std::span<float> target,
                         std::string_view what) {
  return read_all(source, begin, end, target, what);
}

TextNumbers read_numbers(const Source& source, std::size_t begin, std::size_t end, std::span<double> target,
                         std::string_view what) {
  return read_all(source, begin, end, target, what);
}

}  // namespace meniscus::io
