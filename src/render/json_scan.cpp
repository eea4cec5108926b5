#include <nlohmann/json.hpp>

#include "render/json_text.h"

namespace meniscus {
namespace {

/// An object or a list that the scan is inside of.
struct Level {
  bool is_object = false;
  std::size_t index = 0;           ///< of the next item of a list
  std::size_t pointer_length = 0;  ///< of this object's or list's own pointer
};

class Scan {
 public:
  using OnValue = FunctionRef<bool(const std::string&, std::size_t, std::size_t)>;
  Scan(std::string_view text, const OnValue& on_value) : text_(text), on_value_(on_value) {
    if (text_.substr(0, 3) == "\xef\xbb\xbf") at_ = 3;
  }

  void run() {
    std::size_t key = std::string::npos;
    while (skip_space(), at_ < text_.size()) {
      const char c = text_[at_];
      if (c == ',') {
        ++at_;
      } else if (c == '}' || c == ']') {
        ++at_;
        if (levels_.empty()) return;
        levels_.pop_back();
      } else if (c == '"' && !levels_.empty() && levels_.back().is_object && key == std::string::npos) {
        key = at_;
        back_to_parent();
        pointer_ += '/' + escaped(string_at());
        skip_space();
        if (at_ < text_.size()) ++at_;  // the colon
      } else {
        if (!levels_.empty() && !levels_.back().is_object) {
          back_to_parent();
          pointer_ += '/' + std::to_string(levels_.back().index++);
        }
        if (!on_value_(pointer_, key, at_)) return;
        key = std::string::npos;
        skip_value();
      }
    }
  }

 private:
  void back_to_parent() { pointer_.resize(levels_.back().pointer_length); }

  /// Steps into an object or a list, over anything else.
  void skip_value() {
    const char c = text_[at_];
    if (c == '{' || c == '[') {
      levels_.push_back({c == '{', 0, pointer_.size()});
      ++at_;
    } else if (c == '"') {
      string_at();
    } else {
      ++at_;
      while (at_ < text_.size() && std::string_view(",]} \t\r\n/").find(text_[at_]) == std::string_view::npos) ++at_;
    }
  }

  void skip_space() {
    while (at_ < text_.size()) {
      const std::string_view rest = text_.substr(at_, 2);
      if (rest == "//") {
        at_ = std::min(text_.find_first_of("\r\n", at_), text_.size());
      } else if (rest == "/*") {
        const std::size_t end = text_.find("*/", at_ + 2);
        at_ = end == std::string_view::npos ? text_.size() : end + 2;
      } else if (std::string_view(" \t\r\n").find(rest[0]) != std::string_view::npos) {
        ++at_;
      } else {
        return;
      }
    }
  }

  /// The string that begins here, without its escapes; afterwards the scan is behind it.
  std::string string_at() {
    const std::size_t begin = at_++;
    while (at_ < text_.size() && text_[at_] != '"') at_ += text_[at_] == '\\' ? 2 : 1;
    at_ = std::min(at_ + 1, text_.size());
    const std::string_view token = text_.substr(begin, at_ - begin);
    if (token.find('\\') == std::string_view::npos) return std::string(token.substr(1, token.size() - 2));
    return nlohmann::json::parse(token).get<std::string>();
  }

  /// A key as a part of a pointer. (RFC 6901, 4)
  static std::string escaped(const std::string& key) {
    std::string part;
    for (const char c : key) part += c == '~' ? std::string("~0") : c == '/' ? std::string("~1") : std::string(1, c);
    return part;
  }

  std::string_view text_;
  const OnValue& on_value_;
  std::size_t at_ = 0;
  std::vector<Level> levels_;
  std::string pointer_;
};

}  // namespace

void scan_json(std::string_view text, FunctionRef<bool(const std::string&, std::size_t, std::size_t)> on_value) {
  Scan(text, on_value).run();
}

TextPosition position_in(std::string_view text, std::size_t byte_offset) {
  const std::string_view before = text.substr(0, std::min(byte_offset, text.size()));
  TextPosition position;
  for (const char c : before) position.line += c == '\n' ? 1 : 0;
  const std::size_t newline = before.rfind('\n');
  position.column = 1 + (newline == std::string_view::npos ? before.size() : before.size() - newline - 1);
  return position;
}

}  // namespace meniscus
