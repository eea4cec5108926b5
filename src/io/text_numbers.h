/// Many numbers between blanks, parsed on all threads.
#pragma once

#include "io/bytes.h"

namespace meniscus::io {

struct TextNumbers {
  std::size_t count = 0;  ///< numbers read; fewer than asked for where the text ends
  std::size_t end = 0;    ///< byte offset behind the last one
};

/// Reads numbers from the text in [begin, end) of a source, as many as there are or as `target` holds.
/// The result, and which error is thrown (the first in the file), do not depend on the number of threads.
/// @param what  "points": what they are, for messages
/// @throws Error  malformed_file: a word that is no number
TextNumbers read_numbers(const Source& source, std::size_t begin, std::size_t end, std::span<float> target,
                         std::string_view what);
TextNumbers read_numbers(const Source& source, std::size_t begin, std::size_t end, std::span<double> target,
                         std::string_view what);

}  // namespace meniscus::io
