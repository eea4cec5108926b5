/// Rows of binary numbers, as BGEO and PLY have them: all values of a particle, then those of the next.
#pragma once

#include <span>

#include "io/values.h"

namespace meniscus::io {

/// Some values of each row.
struct RowPart {
  Scalar type = Scalar::float32;
  std::size_t offset = 0;  ///< bytes from the start of the row
  std::size_t components = 1;
  float* target = nullptr;  ///< rows * components floats
};

struct RowParts {
  Stored first;            ///< of the first row
  std::size_t stride = 0;  ///< bytes from row to row
  std::span<const RowPart> parts;
};

/// Converts the parts of the rows from `begin` to before `end`, on this thread; `bytes` is the first of row `begin`.
void convert_rows(const RowParts& rows, std::endian order, const char* bytes, std::size_t begin, std::size_t end);

/// Those of all rows, on all threads and piece by piece, so that the bytes come from memory once.
void read_rows(const RowParts& rows, std::endian order, std::size_t count);

}  // namespace meniscus::io
