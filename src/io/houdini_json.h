/// Houdini's JSON, as text and as its binary encoding, one word after the other.
#pragma once

#include <map>

#include "io/bytes.h"
#include "io/values.h"

namespace meniscus::io {

/// Numbers of one type that stand side by side in memory. Bits are packed in words of 32, the lowest first.
struct NumberRun {
  enum class Form { plain, half, bits };  ///< half: floats of 16 bits, of which `type` says uint16
  Scalar type = Scalar::float64;
  Form form = Form::plain;
  const char* first = nullptr;
  std::uint64_t count = 0;
};

/// A value, or one end of a list.
struct HoudiniWord {
  enum class Kind { null, truth, number, text, run, begin, end };  ///< begin and end of arrays and of maps
  Kind kind = Kind::null;
  double number = 0;   ///< of a number; of a truth 0 or 1
  std::string text;    ///< may be no UTF-8
  NumberRun run;       ///< a whole array of numbers: only binary files have them
  std::size_t at = 0;  ///< byte offset, for messages
};

/// A position in such a file. Arrays of texts are given as begin, texts, end; so are maps, with names and values in
/// turn. Separators of text count as blanks. What stands behind the first value is not read.
class HoudiniJson {
 public:
  /// Where a value begins.
  struct Place {
    std::size_t at = 0;
    std::vector<char> open;
  };

  /// @param source  must outlive this; begins as is_houdini_json() asks for
  explicit HoudiniJson(const Source& source);

  const Source& source() const { return source_; }
  std::endian order() const { return order_; }
  Place place() const { return {at_, open_}; }
  void seek(const Place& place);

  /// The next word.
  /// @throws Error  malformed_file: the file ends, or is no JSON, or is nested deeper than kDeepest
  HoudiniWord next();
  /// Moves over a value.
  void skip() { finish(next()); }
  /// Moves over what is left of the value that a word begins.
  void finish(const HoudiniWord& first);
  /// Moves over the names and values of a map, or of an array that has them in turn. `visit` moves over each value.
  /// It ends early where visit gives false.
  void for_each(FunctionRef<bool(const std::string& name)> visit);
  /// The next word, which must be a whole number of at least 0.
  std::uint64_t count(std::string_view what);

  [[noreturn]] void malformed(std::string problem, std::size_t at, std::string expected = {},
                              std::string found = {}) const;

 private:
  static constexpr std::size_t kDeepest = 64;  ///< Houdini's own files have a dozen levels

  HoudiniWord next_of_text();
  HoudiniWord next_of_binary();
  HoudiniWord next_of_texts();
  HoudiniWord begin(char closing, std::size_t at);
  HoudiniWord end(char closing, std::size_t at);
  std::string quoted();
  char byte(std::string_view what);
  std::string_view bytes(std::uint64_t size, std::string_view what);
  std::uint64_t length();
  void define();
  std::string defined();
  HoudiniWord uniform(std::size_t at);

  Source source_;
  bool binary_ = false;
  std::endian order_ = std::endian::little;
  std::size_t at_ = 0;
  std::vector<char> open_;                            ///< how what is open must be closed
  std::uint64_t texts_ = 0;                           ///< left of an array of texts
  bool texts_are_defined_ = false;                    ///< and whether they are numbers of defined ones
  std::map<std::uint64_t, std::string_view> tokens_;  ///< texts that were defined, by number
};

/// Whether a file starts as binary JSON, or as text with the names that Houdini begins its geometry with.
bool is_houdini_json(const Source& start);

}  // namespace meniscus::io
