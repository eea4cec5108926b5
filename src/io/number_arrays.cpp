#include "io/number_arrays.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "io/attributes.h"
#include "io/file_bytes.h"
#include "io/text.h"
#include "io/unwritten.h"

namespace meniscus::io {
namespace {

constexpr std::size_t kMostColumns = 256;   ///< of an attribute
constexpr std::size_t kColumnRows = 16384;  ///< rows of one column after another that one thread converts
constexpr std::array<std::string_view, 10> kNames{"positions", "position", "pos",   "coordinates", "coords",
                                                  "coord",     "points",   "point", "xyz",         "p"};

bool is_single(const NumberArray& array) { return array.rows() && array.shape.size() == 1; }
bool is_triple(const NumberArray& array) { return array.rows() && array.shape.size() == 2 && array.columns() == 3; }

/// Places of the three single arrays that `component` says are x, y and z of a position.
template <class ComponentOf>
std::vector<std::size_t> singles(std::span<const NumberArray> arrays, ComponentOf component) {
  std::vector<std::size_t> of_x;
  std::map<std::uint64_t, std::size_t> of_y, of_z;  // the first of each length
  for (std::size_t i = 0; i < arrays.size(); ++i) {
    if (!is_single(arrays[i])) continue;
    const std::optional<Component> found = component(arrays[i].name);
    if (!found || found->base != "position") continue;
    if (found->index == 0) {
      of_x.push_back(i);
    } else {
      (found->index == 1 ? of_y : of_z).try_emplace(*arrays[i].rows(), i);
    }
  }
  for (const std::size_t x : of_x) {
    const auto y = of_y.find(*arrays[x].rows()), z = of_z.find(*arrays[x].rows());
    if (y != of_y.end() && z != of_z.end()) return {x, y->second, z->second};
  }
  return {};
}

}  // namespace

std::optional<std::uint64_t> NumberArray::rows() const {
  if (!type || shape.empty() || shape.size() > 2) return std::nullopt;
  return shape[0];
}

std::size_t NumberArray::columns() const { return shape.size() == 2 ? static_cast<std::size_t>(shape[1]) : 1; }

std::optional<PositionArrays> find_positions(std::span<const NumberArray> arrays) {
  const auto plain_axis = [](std::string_view name) -> std::optional<Component> {
    if (name.size() != 1) return std::nullopt;
    return component_of(name);
  };
  if (std::vector<std::size_t> places = singles(arrays, plain_axis); !places.empty()) {
    const std::uint64_t count = *arrays[places[0]].rows();
    return PositionArrays{std::move(places), count};
  }
  for (const std::string_view name : kNames)
    for (std::size_t i = 0; i < arrays.size(); ++i)
      if (is_triple(arrays[i]) && lower(arrays[i].name) == name) return PositionArrays{{i}, *arrays[i].rows()};
  if (std::vector<std::size_t> places = singles(arrays, component_of); !places.empty()) {
    const std::uint64_t count = *arrays[places[0]].rows();
    return PositionArrays{std::move(places), count};
  }
  std::vector<std::size_t> triples;
  for (std::size_t i = 0; i < arrays.size(); ++i)
    if (is_triple(arrays[i])) triples.push_back(i);
  if (triples.size() != 1 || common_name(arrays[triples[0]].name, 3) == "velocity") return std::nullopt;
  return PositionArrays{triples, *arrays[triples[0]].rows(), true};
}

PositionArrays asked_positions(std::span<const NumberArray> arrays, std::vector<std::size_t> places,
                               const std::string& path) {
  std::vector<NumberArray> chosen;
  for (const std::size_t place : places) chosen.push_back(arrays[place]);
  const bool fits = places.size() == 1
                        ? chosen[0].rows() && chosen[0].columns() >= 3
                        : places.size() == 3 && std::all_of(chosen.begin(), chosen.end(), [&](const NumberArray& a) {
                            return is_single(a) && a.rows() == chosen[0].rows();
                          });
  if (!fits)
    throw Error(ErrorCode::invalid_argument,
                {"these arrays are no positions", "one array of N x 3 numbers, or three of N, separated by commas",
                 list_of(chosen), path, std::nullopt, std::nullopt, "name others with --positions"});
  return {std::move(places), *chosen[0].rows()};
}

PositionArrays choose_positions(std::span<const NumberArray> arrays, const ReadOptions& options,
                                const std::string& path) {
  if (options.positions.empty()) {
    if (std::optional<PositionArrays> found = find_positions(arrays)) return *std::move(found);
    throw Error(ErrorCode::unsupported,
                {"none of its arrays looks like positions", "x, y and z, or one of N x 3 called positions or pos",
                 list_of(arrays), path, std::nullopt, std::nullopt, "name them with --positions NAME or X,Y,Z"});
  }
  std::vector<std::size_t> places;
  for (const std::string& name : split_names(options.positions)) {
    const auto found = std::find_if(arrays.begin(), arrays.end(), [&](const NumberArray& a) { return a.name == name; });
    if (found == arrays.end())
      throw Error(ErrorCode::invalid_argument, {fmt::format("has no array '{}'", name),
                                                {},
                                                list_of(arrays),
                                                path,
                                                std::nullopt,
                                                std::nullopt,
                                                "name one of these with --positions"});
    places.push_back(static_cast<std::size_t>(found - arrays.begin()));
  }
  return asked_positions(arrays, std::move(places), path);
}

std::vector<std::string> split_names(std::string_view names) {
  std::vector<std::string> parts;
  while (true) {
    const std::size_t comma = names.find(',');
    std::string_view part = names.substr(0, comma);
    while (!part.empty() && is_blank(part.front())) part.remove_prefix(1);
    while (!part.empty() && is_blank(part.back())) part.remove_suffix(1);
    parts.emplace_back(part);
    if (comma == std::string_view::npos) return parts;
    names.remove_prefix(comma + 1);
  }
}

std::string list_of(std::span<const NumberArray> arrays) {
  constexpr std::size_t kMost = 12;
  std::string list;
  for (std::size_t i = 0; i < std::min(kMost, arrays.size()); ++i) {
    std::string shape;
    for (const std::uint64_t length : arrays[i].shape) shape += fmt::format("{}{}", shape.empty() ? "" : " x ", length);
    list += fmt::format("{}{} ({}{}{})", i > 0 ? ", " : "", arrays[i].name.substr(0, 60), shape,
                        shape.empty() ? "" : " ", arrays[i].type_name.substr(0, 40));
  }
  if (arrays.size() > kMost) list += fmt::format(" and {} more", arrays.size() - kMost);
  return list.empty() ? "no arrays" : list;
}

std::string_view name_of(Scalar type) {
  constexpr std::array<std::string_view, 10> kTypes{"int8",   "uint8", "int16",  "uint16",  "int32",
                                                    "uint32", "int64", "uint64", "float32", "float64"};
  return kTypes[static_cast<std::size_t>(type)];
}

void set_positions(std::span<const NumberArray> arrays, const PositionArrays& found, const ReadOptions& options,
                   Particles& particles) {
  const auto rows = static_cast<std::size_t>(found.count);
  const NumberArray& x = arrays[found.places[0]];
  if (found.places.size() == 1) {
    set_positions(*x.type, x.order, {x.column(0), x.column(1), x.column(2)}, rows, options, particles);
    return;
  }
  const NumberArray &y = arrays[found.places[1]], &z = arrays[found.places[2]];
  if (x.type == y.type && x.type == z.type && x.order == y.order && x.order == z.order) {
    set_positions(*x.type, x.order, {x.column(0), y.column(0), z.column(0)}, rows, options, particles);
    return;
  }
  // Columns of different types: as doubles.
  std::vector<double> values(3 * rows);
  for (std::size_t c = 0; c < 3; ++c) {
    const NumberArray& array = arrays[found.places[c]];
    const Scalar type = *array.type;
    for_each_piece(array.first, array.stride, size_of(type), rows,
                   [&](std::size_t begin, std::size_t end, const char* bytes) {
                     for (std::size_t i = begin; i < end; ++i)
                       values[3 * i + c] = read_value(type, array.order, bytes + (i - begin) * array.stride);
                   });
  }
  set_positions(values, options, particles);
}

Attribute attribute_of(const NumberArray& array) {
  const auto rows = static_cast<std::size_t>(array.rows().value_or(0));
  const std::size_t columns = array.columns();
  Attribute attribute{array.name, static_cast<int>(columns), {}};
  resize_unwritten(attribute.values, rows * columns);
  float* target = attribute.values.data();
  if (columns == 1 || array.step == size_of(*array.type)) {
    read_columns(*array.type, array.order, array.first, array.stride, rows, columns, target);
    return attribute;
  }
  // Column after column, as Fortran stores them.
  PieceBuffers buffers;
  parallel_for(rows, kColumnRows, [&](std::size_t begin, std::size_t end) {
    PieceBuffers::Lease buffer(buffers);
    std::array<float, kColumnRows> one;
    for (std::size_t c = 0; c < columns; ++c) {
      const char* bytes = buffer->bytes(array.first + c * array.step + begin * array.stride,
                                        (end - begin - 1) * array.stride + size_of(*array.type));
      convert_columns(*array.type, array.order, bytes, array.stride, end - begin, 1, one.data());
      for (std::size_t i = begin; i < end; ++i) target[i * columns + c] = one[i - begin];
    }
  });
  return attribute;
}

void add_attributes(std::span<const NumberArray> arrays, const PositionArrays& found, Particles& particles) {
  std::string left_out;
  std::size_t more = 0;
  std::vector<std::size_t> taken;
  for (std::size_t i = 0; i < arrays.size(); ++i) {
    if (std::find(found.places.begin(), found.places.end(), i) != found.places.end()) continue;
    const std::string why = why_no_attribute(arrays[i], found.count);
    if (why.empty()) {
      taken.push_back(i);
    } else if (left_out.size() > 200) {
      ++more;
    } else {
      left_out += fmt::format("{}'{}' {}", left_out.empty() ? "" : ", ", arrays[i].name.substr(0, 60), why);
    }
  }
  const std::size_t before = particles.attributes.size();
  particles.attributes.resize(before + taken.size());
  parallel_for(taken.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) particles.attributes[before + i] = attribute_of(arrays[taken[i]]);
  });
  if (left_out.empty()) return;
  particles.notes.push_back(
      fmt::format("left out arrays: {}{}", left_out, more > 0 ? fmt::format(" and {} more", more) : ""));
}

std::string why_no_attribute(const NumberArray& array, std::uint64_t count) {
  if (!array.type) return fmt::format("is of type {}", array.type_name.substr(0, 40));
  const std::optional<std::uint64_t> rows = array.rows();
  if (!rows) return fmt::format("has {} dimensions", array.shape.size());
  if (*rows != count) return fmt::format("has {} values for {} particles", *rows, count);
  if (array.columns() < 1 || array.columns() > kMostColumns) return fmt::format("has {} columns", array.columns());
  return {};
}

}  // namespace meniscus::io
