/// Words, lines and numbers in text; knows where it is for error messages.
#pragma once

#include "io/bytes.h"

namespace meniscus::io {

inline bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f' || c == '\v'; }

/// `text` in lower case (ASCII).
std::string lower(std::string_view text);

/// The number that `word` is, all of it; NaN and infinity are numbers, a leading + is allowed.
bool parse_number(std::string_view word, float& value);
bool parse_number(std::string_view word, double& value);
bool parse_count(std::string_view word, std::uint64_t& value);

/// The words of a line, split at blanks; of very many the first 64.
std::vector<std::string_view> words_of(std::string_view line);

/// A position in a file's bytes that moves over words and lines.
class TextCursor {
 public:
  explicit TextCursor(const Source& source, std::size_t at = 0)
      : source_(source), at_(at), ready_(source.file == nullptr ? source.bytes.size() : 0) {}

  std::size_t at() const { return at_; }
  void seek(std::size_t at) {
    at_ = at;
    if (source_.file != nullptr) ready_ = at;
  }
  bool at_end() const { return at_ >= source_.bytes.size(); }
  void skip_blanks();
  /// The next word, past blanks and line ends; empty at the end of the file.
  std::string_view word();
  /// The next word without moving.
  std::string_view peek();
  /// From here to the end of the line, without the line end; moves to the next line.
  std::string_view line();

  /// The next word as a number. Throws malformed_file where it is none.
  float number(std::string_view what);
  double wide_number(std::string_view what);
  std::uint64_t count(std::string_view what);
  /// Reads `values` numbers into target.
  void numbers(float* target, std::size_t values, std::string_view what);
  /// Moves over `values` words.
  void skip_words(std::uint64_t values, std::string_view what);

 private:
  /// Whether there is a byte at `at`, which is fetched.
  bool has(std::size_t at) { return at < ready_ || fetch(at); }
  bool fetch(std::size_t at);
  [[noreturn]] void fail(std::string_view what, std::size_t start, std::string_view found) const;
  Source source_;
  std::size_t at_;
  std::size_t ready_;  ///< up to here all bytes from at_ on are in memory
};

}  // namespace meniscus::io
