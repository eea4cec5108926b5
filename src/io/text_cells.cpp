#include "io/text_cells.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

namespace meniscus::io {
namespace {

std::string_view unquoted(std::string_view cell) {
  if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"') return cell.substr(1, cell.size() - 2);
  return cell;
}

/// A copy of a short cell with one character replaced, as a number.
bool parse_replaced(std::string_view cell, std::string_view old_characters, char replacement, double& value) {
  std::array<char, 48> copy{};
  if (cell.size() > copy.size()) return false;
  const std::size_t at = cell.find_first_of(old_characters);
  if (at == std::string_view::npos) return false;
  std::copy(cell.begin(), cell.end(), copy.begin());
  copy[at] = replacement;
  return parse_number({copy.data(), cell.size()}, value);
}

/// What older Microsoft compilers write for numbers that are none: "1.#QNAN", "-1.#IND", "1.#INF".
bool is_old_nan(std::string_view cell) {
  if (cell.starts_with('-')) cell.remove_prefix(1);
  return cell.starts_with("1.#");
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::optional<std::string_view> comment_of(std::string_view line) {
  line = trimmed(line);
  if (line.starts_with('#') || line.starts_with('%') || line.starts_with('!')) return trimmed(line.substr(1));
  if (line.starts_with("//")) return trimmed(line.substr(2));
  return std::nullopt;
}

const char* cell_end(const char* at, const char* end, char separator) {
  if (at < end && *at == '"') {
    // A doubled quote inside of a quoted cell is one that belongs to it: the cell goes on behind it.
    const void* quote = std::memchr(at + 1, '"', static_cast<std::size_t>(end - at - 1));
    while (quote != nullptr) {
      at = static_cast<const char*>(quote) + 1;
      if (at == end || *at != '"') break;
      quote = at + 1 < end ? std::memchr(at + 1, '"', static_cast<std::size_t>(end - at - 1)) : nullptr;
    }
  }
  if (separator == kBlanks) {
    while (at < end && !is_blank(*at)) ++at;
  } else {
    while (at < end && *at != separator) ++at;
  }
  return at;
}

void split_cells(std::string_view line, char separator, std::vector<std::string_view>& cells) {
  cells.clear();
  const char* at = line.data();
  const char* end = at + line.size();
  while (cells.size() <= kMostCells) {
    while (at < end && is_padding(*at, separator)) ++at;
    if (separator == kBlanks && at == end) return;
    const char* last = cell_end(at, end, separator);
    cells.push_back(unquoted(trimmed({at, static_cast<std::size_t>(last - at)})));
    if (last == end) return;
    at = last + 1;
  }
}

std::vector<char> separators_of(std::string_view line) {
  bool quoted = false, semicolon = false, comma = false, tab = false;
  for (const char c : line) {
    if (c == '"') quoted = !quoted;
    if (quoted) continue;
    semicolon = semicolon || c == ';';
    comma = comma || c == ',';
    tab = tab || c == '\t';
  }
  if (semicolon) return {';'};
  if (comma) return {','};
  if (tab) return {'\t', kBlanks};
  return {kBlanks};
}

std::string without_unit(std::string_view name) {
  std::string_view plain = trimmed(name);
  const char open = plain.ends_with(']') ? '[' : plain.ends_with(')') ? '(' : '\0';
  if (open != '\0') {
    const std::size_t at = plain.rfind(open);
    const bool is_index = at != std::string_view::npos && plain.size() == at + 3 && plain[at + 1] >= '0' &&
                          plain[at + 1] <= '9' && open == '[';
    if (at != std::string_view::npos && at > 0 && !is_index) plain = trimmed(plain.substr(0, at));
  }
  std::string result;
  for (std::size_t i = 0; i < plain.size(); ++i) {
    result += plain[i];
    if (plain[i] == '"' && i + 1 < plain.size() && plain[i + 1] == '"') ++i;
  }
  return result;
}

CellKind read_cell(std::string_view cell, double& value) {
  value = std::numeric_limits<double>::quiet_NaN();
  if (cell.size() == 1 && static_cast<unsigned char>(cell[0]) < 0x20) {
    value = static_cast<double>(cell[0]);
    return CellKind::number;
  }
  cell = trimmed(unquoted(cell));
  if (cell.empty()) return CellKind::empty;
  if (parse_number(cell, value)) return CellKind::number;
  const bool starts_like_one = (cell[0] >= '0' && cell[0] <= '9') || cell[0] == '-' || cell[0] == '+' || cell[0] == '.';
  if (starts_like_one || cell[0] == ',') {
    if (parse_replaced(cell, "dD", 'e', value)) return CellKind::number;
    if (double ignored = 0; parse_replaced(cell, ",", '.', ignored)) return CellKind::decimal_comma;
    if (is_old_nan(cell)) return CellKind::number;
  }
  value = std::numeric_limits<double>::quiet_NaN();
  return CellKind::text;
}

std::string shown(std::string_view text) {
  std::string result(text.substr(0, 40));
  for (char& c : result) {
    if (c < ' ' || c > '~') c = '?';
  }
  return "'" + result + (text.size() > 40 ? "...'" : "'");
}

}  // namespace meniscus::io
