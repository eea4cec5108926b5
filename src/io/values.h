/// Columns of binary numbers of any type and byte order, as floats.
#pragma once

#include <bit>
#include <optional>

#include "io/bytes.h"
#include "meniscus/base.h"

namespace meniscus::io {

enum class Scalar { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };

std::size_t size_of(Scalar type);

/// Converts `rows` rows of `components` values to floats, on all threads, a piece at a time.
/// @param first    first byte of the first value; need not be aligned
/// @param stride   bytes from row to row
/// @param target   rows * components floats
/// @throws Error   as FileBytes::fetch()
void read_columns(Scalar type, std::endian order, Stored first, std::size_t stride, std::size_t rows,
                  std::size_t components, float* target);

/// The same of what is in memory, on this thread.
void convert_columns(Scalar type, std::endian order, const char* first, std::size_t stride, std::size_t rows,
                     std::size_t components, float* target);

/// One value as a double (exact but for 64-bit integers above 2^53).
double read_value(Scalar type, std::endian order, const char* first);

/// One big-endian 32- or 16-bit number.
std::uint32_t big_endian_32(const char* first);
std::uint16_t big_endian_16(const char* first);

}  // namespace meniscus::io
