/// Values of an attribute in Houdini's JSON: tuples, arrays of components, or pages of packed parts.
#pragma once

#include "io/houdini_json.h"
#include "io/number_arrays.h"

namespace meniscus::io {

/// Bytes that a file of so many may stand for where its pages are constant: 64 MiB, or 32 times its size where that is
/// more. Attributes that are constant all over take one page in a thousand.
std::uint64_t most_constant_bytes(std::uint64_t file_bytes);

/// What one attribute holds. `array` points into the file, into `owned` or into `parsed`.
struct HoudiniValues {
  NumberArray array;
  Bytes owned;
  std::vector<double> parsed;
};

/// Reads the values of attributes, one after the other.
class HoudiniValueReader {
 public:
  /// @param count  elements that each attribute has a value for
  HoudiniValueReader(HoudiniJson& json, std::uint64_t count) : json_(json), count_(count) {}

  /// The values that come next: ["size", 3, "storage", "fpreal32", "rawpagedata", [...], ...].
  /// @param name  for messages
  /// @throws Error  malformed_file: there are fewer or more than `count` asks for; limit_exceeded: constant pages that
  ///                stand for more than a file of particles would; unsupported: none of the known forms
  HoudiniValues read(const std::string& name);

 private:
  struct Block;
  struct Flat;
  Block block_of();
  std::vector<bool> flags_of();
  std::vector<std::uint64_t> packing_of();
  Flat flat_of(const HoudiniJson::Place& place, std::uint64_t most, std::uint64_t inner = 0);
  Flat flat_of_list(std::uint64_t most, std::uint64_t inner);
  void check_pages(const Block& block, const std::string& name);
  HoudiniValues row_by_row(const Block& block, const Flat& flat, const std::string& name) const;

  HoudiniJson& json_;
  std::uint64_t count_;
  std::uint64_t made_ = 0;  ///< bytes of constant pages so far
};

}  // namespace meniscus::io
