/// Arrays of NumPy's format NPY in memory, as named arrays of numbers.
#pragma once

#include <deque>

#include "io/npy_header.h"

namespace meniscus::io {

struct NpyArrays {
  std::vector<NumberArray> arrays;
  std::deque<Bytes> widened;         ///< numbers of 16 bits, as floats
  std::vector<std::string> objects;  ///< names of what holds pickled objects
};

/// Adds the array at the start of the source: one, or each field of a structured one under its own name.
/// The source must outlive the arrays.
/// @throws Error malformed_file: damaged, or shorter than its header says; what npy_header_of() throws
void add_npy(const Source& source, const std::string& name, NpyArrays& to);

/// The particles that arrays hold: positions by options or by the usual names, the rest as attributes; single values
/// called time, spacing and up are those of the frame.
/// @throws Error unsupported: pickled objects, which are never read, in place of positions; what choose_positions()
///               throws
Particles particles_of(const NpyArrays& arrays, const ReadOptions& options, const std::string& path);

/// "NumPy's" header and the bytes before it for an array of float32 or float64 in C order.
std::string npy_header(std::string_view type, std::span<const std::uint64_t> shape);

}  // namespace meniscus::io
