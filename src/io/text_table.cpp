#include "io/text_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "io/attributes.h"
#include "io/text_names.h"

namespace meniscus::io {
namespace {

constexpr std::size_t kMostHeaderLines = 32;  ///< lines before the first row that are neither empty nor comments
constexpr std::size_t kComments = 16;         ///< of which one may name the columns: the last ones

struct Line {
  std::string_view text;  ///< without its end
  std::size_t offset = 0;
  std::uint64_t number = 0;
};

/// Whether the cells are those of a row: a number first, or three numbers behind a name that is none.
bool is_row(const std::vector<std::string_view>& cells) {
  double value = 0;
  const auto is_number = [&](std::string_view cell) {
    const CellKind kind = read_cell(cell, value);
    return kind == CellKind::number || kind == CellKind::decimal_comma;
  };
  if (cells.empty()) return false;
  if (is_number(cells[0])) return true;
  return cells.size() > 3 && std::all_of(cells.begin() + 1, cells.begin() + 4, is_number);
}

class TableFinder {
 public:
  TableFinder(const Source& source, const ReadOptions& options) : source_(source), wanted_(source, options) {}

  TextTable find() {
    collect_lines();
    table_.first_row = source_.bytes.size();
    std::size_t first = take_count();
    if (first == lines_.size() && !has_rows_) return table_;
    if (use_named_header(first)) return table_;
    const std::size_t row = first_row(first);
    begin_rows(row);
    name_columns(first, row);
    return table_;
  }

 private:
  [[noreturn]] void fail(const Line& line, std::string problem, std::string expected, std::string advice = {}) const {
    if (advice.empty()) advice = "a line is: x y z, and further columns";
    throw Error(ErrorCode::malformed_file, {std::move(problem), std::move(expected), shown(trimmed(line.text)),
                                            source_.path, std::nullopt, line.number, std::move(advice)});
  }

  /// Cuts what stands before the rows, and the first of them, into lines.
  void collect_lines() {
    const std::span<const char> bytes = source_.bytes;
    if (source_.starts_with("\xff\xfe") || source_.starts_with("\xfe\xff"))
      source_.unsupported("is text in UTF-16", "save it as UTF-8, or: iconv -f UTF-16 -t UTF-8");
    std::size_t at = source_.starts_with("\xef\xbb\xbf") ? 3 : 0;  // the mark that some editors begin a text with
    if (bytes.empty()) return;
    if (std::memchr(bytes.data(), '\n', bytes.size()) == nullptr &&
        std::memchr(bytes.data(), '\r', bytes.size()) != nullptr)
      table_.line_end = '\r';
    std::uint64_t number = 0;
    while (at < bytes.size() && lines_.size() <= kMostHeaderLines) {
      const char* start = bytes.data() + at;
      const void* found = std::memchr(start, table_.line_end, bytes.size() - at);
      const char* end = found != nullptr ? static_cast<const char*>(found) : bytes.data() + bytes.size();
      const Line line{{start, static_cast<std::size_t>(end - start)}, at, ++number};
      at += line.text.size() + (found != nullptr ? 1 : 0);
      all_are_whole_ = found != nullptr && at == bytes.size();
      if (trimmed(line.text).empty()) continue;
      if (const auto comment = comment_of(line.text)) {
        if (!has_rows_) comments_.push_back({*comment, line.offset, line.number});
        if (comments_.size() > kComments) comments_.erase(comments_.begin());
        continue;
      }
      lines_.push_back(line);
      split_cells(line.text, separators_of(line.text).back(), cells_);
      has_rows_ = has_rows_ || (cells_.size() >= 3 && is_row(cells_));
    }
  }

  /// Takes a first line of one whole number for the number of rows; the place of the line behind it.
  std::size_t take_count() {
    if (lines_.empty()) return 0;
    std::uint64_t count = 0;
    if (!parse_count(trimmed(lines_[0].text), count)) return 0;
    table_.declared_rows = count;
    return 1;
  }

  /// Cells of a line for judging it: tabs are blanks.
  const std::vector<std::string_view>& cells_of(const Line& line) {
    split_cells(line.text, separators_of(line.text).back(), cells_);
    return cells_;
  }

  /// Uses the first line that names all columns that are looked for, if the line behind it fits. Lines of numbers may
  /// stand before it as long as they are no rows of the same table.
  bool use_named_header(std::size_t first) {
    for (std::size_t at = first; at < lines_.size(); ++at) {
      if (is_row(cells_of(lines_[at])) && cells_.size() >= 3) continue;
      if (at + 1 == lines_.size()) {
        ColumnNames names = names_of(lines_[at].text, separators_of(lines_[at].text).front());
        if (!wanted_.are_in(names) || has_rows_ || !all_are_whole_) return false;
        table_.names = std::move(names);  // no particle is in the file
        return true;
      }
      const std::optional<Fit> fit = fit_of(lines_[at].text, lines_[at + 1].text);
      if (!fit || !wanted_.are_in(fit->names)) continue;
      if (begins_before(first, at)) return false;
      take_time(first, at);
      begin_rows(at + 1);
      use(*fit);
      return true;
    }
    return false;
  }

  /// Whether there are rows before the line at `header`: of three numbers or more, and not below names of their own.
  bool begins_before(std::size_t first, std::size_t header) {
    for (std::size_t at = first; at < header; ++at) {
      if (!is_row(cells_of(lines_[at])) || cells_.size() < 3) continue;
      if (at == first || is_row(cells_of(lines_[at - 1])) || !fit_of(lines_[at - 1].text, lines_[at].text)) return true;
    }
    return false;
  }

  /// The place of the first line that is a row, when no line names x, y and z.
  std::size_t first_row(std::size_t first) {
    for (std::size_t at = first; at < lines_.size(); ++at) {
      if (!is_row(cells_of(lines_[at]))) continue;
      if (cells_.size() >= 3) return at;
      const bool is_title = table_.declared_rows && at == first && at + 1 < lines_.size();
      if (!is_title) fail(lines_[at], "a line has too few numbers", "x y z");
    }
    if (lines_.empty()) source_.malformed("has no lines of numbers", 0, "x y z");
    fail(lines_.back(), "has no lines of numbers", "x y z");
  }

  void begin_rows(std::size_t at) {
    const Line& row = lines_[at];
    table_.first_row = row.offset;
    table_.separator = separators_of(row.text).back();
    refuse_decimal_commas(row);
    split_cells(row.text, table_.separator, cells_);
    if (cells_.size() > kMostCells) fail(row, "a line has too many columns", fmt::format("at most {}", kMostCells));
    if (table_.separator != kBlanks && cells_.size() > 1 && cells_.back().empty()) cells_.pop_back();
    table_.columns = cells_.size();
    // Chemists' tables begin rows with the name of an element.
    double ignored = 0;
    const bool is_named = table_.declared_rows && read_cell(cells_[0], ignored) == CellKind::text;
    if (is_named) table_.position = {1, 2, 3};
    if (table_.columns < (is_named ? 4u : 3u)) fail(row, "a line has too few numbers", "x y z");
  }

  void refuse_decimal_commas(const Line& row) {
    double ignored = 0;
    const auto is_one = [&](std::string_view cell) { return read_cell(cell, ignored) == CellKind::decimal_comma; };
    split_cells(row.text, table_.separator == ',' ? kBlanks : table_.separator, cells_);
    const bool refused = table_.separator == ','
                             ? cells_.size() >= 3 && std::all_of(cells_.begin(), cells_.end(), is_one)
                             : std::any_of(cells_.begin(), cells_.end(), is_one);
    if (refused) fail(row, "has numbers with decimal commas", "decimal points", kDecimalPoints);
  }

  void name_columns(std::size_t first, std::size_t row) {
    std::optional<Fit> fit;
    if (row > first) {
      const Line& header = lines_[row - 1];
      fit = fit_of(header.text, lines_[row].text);
      if (fit && fit->names.size() < 3) fit.reset();
      if (!fit && wanted_.are_in(names_of(header.text, separators_of(header.text).front())) &&
          separators_of(header.text).front() != kBlanks)
        fail(header, "the column names do not fit the first row",
             fmt::format("{} names, as many as columns", table_.columns));
    }
    for (std::size_t i = comments_.size(); i-- > 0 && !fit;) {
      if (comments_[i].offset > table_.first_row) continue;
      fit = fit_of(comments_[i].text, lines_[row].text);
      // A comment may be any sentence.
      if (fit && !wanted_.are_in(fit->names)) fit.reset();
    }
    if (fit) {
      use(*fit);
      return;
    }
    wanted_.choose(table_);
    if (table_.columns > 3 && table_.names.empty())
      table_.notes.push_back(
          fmt::format("{} columns beside x y z were left out: no header line names them", table_.columns - 3));
  }

  void use(Fit fit) {
    table_.separator = fit.separator;
    table_.columns = fit.names.size();
    table_.names = std::move(fit.names);
    wanted_.choose(table_);
  }

  /// Looks for a time among the lines before the header: in a line of numbers below one of names.
  void take_time(std::size_t first, std::size_t header) {
    for (std::size_t at = first; at + 1 < header; ++at) {
      const std::optional<Fit> fit = fit_of(lines_[at].text, lines_[at + 1].text);
      if (!fit) continue;
      split_cells(lines_[at + 1].text, fit->separator, cells_);
      for (std::size_t i = 0; i < fit->names.size() && i < cells_.size(); ++i) {
        double value = 0;
        if (lower(fit->names[i]).starts_with("time") && parse_number(cells_[i], value)) table_.time = value;
      }
    }
  }

  Source source_;
  WantedColumns wanted_;
  std::vector<Line> lines_;     ///< that are neither empty nor comments
  std::vector<Line> comments_;  ///< without their marks
  bool has_rows_ = false;
  bool all_are_whole_ = false;  ///< the lines are all that are in the file, and the last one has its end
  std::vector<std::string_view> cells_;
  TextTable table_;
};

}  // namespace

TextTable find_table(const Source& source, const ReadOptions& options) { return TableFinder(source, options).find(); }

std::uint64_t line_number(const Source& source, char line_end, std::size_t offset) {
  const char* first = source.bytes.data();
  return 1 + static_cast<std::uint64_t>(std::count(first, first + std::min(offset, source.bytes.size()), line_end));
}

}  // namespace meniscus::io
