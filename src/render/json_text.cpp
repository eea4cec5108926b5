#include "render/json_text.h"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <unordered_set>

namespace meniscus {
namespace {

using nlohmann::json;

constexpr std::size_t kMostBytes = std::size_t{16} << 20;
constexpr int kDeepest = 32;

std::string text_of_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error(ErrorCode::not_found, {"the file cannot be opened", {}, {}, path, {}, {}, {}});
  std::string text(kMostBytes + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (file.bad() || (file.fail() && !file.eof()))
    throw Error(ErrorCode::io_failed, {"the file cannot be read", {}, {}, path, {}, {}, {}});
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (text.size() > kMostBytes)
    throw Error(ErrorCode::limit_exceeded,
                {"the file is too large for a description", "up to 16 MiB", "more", path, {}, {}, {}});
  return text;
}

[[noreturn]] void refuse(const std::string& path, TextPosition position, const std::string& problem,
                         std::string expected, std::string found) {
  throw Error(ErrorCode::malformed_file, {fmt::format("{}, at column {}", problem, position.column),
                                          std::move(expected),
                                          std::move(found),
                                          path,
                                          {},
                                          position.line,
                                          {}});
}

/// What the parser says, without its own words on the position.
std::string reason_of(const char* what) {
  const std::string text = what;
  const std::size_t column = text.find("column ");
  const std::size_t colon = column == std::string::npos ? std::string::npos : text.find(": ", column);
  return colon == std::string::npos ? text : text.substr(colon + 2);
}

}  // namespace

JsonText::JsonText(const std::string& path) : JsonText(path, text_of_file(path)) {}

JsonText::JsonText(std::string path, std::string text) : path_(std::move(path)), text_(std::move(text)) {
  parse();
  refuse_double_keys();
}

JsonText::~JsonText() = default;

void JsonText::parse() {
  const auto shallow = [&](int depth, json::parse_event_t, json&) {
    if (depth > kDeepest)
      throw Error(ErrorCode::malformed_file,
                  {fmt::format("lists and objects are nested deeper than {}", kDeepest), {}, {}, path_, {}, {}, {}});
    return true;
  };
  try {
    root_ = std::make_unique<json>(json::parse(text_, shallow, true, true));
  } catch (const json::parse_error& error) {
    refuse(path_, position_in(text_, error.byte > 0 ? error.byte - 1 : 0), "this is not JSON", "",
           reason_of(error.what()));
  } catch (const json::exception& error) {  // a number that no double holds
    const std::string what = error.what();
    const std::size_t open = what.find('\''), close = what.rfind('\'');
    const std::string token = open < close ? what.substr(open + 1, close - open - 1) : std::string();
    refuse(path_, position_in(text_, token.empty() ? 0 : text_.find(token)), "a number is too large", "", token);
  }
}

void JsonText::refuse_double_keys() const {
  std::unordered_set<std::string> seen;
  const auto on_value = [&](const std::string& pointer, std::size_t key, std::size_t) {
    if (key != std::string::npos && !seen.insert(pointer).second)
      refuse(path_, position_in(text_, key), "a field stands here a second time", "each field once", pointer.substr(1));
    return true;
  };
  scan_json(text_, on_value);
}

TextPosition JsonText::position_of(const std::string& pointer, bool of_key) const {
  std::size_t offset = 0;
  const auto on_value = [&](const std::string& here, std::size_t key, std::size_t value) {
    if (here != pointer) return true;
    offset = of_key && key != std::string::npos ? key : value;
    return false;
  };
  scan_json(text_, on_value);
  return position_in(text_, offset);
}

}  // namespace meniscus
