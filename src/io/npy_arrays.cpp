#include "io/npy_arrays.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "io/half.h"

namespace meniscus::io {
namespace {

/// Where the rows and columns of an array of at most two dimensions stand.
void lay_out(NumberArray& array, const NpyHeader& header, const NpyField& field) {
  const std::size_t outer = header.shape.size(), inner = field.shape.size();
  if (outer == 0 || outer + inner > 2) return;
  const std::size_t value = field.type ? size_of(*field.type) : field.size;
  if (outer == 1) {
    array.stride = header.item_size;
    array.step = value;
  } else if (header.fortran) {
    array.stride = header.item_size;
    array.step = header.item_size * static_cast<std::size_t>(header.shape[0]);
  } else {
    array.stride = header.item_size * static_cast<std::size_t>(header.shape[1]);
    array.step = header.item_size;
  }
}

/// Replaces numbers of 16 bits, which are in memory, by floats in memory of their own, row by row.
void widen(NumberArray& array, std::deque<Bytes>& memory) {
  const auto rows = static_cast<std::size_t>(array.shape.empty() ? 1 : array.shape[0]);
  const std::size_t columns = array.columns();
  Bytes& floats = memory.emplace_back(rows * columns * sizeof(float));
  parallel_for(rows, 1 << 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (std::size_t c = 0; c < columns; ++c) {
        const double bits = read_value(Scalar::uint16, array.order, array.first.at + i * array.stride + c * array.step);
        const float value = float_of_half(static_cast<unsigned>(bits));
        std::memcpy(floats.data() + (i * columns + c) * sizeof value, &value, sizeof value);
      }
  });
  array.type = Scalar::float32;
  array.order = std::endian::native;
  array.first = floats.data();
  array.step = sizeof(float);
  array.stride = columns * sizeof(float);
}

/// The value of an array that has only one, none for text and for others.
std::optional<double> single_value(const NumberArray& array) {
  if (!array.type || array.shape.size() > 1 || (array.shape.size() == 1 && array.shape[0] != 1)) return std::nullopt;
  const double value = read_value(*array.type, array.order, array.first.at);
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

/// Takes over what a frame says of itself; false: the array is something else.
bool take_frame_value(const NumberArray& array, Particles& particles) {
  if (array.shape.size() > 1) return false;
  if (array.name == "up" && array.shape.empty() && array.type_name.ends_with("U1")) {
    const auto letter = static_cast<std::uint32_t>(read_value(Scalar::uint32, array.order, array.first.at));
    for (const Axis axis : {Axis::x, Axis::y, Axis::z})
      if (static_cast<std::uint32_t>(meniscus::name_of(axis)[0]) == letter) particles.up = axis;
    return true;
  }
  const std::optional<double> value = single_value(array);
  if (!value) return array.shape.empty();  // a single text or the like is nothing to tell of
  if (array.name == "time" || array.name == "t") {
    particles.time = value;
  } else if (array.name == "spacing") {
    if (*value > 0) particles.spacing = static_cast<float>(*value);
  } else {
    return array.shape.empty();
  }
  return true;
}

}  // namespace

void add_npy(const Source& source, const std::string& name, NpyArrays& to) {
  source.need(0, 6);
  if (!source.starts_with("\x93NUMPY")) source.malformed("is no array of NumPy", 0, "\\x93NUMPY");
  const std::optional<NpyHeader> header = npy_header_of(source);
  if (!header) source.malformed("the file ends inside its NumPy header", source.bytes.size());
  if (header->has_object()) {
    to.objects.push_back(name);
    return;
  }
  source.require(header->first, header->items, header->item_size, "values");
  source.require_end(header->first + header->items * header->item_size, "values");
  const bool has_half =
      std::any_of(header->fields.begin(), header->fields.end(), [](const NpyField& field) { return field.half; });
  // Single values and what is widened are looked at where they are.
  if (header->items <= 1 || has_half) source.need(header->first, header->items * header->item_size);
  for (const NpyField& field : header->fields) {
    NumberArray& array = to.arrays.emplace_back();
    array.name = field.name.empty() ? name : field.name;
    array.shape = header->shape;
    array.shape.insert(array.shape.end(), field.shape.begin(), field.shape.end());
    array.type = field.type;
    array.type_name = field.type ? std::string(name_of(*field.type)) : field.type_name;
    array.order = field.order;
    array.first = source.stored(header->first + field.offset);
    // An array without values may claim any length of the other side.
    if (header->items == 0 && !array.shape.empty()) array.shape[0] = 0;
    lay_out(array, *header, field);
    if (field.half && array.shape.size() <= 2 && (array.stride > 0 || array.shape.empty())) widen(array, to.widened);
  }
}

Particles particles_of(const NpyArrays& arrays, const ReadOptions& options, const std::string& path) {
  Particles particles;
  std::vector<NumberArray> many;
  for (const NumberArray& array : arrays.arrays)
    if (!take_frame_value(array, particles)) many.push_back(array);
  const auto is_object = [&](const std::string& name) {
    return std::find(arrays.objects.begin(), arrays.objects.end(), name) != arrays.objects.end();
  };
  const std::vector<std::string> asked = split_names(options.positions);
  const bool found_otherwise = options.positions.empty() && (arrays.objects.empty() || find_positions(many));
  if (!found_otherwise && (options.positions.empty() || std::any_of(asked.begin(), asked.end(), is_object)))
    throw Error(ErrorCode::unsupported,
                {"holds pickled Python objects, which may run any program and are never read", "arrays of numbers",
                 fmt::format("'{}'", arrays.objects.front().substr(0, 60)), path, std::nullopt, std::nullopt,
                 "save plain arrays with numpy.savez(); PySPH: write HDF5 frames (--output-format hdf5)"});
  const PositionArrays found = choose_positions(many, options, path);
  set_positions(many, found, options, particles);
  if (found.guessed)
    particles.notes.push_back(fmt::format("took the array '{}' for positions", many[found.places[0]].name));
  add_attributes(many, found, particles);
  if (!arrays.objects.empty())
    particles.notes.push_back(fmt::format("left out {} array{} of pickled objects: '{}'", arrays.objects.size(),
                                          arrays.objects.size() > 1 ? "s" : "", arrays.objects.front().substr(0, 60)));
  return particles;
}

std::string npy_header(std::string_view type, std::span<const std::uint64_t> shape) {
  std::string lengths;
  for (const std::uint64_t length : shape) lengths += fmt::format("{},", length);
  std::string text = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}), }}", type, lengths);
  // Padded so that the values begin at a multiple of 64 bytes.
  constexpr std::size_t kBefore = 10, kAlign = 64;
  text.resize((kBefore + text.size() + kAlign) / kAlign * kAlign - kBefore - 1, ' ');
  text += '\n';
  std::string header("\x93NUMPY\x01\x00", 8);
  header += static_cast<char>(text.size() & 0xffu);
  header += static_cast<char>(text.size() >> 8);
  return header + text;
}

}  // namespace meniscus::io
