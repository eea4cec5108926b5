/// Names of the columns of a table in text, and which columns are the position.
#pragma once

#include "io/text_table.h"

namespace meniscus::io {

inline constexpr const char* kDecimalPoints = "write the numbers with decimal points";

using ColumnNames = std::vector<std::string>;

/// The names in a header line, without quotes and units. A separator at its end is no name. Extended .xyz titles
/// ("Properties=species:S:1:pos:R:3") name columns, too.
ColumnNames names_of(std::string_view header, char separator);

/// Names and the separator of rows with which there is one for each column.
struct Fit {
  ColumnNames names;
  char separator = kBlanks;
};

/// Cuts a header and the row below it so that both have as many columns; none: they do not fit. A row may have a
/// separator behind its last cell.
std::optional<Fit> fit_of(std::string_view header, std::string_view row);

/// The columns that are the position: as the options say, else by the usual names.
class WantedColumns {
 public:
  /// @throws Error  invalid_argument: options.columns are not three
  WantedColumns(const Source& source, const ReadOptions& options);

  /// Whether the names are those of x, y and z, or all those that the options ask for.
  bool are_in(const ColumnNames& names) const;
  /// Sets table.position from its names or from the options.
  /// @throws Error  invalid_argument: the options ask for columns that are not there; malformed_file: x is named, but
  ///                not y, say
  void choose(TextTable& table) const;

 private:
  std::size_t chosen(const std::string& wanted, const TextTable& table) const;
  void choose_by_name(TextTable& table) const;
  Source source_;
  const std::vector<std::string>& columns_;
};

}  // namespace meniscus::io
