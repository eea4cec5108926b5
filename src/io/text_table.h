/// A table of numbers in text: where its rows begin, what its columns are called, and which of them are x, y and z.
#pragma once

#include <array>

#include "io/text_cells.h"
#include "meniscus/io.h"

namespace meniscus::io {

struct TextTable {
  std::size_t first_row = 0;  ///< byte where the first row begins; the size of the file where there is none
  char line_end = '\n';       ///< or '\r', which old programs end lines with
  char separator = kBlanks;
  std::size_t columns = 0;                       ///< cells a row; 0: there are no rows
  std::vector<std::string> names;                ///< of the columns, without units; empty: nothing names them
  std::array<std::size_t, 3> position{0, 1, 2};  ///< the columns of x, y and z
  std::optional<std::uint64_t> declared_rows;    ///< as a first line of one whole number says
  std::optional<double> time;                    ///< s
  std::vector<std::string> notes;

  /// Numbers that are kept of a row: its position, and all columns if they have names.
  std::size_t kept() const { return names.empty() ? 3 : columns; }
};

/// Understands what stands before the first row: comments, titles, a number of rows, lines of names (the last, or the
/// first that names x, y and z), and the first row itself.
/// @param source  all of the file, or its beginning
/// @throws Error  malformed_file: no rows, a header that does not fit them, decimal commas; invalid_argument:
///                options.columns names columns that are not there
TextTable find_table(const Source& source, const ReadOptions& options);

/// The number of the line, from 1, that the byte at `offset` is in.
std::uint64_t line_number(const Source& source, char line_end, std::size_t offset);

}  // namespace meniscus::io
