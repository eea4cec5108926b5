/// Arrays of numbers under names, as NPZ, NPY and HDF5 have them: which are the positions, and the rest as attributes.
#pragma once

#include "io/positions.h"

namespace meniscus::io {

/// An array of a file. Row i of column c stands at first + i * stride + c * step, once that is known.
struct NumberArray {
  std::string name;
  std::vector<std::uint64_t> shape;  ///< empty: a single value
  std::optional<Scalar> type;        ///< none: not numbers, or not of a kind that is read
  std::endian order = std::endian::native;
  std::string type_name;  ///< for messages: "float32"
  Stored first;
  std::size_t stride = 0;
  std::size_t step = 0;

  /// Of an array of one dimension or two; none for others and for what holds no numbers.
  std::optional<std::uint64_t> rows() const;
  std::size_t columns() const;  ///< 1 for one dimension
  Column column(std::size_t c) const { return {first + c * step, stride}; }
};

/// Where the positions are in a list of arrays.
struct PositionArrays {
  std::vector<std::size_t> places;  ///< of one array of three columns or more, or of three of one column
  std::uint64_t count = 0;          ///< particles
  bool guessed = false;             ///< by its shape alone
};

/// By the usual names: x y z, one of three columns called positions, pos, Coordinates ..., three that belong together
/// (pos_x ...); else the only array of three columns, if there is no other.
std::optional<PositionArrays> find_positions(std::span<const NumberArray> arrays);

/// Those that options.positions names, or that are found.
/// @throws Error invalid_argument: no such array, or not of a fitting shape; unsupported: nothing looks like positions.
///               The message lists the arrays that there are
PositionArrays choose_positions(std::span<const NumberArray> arrays, const ReadOptions& options,
                                const std::string& path);

/// Those at the places that the user named: one or three.
/// @throws Error invalid_argument: they do not fit each other
PositionArrays asked_positions(std::span<const NumberArray> arrays, std::vector<std::size_t> places,
                               const std::string& path);

/// "x,y,z" at the commas, without blanks around.
std::vector<std::string> split_names(std::string_view names);

/// "x (7 float32), v (7 x 3 float64)", the first dozen: for messages.
std::string list_of(std::span<const NumberArray> arrays);

/// "numpy's" name of a type: "float32".
std::string_view name_of(Scalar type);

/// The positions; where the arrays stand is known.
void set_positions(std::span<const NumberArray> arrays, const PositionArrays& found, const ReadOptions& options,
                   Particles& particles);

/// An array of rows() and columns() as an attribute; where it stands is known.
Attribute attribute_of(const NumberArray& array);

/// Every array that is not among the positions as an attribute; one note on those that cannot be.
void add_attributes(std::span<const NumberArray> arrays, const PositionArrays& found, Particles& particles);

/// Why an array is no attribute of `count` particles, "has 3 values for 7 particles"; empty: it is one.
std::string why_no_attribute(const NumberArray& array, std::uint64_t count);

}  // namespace meniscus::io
