/// One value of a JSON file and where it stands.
#pragma once

#include "render/json_text.h"

namespace meniscus {

class JsonValue {
 public:
  explicit JsonValue(const JsonText& text) : text_(&text), json_(&text.root()) {}

  bool is_boolean() const;
  bool is_integer() const;  ///< a whole number, also 2.0
  bool is_number() const;
  bool is_text() const;
  bool is_list() const;
  bool is_object() const;

  bool boolean() const;
  std::int64_t integer() const;
  double number() const;
  float real() const { return static_cast<float>(number()); }
  std::string text() const;
  /// Of a list or an object.
  std::size_t size() const;
  /// Item of a list.
  JsonValue at(std::size_t index) const;
  /// A list of three numbers; two.
  vec3 three() const { return {at(0).real(), at(1).real(), at(2).real()}; }
  vec2 two() const { return {at(0).real(), at(1).real()}; }
  /// Keys of an object.
  std::vector<std::string> keys() const;
  bool has(const std::string& key) const;
  JsonValue member(const std::string& key) const;

  TextPosition position() const { return text_->position_of(pointer_); }
  /// "meshes[2].rotate"; empty for the whole file.
  const std::string& field() const { return field_; }
  const JsonText& file() const { return *text_; }
  /// As it stands in the file, shortened.
  std::string dump() const;
  /// @throws Error  malformed_file with path, line, column and field
  [[noreturn]] void refuse(const std::string& problem, std::string expected, std::string found,
                           std::string advice = {}) const;
  /// The same about a key of this object.
  [[noreturn]] void refuse_key(const std::string& key, const std::string& problem, std::string advice) const;

 private:
  JsonValue(const JsonText* text, const nlohmann::json* json, std::string pointer, std::string field)
      : text_(text), json_(json), pointer_(std::move(pointer)), field_(std::move(field)) {}
  JsonValue child(const std::string& key, const nlohmann::json* json) const;

  const JsonText* text_;
  const nlohmann::json* json_;
  std::string pointer_;
  std::string field_;
};

}  // namespace meniscus
