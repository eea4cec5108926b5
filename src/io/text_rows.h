/// Rows of numbers in text, parsed on all threads.
#pragma once

#include "io/text_table.h"

namespace meniscus::io {

struct TextRows {
  std::vector<double> positions;  ///< x y z of each row
  /// One a column, in the table's order; empty for columns that are a position or have no name. NaN: no number.
  std::vector<std::vector<float>> values;
  std::vector<std::uint64_t> missing;  ///< one a column: rows in which it holds no number
};

/// Reads all rows from table.first_row to the end. The result, and which error is thrown (the first in the file), do
/// not depend on the number of threads.
/// @throws Error  malformed_file: a row of more or fewer cells, a coordinate that is no number, a decimal comma
TextRows read_rows(const Source& source, const TextTable& table);

/// Rows between two bytes where lines begin: lines that are neither empty nor comments.
std::uint64_t count_rows(const Source& source, const TextTable& table, std::size_t begin, std::size_t end);

}  // namespace meniscus::io
