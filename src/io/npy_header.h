/// The header of an array in NumPy's format NPY: what each element is, in which order, and how many there are.
#pragma once

#include "io/bytes.h"
#include "io/number_arrays.h"

namespace meniscus::io {

/// A part of an element: the whole of it, or a field of a structured one.
struct NpyField {
  std::string name;                  ///< empty: the whole element
  std::vector<std::uint64_t> shape;  ///< of a field that is an array itself
  std::string type_name;             ///< as NumPy writes it: "<f4"
  std::optional<Scalar> type;        ///< none: no numbers, or of a kind that is not read
  bool half = false;                 ///< a number of 16 bits
  bool object = false;               ///< a pickled Python object
  std::endian order = std::endian::little;
  std::size_t offset = 0;  ///< bytes from the start of the element
  std::size_t size = 0;    ///< bytes of all its numbers
};

struct NpyHeader {
  std::vector<NpyField> fields;
  std::size_t item_size = 0;  ///< bytes of an element
  bool fortran = false;       ///< the first index runs fastest
  std::vector<std::uint64_t> shape;
  std::uint64_t items = 1;  ///< elements: the product of the shape
  std::size_t first = 0;    ///< byte offset of the first element
  bool has_object() const;
};

/// Reads the header at the start of the source; versions 1 to 3. None where the bytes end inside it.
/// @throws Error malformed_file, unsupported: a later version; limit_exceeded: a header of more than 64 KiB
std::optional<NpyHeader> npy_header_of(const Source& source);

}  // namespace meniscus::io
