/// The header of a PLY file.
#pragma once

#include <bit>
#include <optional>

#include "io/bytes.h"
#include "io/values.h"

namespace meniscus::io {

struct PlyProperty {
  std::string name;
  Scalar type = Scalar::float32;
  std::optional<Scalar> list_count_type;  ///< of a list: the type of its length; `type` is that of its items
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  bool has_list() const;
  /// Bytes of one row in a binary file; the least there can be where there are lists.
  std::size_t row_size() const;
};

struct PlyHeader {
  std::optional<double> time;    ///< of a comment "time 0.04", s
  std::optional<float> spacing;  ///< of a comment "spacing 0.02", m
  std::optional<Axis> up;        ///< of a comment "up y"
  bool ascii = false;
  std::endian order = std::endian::little;
  std::vector<PlyElement> elements;
  std::size_t end = 0;  ///< byte offset of the first row
};

/// @throws Error malformed_file, unsupported
PlyHeader read_ply_header(const Source& source);

}  // namespace meniscus::io
