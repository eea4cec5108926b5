/// Cells of one line of text, between commas, semicolons, tabs or blanks; some may be quoted.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/text.h"

namespace meniscus::io {

/// As a separator: any number of blanks and tabs. The others are ',', ';' and '\t'.
inline constexpr char kBlanks = ' ';

/// Most cells that a line is believed to have.
inline constexpr std::size_t kMostCells = 4096;

/// A blank around cells, which is not what separates them.
inline bool is_padding(char c, char separator) { return is_blank(c) && (separator == kBlanks || c != separator); }

std::string_view trimmed(std::string_view text);

/// The text of a comment line, which starts with #, %, ! or //; none: it is no comment.
std::optional<std::string_view> comment_of(std::string_view line);

/// The end of the cell that starts at `at`: the separator behind it, or `end`. Between quotes nothing separates.
const char* cell_end(const char* at, const char* end, char separator);

/// The cells of a line, without blanks around them and without quotes; at most kMostCells + 1 of them.
/// A line that ends in a separator ends in an empty cell.
void split_cells(std::string_view line, char separator, std::vector<std::string_view>& cells);

/// What a line may be cut at, the likeliest first: semicolons where it has any, then commas, then tabs, then blanks.
std::vector<char> separators_of(std::string_view line);

/// A column's name without its unit: "Pos.x" of "Pos.x [m]", "Time" of "Time (s)"; "v[0]" stays.
std::string without_unit(std::string_view name);

enum class CellKind { number, empty, decimal_comma, text };

/// What a cell without blanks around it holds. Beside usual numbers: quoted ones, those of Fortran (1.5D+03), and
/// a byte below 32, as programs write that take small whole numbers for characters: its code.
CellKind read_cell(std::string_view cell, double& value);

/// The start of some text for a message, in quotes.
std::string shown(std::string_view text);

}  // namespace meniscus::io
