/// Files that hold all of a particle, then all of the next, as BGEO and RealFlow's BIN do.
#pragma once

#include <string>

#include "io/rows.h"
#include "meniscus/io.h"

namespace meniscus::io {

/// What stands in each row beside the position.
struct RowValue {
  std::string name;
  Scalar type = Scalar::float32;
  std::size_t offset = 0;  ///< bytes from the start of the row
  std::size_t components = 1;
};

/// Fills the positions, three floats at the start of each row, and adds an attribute for each value. One pass.
/// @param first   of the first row
/// @param stride  bytes from row to row
/// @throws Error  as FileBytes::fetch()
void set_rows(Stored first, std::size_t stride, std::size_t count, std::endian order, std::span<const RowValue> values,
              const ReadOptions& options, Particles& particles);

}  // namespace meniscus::io
