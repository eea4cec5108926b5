#include "io/base64.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>

#include "io/text.h"

namespace meniscus::io {
namespace {

constexpr std::size_t kGrain = 1 << 15;  ///< quartets
constexpr std::uint8_t kNone = 0xff;

constexpr std::array<std::uint8_t, 256> table() {
  std::array<std::uint8_t, 256> values{};
  for (std::uint8_t& value : values) value = kNone;
  constexpr std::string_view kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (std::size_t i = 0; i < kLetters.size(); ++i)
    values[static_cast<unsigned char>(kLetters[i])] = static_cast<std::uint8_t>(i);
  return values;
}
constexpr std::array<std::uint8_t, 256> kValues = table();

std::uint32_t value_of(char c) { return kValues[static_cast<unsigned char>(c)]; }

/// Four characters to three bytes, `quartets` times; returns the first quartet that has another character.
std::size_t decode_quartets(const char* from, std::size_t quartets, char* to) {
  for (std::size_t i = 0; i < quartets; ++i, from += 4, to += 3) {
    const std::uint32_t a = value_of(from[0]), b = value_of(from[1]), c = value_of(from[2]), d = value_of(from[3]);
    if (((a | b | c | d) & 0xc0) != 0) return i;
    const std::uint32_t bits = a << 18 | b << 12 | c << 6 | d;
    to[0] = static_cast<char>(bits >> 16);
    to[1] = static_cast<char>(bits >> 8);
    to[2] = static_cast<char>(bits);
  }
  return quartets;
}

std::size_t decode_parallel(const char* from, std::size_t quartets, char* to) {
  std::atomic<std::size_t> first_bad{quartets};
  parallel_for(quartets, kGrain, [&](std::size_t begin, std::size_t end) {
    const std::size_t bad = begin + decode_quartets(from + 4 * begin, end - begin, to + 3 * begin);
    if (bad == end) return;
    std::size_t least = first_bad;
    while (bad < least && !first_bad.compare_exchange_weak(least, bad)) {
    }
  });
  return first_bad;
}

/// "xx==" or "xxx=": one or two bytes; none for anything else.
std::size_t decode_last(const char* from, char* to) {
  const std::uint32_t a = value_of(from[0]), b = value_of(from[1]), c = value_of(from[2]);
  if (((a | b) & 0xc0) != 0 || from[3] != '=' || (c == kNone && from[2] != '=')) return 0;
  to[0] = static_cast<char>(a << 2 | b >> 4);
  if (c == kNone) return 1;
  to[1] = static_cast<char>(b << 4 | c >> 2);
  return 2;
}

struct Progress {
  std::size_t made = 0;  ///< bytes
  std::size_t used = 0;  ///< characters
  bool stuck = false;    ///< at a character that is not base64, or in a quartet that is not whole
};

/// Decodes text without blanks until there are `most` bytes; writes at most two more.
Progress decode_dense(std::span<const char> text, std::uint64_t most, char* target) {
  Progress at;
  while (at.made < most && at.used < text.size()) {
    const char* from = text.data() + at.used;
    const std::size_t wanted = std::min<std::uint64_t>((text.size() - at.used) / 4,
                                                       (most - at.made) / 3 + ((most - at.made) % 3 != 0 ? 1 : 0));
    const void* padding = wanted > 0 ? std::memchr(from, '=', 4 * wanted) : nullptr;
    const std::size_t whole =
        padding != nullptr ? static_cast<std::size_t>(static_cast<const char*>(padding) - from) / 4 : wanted;
    const std::size_t good = decode_parallel(from, whole, target + at.made);
    at.made += 3 * good;
    at.used += 4 * good;
    if (good == whole && padding == nullptr && whole > 0) continue;
    const std::size_t last = good == whole && padding != nullptr ? decode_last(from + 4 * good, target + at.made) : 0;
    at.made += last;
    at.used += last > 0 ? 4 : 0;
    if (last == 0) {
      at.stuck = true;
      break;
    }
  }
  return at;
}

std::size_t capacity(std::size_t characters, std::uint64_t most) {
  return static_cast<std::size_t>(std::min<std::uint64_t>(characters / 4 * 3, most)) + 3;
}

/// The characters without blanks, as many as `most` bytes can need.
std::vector<char> without_blanks(std::span<const char> text, std::uint64_t most) {
  const std::uint64_t room = std::min<std::uint64_t>(text.size(), most < text.size() ? most / 3 * 4 + 32 : text.size());
  std::vector<char> dense;
  dense.reserve(static_cast<std::size_t>(room));
  for (const char c : text) {
    if (dense.size() == room) break;
    if (!is_blank(c)) dense.push_back(c);
  }
  return dense;
}

}  // namespace

DecodedBase64 decode_base64(const Source& source, std::size_t begin, std::size_t end, std::uint64_t most) {
  std::span<const char> text = source.bytes.subspan(begin, end - begin);
  while (!text.empty() && is_blank(text.front())) text = text.subspan(1);
  while (!text.empty() && is_blank(text.back())) text = text.first(text.size() - 1);
  const auto begin_of_text = static_cast<std::size_t>(text.data() - source.bytes.data());
  DecodedBase64 decoded{Bytes(capacity(text.size(), most)), 0};
  Progress progress = decode_dense(text, most, decoded.bytes.data());
  if (progress.stuck) {
    // Long lines are broken by some writers.
    const std::vector<char> dense = without_blanks(text, most);
    progress = decode_dense(dense, most, decoded.bytes.data());
    if (progress.stuck) {
      const auto bad = std::find_if(text.begin(), text.end(),
                                    [](char c) { return value_of(c) == kNone && c != '=' && !is_blank(c); });
      source.malformed(bad == text.end() ? "the base64 text ends early or has padding in its midst"
                                         : "the base64 text has a character that is not base64",
                       begin_of_text + static_cast<std::size_t>(bad - text.begin()));
    }
  }
  decoded.size = static_cast<std::size_t>(std::min<std::uint64_t>(progress.made, most));
  return decoded;
}

}  // namespace meniscus::io
