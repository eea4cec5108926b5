/// Rows of binary numbers, as BGEO and PLY have them: all values of a particle, then those of the next.
#pragma once

#include "io/values.h"

namespace meniscus::io {

/// Some values of each row.
struct RowPart {
  Scalar type = Scalar::float32;
  std::size_t offset = 0;  ///< bytes from the start of the row
  std::size_t components = 1;
  float* target = nullptr;  ///< rows * components floats
};

/// Converts the parts of all rows, on all threads and block by block, so that the bytes come from memory once.
void read_rows(const char* first, std::size_t stride, std::endian order, std::size_t rows,
               std::span<const RowPart> parts);

}  // namespace meniscus::io
