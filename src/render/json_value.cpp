#include "render/json_value.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace meniscus {
namespace {

std::string pointer_part(const std::string& key) {
  std::string part;
  for (const char c : key) part += c == '~' ? std::string("~0") : c == '/' ? std::string("~1") : std::string(1, c);
  return part;
}

}  // namespace

bool JsonValue::is_boolean() const { return json_->is_boolean(); }
bool JsonValue::is_integer() const {
  if (json_->is_number_unsigned()) return json_->get<std::uint64_t>() <= (std::uint64_t{1} << 53);
  if (json_->is_number_integer()) return true;
  return json_->is_number() && std::abs(number()) <= 0x1p53 && std::floor(number()) == number();
}
bool JsonValue::is_number() const { return json_->is_number(); }
bool JsonValue::is_text() const { return json_->is_string(); }
bool JsonValue::is_list() const { return json_->is_array(); }
bool JsonValue::is_object() const { return json_->is_object(); }

bool JsonValue::boolean() const { return json_->get<bool>(); }
std::int64_t JsonValue::integer() const {
  return json_->is_number_float() ? static_cast<std::int64_t>(number()) : json_->get<std::int64_t>();
}
double JsonValue::number() const { return json_->get<double>(); }
std::string JsonValue::text() const { return json_->get<std::string>(); }
std::size_t JsonValue::size() const { return json_->size(); }

JsonValue JsonValue::at(std::size_t index) const {
  return {text_, &(*json_)[index], fmt::format("{}/{}", pointer_, index), fmt::format("{}[{}]", field_, index)};
}

std::vector<std::string> JsonValue::keys() const {
  std::vector<std::string> keys;
  for (const auto& item : json_->items()) keys.push_back(item.key());
  return keys;
}
bool JsonValue::has(const std::string& key) const { return json_->contains(key); }
JsonValue JsonValue::member(const std::string& key) const { return child(key, &json_->at(key)); }

JsonValue JsonValue::child(const std::string& key, const nlohmann::json* json) const {
  return {text_, json, pointer_ + '/' + pointer_part(key), field_.empty() ? key : field_ + '.' + key};
}

std::string JsonValue::dump() const {
  const std::string text = json_->dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  if (text.size() <= 48) return text;
  std::size_t end = 45;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0) == 0x80) --end;  // not inside a letter
  return text.substr(0, end) + "...";
}

void JsonValue::refuse(const std::string& problem, std::string expected, std::string found, std::string advice) const {
  const TextPosition position = text_->position_of(pointer_);
  throw Error(ErrorCode::malformed_file,
              {fmt::format("{}{}, at column {}", field_.empty() ? "" : field_ + " ", problem, position.column),
               std::move(expected),
               std::move(found),
               text_->path(),
               {},
               position.line,
               std::move(advice)});
}

void JsonValue::refuse_key(const std::string& key, const std::string& problem, std::string advice) const {
  const JsonValue value = member(key);
  const TextPosition position = text_->position_of(value.pointer_, true);
  throw Error(ErrorCode::malformed_file, {fmt::format("{} {}, at column {}", value.field_, problem, position.column),
                                          {},
                                          {},
                                          text_->path(),
                                          {},
                                          position.line,
                                          std::move(advice)});
}

}  // namespace meniscus
