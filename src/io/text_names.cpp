#include "io/text_names.h"

#include <fmt/format.h>

#include <algorithm>

#include "io/attributes.h"

namespace meniscus::io {
namespace {

/// Names and numbers of components of an extended .xyz title: "pos:R:3" names three columns pos:0, pos:1, pos:2.
ColumnNames names_of_properties(std::string_view title) {
  ColumnNames names;
  std::string_view list = title.substr(title.find('=') + 1);
  list = list.substr(0, list.find_first_of(" \t\""));
  while (!list.empty() && names.size() <= kMostCells) {
    std::array<std::string_view, 3> parts;
    for (std::string_view& part : parts) {
      const std::size_t end = list.find(':');
      part = list.substr(0, end);
      list.remove_prefix(end == std::string_view::npos ? list.size() : end + 1);
    }
    std::uint64_t components = 0;
    if (!parse_count(parts[2], components) || components == 0 || components > kMostCells) return {};
    for (std::uint64_t c = 0; c < components; ++c)
      names.push_back(components == 1 ? std::string(parts[0]) : fmt::format("{}:{}", parts[0], c));
  }
  return names;
}

/// Which column of the position a name stands for, or none.
std::optional<std::size_t> axis_of(std::string_view name) {
  const std::optional<Component> component = component_of(name);
  if (!component || component->base != "position") return std::nullopt;
  return static_cast<std::size_t>(component->index);
}

std::array<std::optional<std::size_t>, 3> axes_of(const ColumnNames& names) {
  std::array<std::optional<std::size_t>, 3> axes;
  for (std::size_t i = 0; i < names.size(); ++i)
    if (const auto axis = axis_of(names[i]); axis && !axes[*axis]) axes[*axis] = i;
  return axes;
}

std::optional<std::size_t> place_of(const ColumnNames& names, std::string_view wanted) {
  const std::string plain = lower(without_unit(wanted));
  for (std::size_t i = 0; i < names.size(); ++i)
    if (lower(names[i]) == plain) return i;
  return std::nullopt;
}

/// The columns there are, for messages.
std::string listed(const TextTable& table) {
  constexpr std::size_t kMost = 40;
  if (table.names.empty()) return fmt::format("{} columns without names", table.columns);
  std::string list;
  for (std::size_t i = 0; i < std::min(table.names.size(), kMost); ++i)
    list += fmt::format("{}{} {}", i == 0 ? "" : ", ", i + 1, table.names[i]);
  return table.names.size() > kMost ? list + " ..." : list;
}

}  // namespace

ColumnNames names_of(std::string_view header, char separator) {
  if (const std::size_t at = header.find("Properties="); at != std::string_view::npos)
    return names_of_properties(header.substr(at));
  std::vector<std::string_view> cells;
  split_cells(header, separator, cells);
  while (!cells.empty() && cells.back().empty()) cells.pop_back();
  ColumnNames names;
  char closing = '\0';  // of a unit that stands between blanks, as a word of its own
  for (const std::string_view cell : cells) {
    if (separator == kBlanks && closing == '\0' && !names.empty() && (cell[0] == '[' || cell[0] == '('))
      closing = cell[0] == '[' ? ']' : ')';
    if (closing == '\0') names.push_back(without_unit(cell));
    if (closing != '\0' && cell.ends_with(closing)) closing = '\0';
  }
  return names;
}

std::optional<Fit> fit_of(std::string_view header, std::string_view row) {
  const bool is_title = header.find("Properties=") != std::string_view::npos;
  std::vector<std::string_view> cells;
  for (const char separator : separators_of(row)) {
    split_cells(row, separator, cells);
    const bool ends_in_separator = cells.size() > 1 && cells.back().empty();
    for (const char header_separator : is_title ? std::vector<char>{kBlanks} : separators_of(header)) {
      // Between tabs cells may be empty, which is only clear where the names stand between tabs, too.
      if (separator == '\t' && header_separator != '\t') continue;
      ColumnNames names = names_of(header, header_separator);
      if (names.size() > kMostCells) continue;
      if (names.size() == cells.size() || (ends_in_separator && names.size() + 1 == cells.size()))
        return Fit{std::move(names), separator};
    }
  }
  return std::nullopt;
}

WantedColumns::WantedColumns(const Source& source, const ReadOptions& options)
    : source_(source), columns_(options.columns) {
  if (!columns_.empty() && columns_.size() != 3)
    throw Error(ErrorCode::invalid_argument, {"the columns of the position are not three",
                                              "the columns of x, y and z: --columns x,y,z or 4,5,6",
                                              fmt::format("{} columns", columns_.size()),
                                              source.path,
                                              {},
                                              {},
                                              {}});
}

bool WantedColumns::are_in(const ColumnNames& names) const {
  if (!columns_.empty() && std::all_of(columns_.begin(), columns_.end(),
                                       [&](const std::string& wanted) { return place_of(names, wanted).has_value(); }))
    return true;
  const auto axes = axes_of(names);
  return axes[0] && axes[1] && axes[2];
}

std::size_t WantedColumns::chosen(const std::string& wanted, const TextTable& table) const {
  if (const auto place = place_of(table.names, wanted)) return *place;
  std::uint64_t number = 0;
  if (parse_count(wanted, number) && number >= 1 && number <= table.columns) return number - 1;
  throw Error(ErrorCode::invalid_argument,
              {fmt::format("there is no column '{}'", wanted), listed(table), {}, source_.path, {}, {}, {}});
}

void WantedColumns::choose(TextTable& table) const {
  if (columns_.empty()) {
    choose_by_name(table);
    return;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) table.position[axis] = chosen(columns_[axis], table);
  const auto& [x, y, z] = table.position;
  if (x == y || y == z || z == x)
    throw Error(ErrorCode::invalid_argument, {"two coordinates are to be read from the same column",
                                              listed(table),
                                              fmt::format("{}, {}, {}", columns_[0], columns_[1], columns_[2]),
                                              source_.path,
                                              {},
                                              {},
                                              {}});
}

void WantedColumns::choose_by_name(TextTable& table) const {
  if (table.names.empty()) return;
  const auto axes = axes_of(table.names);
  if (axes[0] && axes[1] && axes[2]) {
    for (std::size_t axis = 0; axis < 3; ++axis) table.position[axis] = *axes[axis];
    return;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (axes[axis] || !(axes[(axis + 1) % 3] || axes[(axis + 2) % 3])) continue;
    throw Error(ErrorCode::malformed_file,
                {fmt::format("its header names no column for {}", name_of(static_cast<Axis>(axis))),
                 "x, y and z",
                 listed(table),
                 source_.path,
                 {},
                 {},
                 "name them: --columns x,y,z, or by their numbers"});
  }
  table.notes.push_back(fmt::format("its header names no x, y, z: the columns {}, {}, {} were taken", table.names[0],
                                    table.names[1], table.names[2]));
}

}  // namespace meniscus::io
