#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "io/attributes.h"
#include "io/frame_head.h"
#include "io/readers.h"
#include "io/text.h"

namespace meniscus::io {
namespace {

constexpr int kMostHeaderLines = 32;

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::string_view unquoted(std::string_view cell) {
  cell = trimmed(cell);
  if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"') return cell.substr(1, cell.size() - 2);
  return cell;
}

/// The cells of a line: between commas or semicolons if it has any, else between blanks. A separator at the
/// end of the line is no cell.
void split(std::string_view line, std::vector<std::string_view>& cells) {
  cells.clear();
  const std::size_t first = line.find_first_of(",;");
  if (first == std::string_view::npos) {
    std::size_t at = 0;
    while (true) {
      while (at < line.size() && is_blank(line[at])) ++at;
      if (at == line.size()) return;
      const std::size_t start = at;
      while (at < line.size() && !is_blank(line[at])) ++at;
      cells.push_back(line.substr(start, at - start));
    }
  }
  const char separator = line[first];
  while (true) {
    const std::size_t end = line.find(separator);
    const std::string_view cell = unquoted(line.substr(0, end));
    if (end == std::string_view::npos) {
      if (!cell.empty()) cells.push_back(cell);
      return;
    }
    cells.push_back(cell);
    line.remove_prefix(end + 1);
  }
}

/// The text of a comment line, or none.
std::optional<std::string_view> comment_of(std::string_view line) {
  if (line.starts_with('#') || line.starts_with('%') || line.starts_with('!')) return trimmed(line.substr(1));
  if (line.starts_with("//")) return trimmed(line.substr(2));
  return std::nullopt;
}

/// Which columns are the position, and the names of the others.
struct Columns {
  std::array<std::size_t, 3> position{0, 1, 2};
  std::vector<std::string> names;  ///< one a column, or none
};

/// The columns that a header names; none unless it has a name for each column.
std::optional<Columns> columns_of(std::string_view header, std::size_t count, bool is_comment) {
  std::vector<std::string_view> names;
  split(header, names);
  if (names.size() != count) return std::nullopt;
  Columns columns;
  std::array<bool, 3> found{};
  for (std::size_t i = 0; i < count; ++i) {
    columns.names.emplace_back(names[i]);
    const std::optional<Component> component = component_of(names[i]);
    if (!component || component->base != "position") continue;
    const auto axis = static_cast<std::size_t>(component->index);
    if (!found[axis]) columns.position[axis] = i;
    found[axis] = true;
  }
  if (found[0] && found[1] && found[2]) return columns;
  // A comment may be any sentence; a header line without x, y, z names the columns after the first three.
  if (is_comment || found[0] || found[1] || found[2]) return std::nullopt;
  return columns;
}

class XyzReader {
 public:
  explicit XyzReader(const Source& source) : source_(source), text_(source) {}

  Particles read() {
    particles_.format = "xyz";
    if (source_.starts_with("\xef\xbb\xbf")) text_.seek(3);  // the mark that some editors begin a text with
    if (find_first_row()) {
      name_columns();
      read_rows();
      check_count();
      move_columns();
    }
    return std::move(particles_);
  }

  /// Judges the number of rows from the length of those that are there.
  void look(FrameHead& head) {
    head.format = "xyz";
    head.text = true;
    if (source_.starts_with("\xef\xbb\xbf")) text_.seek(3);
    if (!find_first_row()) {
      head.counted = true;  // there are none
      return;
    }
    const std::size_t first = text_.at();
    name_columns();
    head.values = static_cast<double>(values_.size());
    const std::string_view rows(source_.bytes.data() + first, source_.bytes.size() - first);
    const std::size_t last = rows.find_last_of('\n');
    const std::size_t whole = last == std::string_view::npos ? rows.size() : last + 1;
    const auto count = static_cast<double>(
        std::max<std::ptrdiff_t>(std::count(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(whole), '\n'), 1));
    const double left = static_cast<double>(head.plain_bytes) - static_cast<double>(first);
    head.particles = static_cast<std::uint64_t>(std::max(left * count / static_cast<double>(whole) + 0.5, 1.0));
    head.counted = whole == static_cast<std::size_t>(left);
  }

 private:
  [[noreturn]] void fail(std::string problem, std::string expected, std::string_view found) const {
    std::string shown(found.substr(0, 40));
    for (char& c : shown) {
      if (c < ' ' || c > '~') c = '?';
    }
    throw Error(ErrorCode::malformed_file, {std::move(problem), std::move(expected), "'" + shown + "'", source_.path,
                                            std::nullopt, line_number_, "a line is: x y z, and further columns"});
  }

  std::string_view next_line() {
    ++line_number_;
    return trimmed(text_.line());
  }

  /// Moves to the first line of numbers, remembering comments and other lines before it.
  bool find_first_row() {
    int other_lines = 0;
    while (!text_.at_end()) {
      const std::size_t start = text_.at();
      const std::string_view line = next_line();
      if (line.empty()) continue;
      if (const auto comment = comment_of(line)) {
        comments_.assign(1, std::string(*comment));
        continue;
      }
      split(line, cells_);
      float first = 0;
      if (!cells_.empty() && parse_number(cells_[0], first)) {
        if (cells_.size() == 1 && !declared_count_ && parse_count(cells_[0], declared_count_.emplace())) continue;
        if (cells_.size() < 3) fail("a line has too few numbers", "x y z", line);
        row_length_ = line.size() + 1;
        ends_in_separator_ = line.back() == ',' || line.back() == ';';
        text_.seek(start);
        --line_number_;
        return true;
      }
      if (++other_lines > kMostHeaderLines) fail("has no lines of numbers", "x y z", line);
      header_ = std::string(line);
    }
    if (other_lines > 0) fail("has no lines of numbers", "x y z", header_);
    return false;
  }

  void name_columns() {
    std::optional<Columns> columns;
    if (!header_.empty()) columns = columns_of(header_, cells_.size(), false);
    if (!columns && ends_in_separator_) {
      // What looked like a separator at the line's end is an empty last cell if the header has a name for it.
      columns = columns_of(header_, cells_.size() + 1, false);
      if (columns) cells_.emplace_back();
    }
    const std::size_t count = cells_.size();
    if (!columns && !comments_.empty()) columns = columns_of(comments_[0], count, true);
    if (columns) columns_ = std::move(*columns);
    if (columns_.names.empty() && count > 3) {
      particles_.notes.push_back(
          fmt::format("{} columns after x y z were left out: no header line names them", count - 3));
    }
    const std::size_t kept = columns_.names.empty() ? 3 : count;
    values_.resize(kept);
    const std::size_t rows = (source_.bytes.size() - text_.at()) / row_length_ + 1;
    for (auto& column : values_) column.reserve(rows);
  }

  void read_rows() {
    const std::size_t count = cells_.size();
    while (!text_.at_end()) {
      const std::string_view line = next_line();
      if (line.empty() || comment_of(line)) continue;
      split(line, cells_);
      // Empty cells at the end of a line are no cells to split(); they are missing values here.
      if (line.back() == ',' || line.back() == ';') cells_.resize(std::max(count, cells_.size()));
      if (cells_.size() != count) {
        fail(fmt::format("a line has {} columns", cells_.size()), fmt::format("{} as the first line has", count), line);
      }
      for (std::size_t c = 0; c < values_.size(); ++c) {
        float value = std::numeric_limits<float>::quiet_NaN();
        if (!parse_number(cells_[c], value) && is_position(c)) fail("a coordinate is no number", "a number", cells_[c]);
        values_[c].push_back(value);
      }
    }
  }

  bool is_position(std::size_t column) const {
    return std::find(columns_.position.begin(), columns_.position.end(), column) != columns_.position.end();
  }

  void check_count() {
    if (!declared_count_) return;
    const std::uint64_t rows = values_[0].size();
    if (rows < *declared_count_) {
      throw Error(ErrorCode::malformed_file, {"the file ends inside its rows",
                                              fmt::format("{} rows as its first line says", *declared_count_),
                                              fmt::format("{}", rows),
                                              source_.path,
                                              std::nullopt,
                                              line_number_,
                                              {}});
    }
    if (rows > *declared_count_) {
      particles_.notes.push_back(
          fmt::format("has {} rows although its first line says {}; all are read", rows, *declared_count_));
    }
  }

  void move_columns() {
    particles_.x = std::move(values_[columns_.position[0]]);
    particles_.y = std::move(values_[columns_.position[1]]);
    particles_.z = std::move(values_[columns_.position[2]]);
    for (std::size_t c = 0; c < columns_.names.size(); ++c) {
      if (is_position(c)) continue;
      if (std::all_of(values_[c].begin(), values_[c].end(), [](float v) { return std::isnan(v); })) {
        particles_.notes.push_back(fmt::format("column '{}' holds no numbers and was left out", columns_.names[c]));
        continue;
      }
      particles_.attributes.push_back({columns_.names[c], 1, std::move(values_[c])});
    }
  }

  Source source_;
  TextCursor text_;
  std::uint64_t line_number_ = 0;
  std::string header_;
  std::vector<std::string> comments_;
  std::optional<std::uint64_t> declared_count_;
  std::size_t row_length_ = 1;
  bool ends_in_separator_ = false;
  Columns columns_;
  std::vector<std::string_view> cells_;
  std::vector<std::vector<float>> values_;
  Particles particles_;
};

}  // namespace

Particles read_xyz(const Source& source, const ReadOptions& /*options*/) { return XyzReader(source).read(); }

void look_at_xyz(const Source& start, FrameHead& head) { XyzReader(start).look(head); }

}  // namespace meniscus::io
