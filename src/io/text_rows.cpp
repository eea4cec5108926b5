#include "io/text_rows.h"

#include <fast_float/fast_float.h>
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "io/text_names.h"

namespace meniscus::io {
namespace {

constexpr std::size_t kPieceBytes = std::size_t{1} << 19;
constexpr int kSkipped = -1;  ///< a column that is not kept; 0, 1, 2: x, y, z; from 3: an attribute

/// Some lines of the file, and the place of their first row among all.
struct Piece {
  std::size_t begin = 0, end = 0;  ///< bytes
  std::size_t first_row = 0, rows = 0;
  std::vector<std::uint64_t> missing;  ///< as in TextRows
  bool failed = false;
  std::size_t failed_at = 0;  ///< byte where the line begins that is in error
  std::string problem, expected, found, advice;
};

/// The end of the line that begins at `at`.
const char* line_end_of(const char* at, const char* end, char line_end) {
  const void* found = std::memchr(at, line_end, static_cast<std::size_t>(end - at));
  return found != nullptr ? static_cast<const char*>(found) : end;
}

/// Whether a line is a row: neither empty nor a comment nor separators only, as spreadsheets end tables with.
bool is_row(const char* at, const char* end, char separator) {
  while (at < end && is_padding(*at, separator)) ++at;
  if (at == end) return false;
  if (*at == separator) return std::any_of(at, end, [&](char c) { return c != separator && !is_blank(c); });
  return *at != '#' && *at != '%' && *at != '!' && !(*at == '/' && at + 1 < end && at[1] == '/');
}

/// Cuts the rows into pieces that end at line ends. Every byte is looked at once, however long lines are.
std::vector<Piece> pieces_of(const Source& source, const TextTable& table) {
  std::vector<Piece> pieces;
  const char* first = source.bytes.data();
  const std::size_t size = source.bytes.size();
  for (std::size_t at = table.first_row; at < size;) {
    std::size_t end = size;
    if (size - at > kPieceBytes) {
      const char* line = line_end_of(first + at + kPieceBytes, first + size, table.line_end);
      end = std::min(static_cast<std::size_t>(line - first) + 1, size);
    }
    pieces.emplace_back().begin = at;
    pieces.back().end = end;
    at = end;
  }
  return pieces;
}

class RowReader {
 public:
  RowReader(const Source& source, const TextTable& table)
      : source_(source), table_(table), separator_(table.separator), roles_(table.columns, kSkipped) {
    result_.values.resize(table.columns);
    if (!table.names.empty())
      for (std::size_t c = 0; c < table.columns; ++c) roles_[c] = 3 + static_cast<int>(c);
    for (std::size_t axis = 0; axis < 3; ++axis) roles_[table.position[axis]] = static_cast<int>(axis);
  }

  TextRows read() {
    std::vector<Piece> pieces = pieces_of(source_, table_);
    parallel_for(pieces.size(), 1, [&](std::size_t i, std::size_t) {
      pieces[i].rows = count_rows(source_, table_, pieces[i].begin, pieces[i].end);
    });
    std::size_t rows = 0;
    for (Piece& piece : pieces) {
      piece.first_row = rows;
      rows += piece.rows;
    }
    result_.positions.resize(3 * rows);
    for (std::size_t c = 0; c < table_.columns; ++c)
      if (roles_[c] >= 3) result_.values[c].resize(rows);

    parallel_for(pieces.size(), 1, [&](std::size_t i, std::size_t) { read_piece(pieces[i]); });
    result_.missing.assign(table_.columns, 0);
    for (const Piece& piece : pieces) {
      if (piece.failed) fail(piece);
      for (std::size_t c = 0; c < table_.columns; ++c) result_.missing[c] += piece.missing[c];
    }
    return std::move(result_);
  }

 private:
  [[noreturn]] void fail(const Piece& piece) const {
    throw Error(ErrorCode::malformed_file, {piece.problem, piece.expected, piece.found, source_.path, std::nullopt,
                                            line_number(source_, table_.line_end, piece.failed_at), piece.advice});
  }

  void read_piece(Piece& piece) {
    piece.missing.assign(table_.columns, 0);
    const char* at = source_.bytes.data() + piece.begin;
    const char* end = source_.bytes.data() + piece.end;
    for (std::size_t row = piece.first_row; at < end;) {
      const char* line_end = line_end_of(at, end, table_.line_end);
      if (is_row(at, line_end, separator_) && !read_row(at, line_end, row++, piece)) {
        piece.failed = true;
        piece.failed_at = static_cast<std::size_t>(at - source_.bytes.data());
        return;
      }
      at = line_end + 1;
    }
  }

  /// Reads one line; false: it is in error, and the piece says which.
  bool read_row(const char* const line, const char* const end, std::size_t row, Piece& piece) {
    const std::size_t columns = table_.columns;
    const char* at = line;
    for (std::size_t c = 0; c < columns; ++c) {
      while (at < end && is_padding(*at, separator_)) ++at;
      if (separator_ == kBlanks && at == end) return wrong_columns(line, end, piece);
      const int role = roles_[c];
      const char* last = at;
      if (role == kSkipped) {
        last = cell_end(at, end, separator_);
      } else if (role < 3) {
        double& target = result_.positions[3 * row + static_cast<std::size_t>(role)];
        if (!quick(at, end, target, last) && !read_position(at, end, c, target, last, piece)) return false;
        keep_float(at, last, target);
      } else {
        float& target = result_.values[c][row];
        if (!quick(at, end, target, last) && !read_other(at, end, c, target, last, piece)) return false;
      }
      at = last;
      if (c + 1 == columns) break;
      if (at == end) return wrong_columns(line, end, piece);
      ++at;
    }
    // A separator behind the last cell is no further cell.
    if (at < end && *at == separator_) ++at;
    while (at < end && is_blank(*at)) ++at;
    return at == end || wrong_columns(line, end, piece);
  }

  /// Reads a plain number that a separator or the end of the line follows, which `last` then is.
  template <class T>
  bool quick(const char* at, const char* end, T& target, const char*& last) const {
    const auto result = fast_float::from_chars(at, end, target);
    if (result.ptr == at || (result.ec != std::errc() && result.ec != std::errc::result_out_of_range)) return false;
    last = result.ptr;
    if (separator_ == kBlanks) return last == end || is_blank(*last);
    while (last < end && is_padding(*last, separator_)) ++last;
    return last == end || *last == separator_;
  }

  /// A decimal that is nearest to a float keeps that float when the double nearest to the decimal lies in the middle of
  /// two floats: rounding twice would forget to which side of the middle it belongs.
  static void keep_float(const char* at, const char* last, double& value) {
    constexpr std::uint64_t kBelowFloat = (std::uint64_t{1} << 29) - 1, kMiddle = std::uint64_t{1} << 28;
    if ((std::bit_cast<std::uint64_t>(value) & kBelowFloat) != kMiddle) return;
    float once = 0;
    if (fast_float::from_chars(at, last, once).ec != std::errc()) return;
    if (static_cast<float>(value) != once) value = std::nextafter(value, static_cast<double>(once));
  }

  CellKind slow(const char* at, const char* end, double& value, const char*& last) const {
    last = cell_end(at, end, separator_);
    const auto size = static_cast<std::size_t>(last - at);
    return read_cell(size == 1 ? std::string_view(at, 1) : trimmed({at, size}), value);
  }

  bool read_position(const char* at, const char* end, std::size_t column, double& target, const char*& last,
                     Piece& piece) const {
    const CellKind kind = slow(at, end, target, last);
    if (kind == CellKind::number) return true;
    if (kind == CellKind::decimal_comma) return decimal_comma(at, last, piece);
    piece.problem = kind == CellKind::empty ? "a coordinate is missing" : "a coordinate is no number";
    piece.expected = fmt::format("a number in column {}{}", column + 1, named(column));
    piece.found = shown({at, static_cast<std::size_t>(last - at)});
    piece.advice = "a line is: x y z, and further columns";
    return false;
  }

  bool read_other(const char* at, const char* end, std::size_t column, float& target, const char*& last,
                  Piece& piece) const {
    double value = 0;
    const CellKind kind = slow(at, end, value, last);
    target = static_cast<float>(value);
    if (kind == CellKind::decimal_comma) return decimal_comma(at, last, piece);
    if (kind != CellKind::number) ++piece.missing[column];
    return true;
  }

  static bool decimal_comma(const char* at, const char* last, Piece& piece) {
    piece.problem = "a number has a decimal comma";
    piece.expected = "a decimal point";
    piece.found = shown({at, static_cast<std::size_t>(last - at)});
    piece.advice = kDecimalPoints;
    return false;
  }

  bool wrong_columns(const char* line, const char* end, Piece& piece) const {
    std::vector<std::string_view> cells;
    const std::string_view text(line, static_cast<std::size_t>(end - line));
    split_cells(text, separator_, cells);
    const bool more = cells.size() > kMostCells;
    piece.problem = fmt::format("a line has {}{} column{}", more ? "more than " : "", cells.size() - (more ? 1 : 0),
                                cells.size() == 1 ? "" : "s");
    piece.expected =
        fmt::format("{} as the {} has", table_.columns, table_.names.empty() ? "first line" : "line of names");
    piece.found = shown(trimmed(text));
    piece.advice = "a line is: x y z, and further columns";
    return false;
  }

  std::string named(std::size_t column) const {
    return table_.names.empty() ? std::string() : fmt::format(" ({})", table_.names[column]);
  }

  Source source_;
  const TextTable& table_;
  char separator_;
  std::vector<int> roles_;  ///< one a column
  TextRows result_;
};

}  // namespace

std::uint64_t count_rows(const Source& source, const TextTable& table, std::size_t begin, std::size_t end) {
  // A shorter line cannot have all cells: it is in error, and what comes behind it will not be read.
  const std::size_t least = table.separator == kBlanks ? 2 * table.columns - 1 : table.columns + 2;
  std::uint64_t rows = 0;
  const char* at = source.bytes.data() + begin;
  const char* last = source.bytes.data() + end;
  while (at < last) {
    const char* line_end = line_end_of(at, last, table.line_end);
    if (is_row(at, line_end, table.separator)) {
      ++rows;
      if (static_cast<std::size_t>(line_end - at) < least) return rows;
    }
    at = line_end + 1;
  }
  return rows;
}

TextRows read_rows(const Source& source, const TextTable& table) { return RowReader(source, table).read(); }

}  // namespace meniscus::io
