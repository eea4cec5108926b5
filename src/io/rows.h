/// Rows of binary numbers, as BGEO and PLY have them: all values of a particle, then those of the next.
#pragma once

#include <span>

#include "io/values.h"

namespace meniscus::io {

constexpr std::size_t kRowsAtOnce = 4096;  ///< of a block that one thread converts: its bytes stay in the cache

/// Some values of each row.
struct RowPart {
  Scalar type = Scalar::float32;
  std::size_t offset = 0;  ///< bytes from the start of the row
  std::size_t components = 1;
  float* target = nullptr;  ///< rows * components floats
};

struct RowParts {
  const char* first = nullptr;  ///< of the first row
  std::size_t stride = 0;       ///< bytes from row to row
  std::span<const RowPart> parts;
};

/// Converts the parts of the rows from `begin` to before `end`, on this thread.
void read_rows(const RowParts& rows, std::endian order, std::size_t begin, std::size_t end);

/// Those of all rows, on all threads and block by block, so that the bytes come from memory once.
void read_rows(const RowParts& rows, std::endian order, std::size_t count);

}  // namespace meniscus::io
