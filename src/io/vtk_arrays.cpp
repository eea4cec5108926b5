#include "io/vtk_arrays.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <utility>

#include "io/text_numbers.h"
#include "io/unwritten.h"

namespace meniscus::io {
namespace {

// vtkIdType is written as a 32-bit int, long as 64 bits (all of today's writers run on 64-bit systems).
constexpr std::array<std::pair<std::string_view, Scalar>, 15> kNumbers{{{"char", Scalar::int8},
                                                                        {"signed_char", Scalar::int8},
                                                                        {"unsigned_char", Scalar::uint8},
                                                                        {"short", Scalar::int16},
                                                                        {"unsigned_short", Scalar::uint16},
                                                                        {"int", Scalar::int32},
                                                                        {"unsigned_int", Scalar::uint32},
                                                                        {"vtkidtype", Scalar::int32},
                                                                        {"long", Scalar::int64},
                                                                        {"unsigned_long", Scalar::uint64},
                                                                        {"vtktypeint64", Scalar::int64},
                                                                        {"vtktypeuint64", Scalar::uint64},
                                                                        {"float", Scalar::float32},
                                                                        {"double", Scalar::float64},
                                                                        {"long_long", Scalar::int64}}};

}  // namespace

VtkType VtkArrays::type_of(std::string_view name) const {
  const std::string plain = lower(name);
  for (const auto& [known, scalar] : kNumbers) {
    if (plain == known) return {VtkType::Kind::number, scalar};
  }
  if (plain == "bit") return {VtkType::Kind::bit, Scalar::uint8};
  if (plain == "string" || plain == "utf8_string") return {VtkType::Kind::text, Scalar::uint8};
  if (plain == "variant") return {VtkType::Kind::variant, Scalar::uint8};
  source_.malformed("an array's type is unknown", text_.at(), "float, double, int, ...",
                    fmt::format("'{}'", name.substr(0, 40)));
}

void VtkArrays::begin() { text_.line(); }

std::uint64_t VtkArrays::checked_size(VtkType type, std::uint64_t tuples, std::uint64_t components,
                                      std::string_view what) const {
  if (components > 65536) {
    source_.malformed(fmt::format("the {} have an impossible number of components", what), text_.at(), {},
                      fmt::format("{}", components));
  }
  if (components == 0) return 0;
  // Bits are packed in binary files; text takes a byte a value at least.
  if (binary_ && type.kind == VtkType::Kind::bit) {
    source_.require(text_.at(), tuples / 8, components, what);
  } else {
    const std::uint64_t size = binary_ && type.kind == VtkType::Kind::number ? size_of(type.scalar) : 1;
    source_.require(text_.at(), tuples, size * components, what);
  }
  return tuples * components;
}

std::vector<float> VtkArrays::read(VtkType type, std::uint64_t tuples, std::uint64_t components,
                                   std::string_view what) {
  if (type.kind != VtkType::Kind::number) {
    skip(type, tuples, components, what);
    return {};
  }
  const auto count = static_cast<std::size_t>(checked_size(type, tuples, components, what));
  std::vector<float> values;
  if (binary_) {
    resize_unwritten(values, count);
    const std::size_t size = size_of(type.scalar);
    read_columns(type.scalar, std::endian::big, source_.stored(text_.at()), size, count, 1, values.data());
    text_.seek(text_.at() + count * size);
  } else {
    values.resize(count);
    read_text(std::span<float>(values), what);
  }
  return values;
}

template <class T>
void VtkArrays::read_text(std::span<T> values, std::string_view what) {
  const TextNumbers read = read_numbers(source_, text_.at(), source_.bytes.size(), values, what);
  text_.seek(read.end);
  if (read.count < values.size()) text_.number(what);  // there is none: an error that says so
}

void VtkArrays::read_points(VtkType type, std::uint64_t count, const ReadOptions& options, Particles& particles) {
  if (type.kind != VtkType::Kind::number) source_.malformed("the points are not numbers", text_.at());
  checked_size(type, count, 3, "points");
  const auto points = static_cast<std::size_t>(count);
  if (binary_) {
    const std::size_t size = size_of(type.scalar);
    const Stored first = source_.stored(text_.at());
    set_positions(type.scalar, std::endian::big,
                  {Column{first, 3 * size}, {first + size, 3 * size}, {first + 2 * size, 3 * size}}, points, options,
                  particles);
    text_.seek(text_.at() + points * 3 * size);
  } else if (type.scalar == Scalar::float32 && points > 0) {
    std::vector<float> values(3 * points);
    read_text(std::span<float>(values), "points");
    constexpr std::size_t kSize = sizeof(float);
    const char* first = reinterpret_cast<const char*>(values.data());
    set_positions(Scalar::float32, std::endian::native,
                  {Column{first, 3 * kSize}, {first + kSize, 3 * kSize}, {first + 2 * kSize, 3 * kSize}}, points,
                  options, particles);
  } else {
    std::vector<double> values(3 * points);
    read_text(std::span<double>(values), "points");
    set_positions(values, options, particles);
  }
}

void VtkArrays::skip(VtkType type, std::uint64_t tuples, std::uint64_t components, std::string_view what) {
  const std::uint64_t values = checked_size(type, tuples, components, what);
  if (type.kind == VtkType::Kind::text || type.kind == VtkType::Kind::variant) {
    skip_texts(type, values, what);
  } else if (!binary_) {
    text_.skip_words(values, what);
  } else if (type.kind == VtkType::Kind::bit) {
    const std::uint64_t bytes = values / 8 + (values % 8 != 0 ? 1 : 0);
    source_.require(text_.at(), bytes, 1, what);
    text_.seek(text_.at() + static_cast<std::size_t>(bytes));
  } else {
    text_.seek(text_.at() + static_cast<std::size_t>(values) * size_of(type.scalar));
  }
}

void VtkArrays::skip_texts(VtkType type, std::uint64_t values, std::string_view what) {
  // In ASCII files, and for variants in any, a value is a line. In binary files the length stands before the
  // text: the two highest bits of its first byte say whether it takes 8, 4, 2 or 1 bytes.
  for (std::uint64_t i = 0; i < values; ++i) {
    source_.require(text_.at(), 1, 1, what);
    if (!binary_ || type.kind == VtkType::Kind::variant) {
      text_.line();
      continue;
    }
    constexpr std::uint64_t kLongest = 8;
    source_.need(text_.at(), kLongest);
    const char* at = source_.bytes.data() + text_.at();
    const auto first = static_cast<unsigned char>(*at);
    const std::size_t bytes = std::size_t{8} >> (first >> 6);
    source_.require(text_.at(), 1, bytes, what);
    std::uint64_t length = first & 0x3f;
    for (std::size_t b = 1; b < bytes; ++b) length = length << 8 | static_cast<unsigned char>(at[b]);
    source_.require(text_.at() + bytes, length, 1, what);
    text_.seek(text_.at() + bytes + static_cast<std::size_t>(length));
  }
}

std::string vtk_name(std::string_view word) {
  std::string name;
  for (std::size_t i = 0; i < word.size(); ++i) {
    int code = 0;
    if (word[i] == '%' && i + 2 < word.size() &&
        std::from_chars(word.data() + i + 1, word.data() + i + 3, code, 16).ptr == word.data() + i + 3) {
      name += static_cast<char>(code);
      i += 2;
    } else {
      name += word[i];
    }
  }
  return name;
}

}  // namespace meniscus::io
