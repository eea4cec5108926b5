#include "io/text_numbers.h"

#include <algorithm>
#include <array>

#include "io/text.h"

namespace meniscus::io {
namespace {

constexpr std::size_t kChunk = std::size_t{1} << 17;  ///< bytes
constexpr std::size_t kChunks = 64;                   ///< at once

constexpr std::array<bool, 256> blanks() {
  std::array<bool, 256> table{};
  for (const char c : {' ', '\t', '\n', '\r', '\f', '\v'}) table[static_cast<unsigned char>(c)] = true;
  return table;
}
constexpr std::array<bool, 256> kBlank = blanks();
bool blank(char c) { return kBlank[static_cast<unsigned char>(c)]; }

/// The words that begin in [begin, end) of a text.
struct Chunk {
  const char* first;
  const char* begin;
  const char* end;
  const char* last;  ///< end of the text: a word may reach beyond its chunk

  std::size_t count() const {
    std::size_t words = 0;
    bool before = begin == first || blank(begin[-1]);
    for (const char* at = begin; at != end; ++at) {
      const bool now = blank(*at);
      words += before && !now ? 1 : 0;
      before = now;
    }
    return words;
  }
  /// Parses up to `most` words. Returns where it stopped; `bad` is where a word begins that is no number, or null.
  template <class T>
  const char* parse(T* target, std::size_t most, const char*& bad) const {
    const char* at = begin;
    if (at != first && !blank(at[-1]))
      while (at != end && !blank(*at)) ++at;
    const char* behind = at;
    for (std::size_t i = 0; i < most; ++i) {
      while (at != end && blank(*at)) ++at;
      if (at == end) break;
      const char* word = at;
      while (at != last && !blank(*at)) ++at;
      if (!parse_number(std::string_view(word, static_cast<std::size_t>(at - word)), target[i])) {
        bad = word;
        return word;
      }
      behind = at;
      if (at >= end) break;
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
