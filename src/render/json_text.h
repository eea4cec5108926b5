/// A JSON file that remembers where everything stands, so that its errors can say so.
#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "meniscus/base.h"

namespace meniscus {

/// A place in a text, both from 1; the column counts bytes.
struct TextPosition {
  std::uint64_t line = 1;
  std::uint64_t column = 1;
};
TextPosition position_in(std::string_view text, std::size_t byte_offset);

/// Walks over valid JSON, comments allowed, and calls `on_value` for each value before what is inside it, with
/// its JSON pointer (RFC 6901), the offset of its key (npos: it has none) and its own. It stops when that returns
/// false. A key that an object has twice is a value twice.
void scan_json(std::string_view text,
               FunctionRef<bool(const std::string& pointer, std::size_t key, std::size_t value)> on_value);

/// A file of JSON, with // and /* */ comments.
class JsonText {
 public:
  /// @throws Error  not_found; io_failed; limit_exceeded: more than 16 MiB; malformed_file with line and column: not
  ///                JSON, nested deeper than 32, a key twice in one object
  explicit JsonText(const std::string& path);
  /// The same of a text; `path` is for the errors.
  JsonText(std::string path, std::string text);
  ~JsonText();
  JsonText(const JsonText&) = delete;
  JsonText& operator=(const JsonText&) = delete;

  const nlohmann::json& root() const { return *root_; }
  const std::string& path() const { return path_; }
  /// Where the value of a JSON pointer stands, or where its key does; the start of the text for an unknown one.
  TextPosition position_of(const std::string& pointer, bool of_key = false) const;

 private:
  void parse();
  void refuse_double_keys() const;

  std::string path_;
  std::string text_;
  std::unique_ptr<nlohmann::json> root_;
};

}  // namespace meniscus
