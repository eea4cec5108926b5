#include "io/values.h"

#include <cstring>
#include <type_traits>

#include "io/file_bytes.h"
#include "io/words.h"

namespace meniscus::io {
namespace {

constexpr std::size_t kFloatsAtOnce = std::size_t{1} << 18;  ///< that one thread reads to where they belong

template <std::size_t kSize>
struct Word;
template <>
struct Word<1> {
  using type = std::uint8_t;
  static type swapped(type v) { return v; }
};
template <>
struct Word<2> {
  using type = std::uint16_t;
  static type swapped(type v) { return __builtin_bswap16(v); }
};
template <>
struct Word<4> {
  using type = std::uint32_t;
  static type swapped(type v) { return __builtin_bswap32(v); }
};
template <>
struct Word<8> {
  using type = std::uint64_t;
  static type swapped(type v) { return __builtin_bswap64(v); }
};

template <class T, bool kSwap>
T load(const char* from) {
  using W = Word<sizeof(T)>;
  typename W::type word;
  std::memcpy(&word, from, sizeof word);
  if constexpr (kSwap) word = W::swapped(word);
  return std::bit_cast<T>(word);
}

/// Values that stand side by side: a loop that compilers turn into vector instructions.
template <class T, bool kSwap>
void convert_run(const char* first, std::size_t count, float* target) {
  if constexpr (std::is_same_v<T, float> && !kSwap) {
    std::memcpy(target, first, count * sizeof(T));
  } else if constexpr (std::is_same_v<T, float>) {
    swap_words(first, count, target);
  } else {
    for (std::size_t i = 0; i < count; ++i) target[i] = static_cast<float>(load<T, kSwap>(first + i * sizeof(T)));
  }
}

/// Rows of kComponents values; 0: of `components`.
template <class T, bool kSwap, std::size_t kComponents>
void convert_rows(const char* first, std::size_t stride, std::size_t rows, std::size_t components, float* target) {
  if constexpr (kComponents > 0) components = kComponents;
  for (std::size_t row = 0; row < rows; ++row) {
    const char* from = first + row * stride;
    float* to = target + row * components;
    for (std::size_t c = 0; c < components; ++c) to[c] = static_cast<float>(load<T, kSwap>(from + c * sizeof(T)));
  }
}

template <class T, bool kSwap>
void convert(const char* first, std::size_t stride, std::size_t rows, std::size_t components, float* target) {
  if (stride == components * sizeof(T)) {
    convert_run<T, kSwap>(first, rows * components, target);
  } else if (components == 1) {
    convert_rows<T, kSwap, 1>(first, stride, rows, components, target);
  } else if (std::is_same_v<T, float> && components == 3 && stride >= 3 * sizeof(T)) {
    copy_triples(first, stride, kSwap, rows, target);
  } else if (components == 3) {
    convert_rows<T, kSwap, 3>(first, stride, rows, components, target);
  } else {
    convert_rows<T, kSwap, 0>(first, stride, rows, components, target);
  }
}

/// Calls visit with a value of the type that `type` names.
template <class Visit>
auto with_type(Scalar type, Visit visit) {
  switch (type) {
    case Scalar::int8:
      return visit(std::int8_t{});
    case Scalar::uint8:
      return visit(std::uint8_t{});
    case Scalar::int16:
      return visit(std::int16_t{});
    case Scalar::uint16:
      return visit(std::uint16_t{});
    case Scalar::int32:
      return visit(std::int32_t{});
    case Scalar::uint32:
      return visit(std::uint32_t{});
    case Scalar::int64:
      return visit(std::int64_t{});
    case Scalar::uint64:
      return visit(std::uint64_t{});
    case Scalar::float32:
      return visit(float{});
    case Scalar::float64:
      break;
  }
  return visit(double{});
}

}  // namespace

std::size_t size_of(Scalar type) {
  return with_type(type, [](auto value) { return sizeof(value); });
}

void convert_columns(Scalar type, std::endian order, const char* first, std::size_t stride, std::size_t rows,
                     std::size_t components, float* target) {
  with_type(type, [&](auto value) {
    using T = decltype(value);
    if (order == std::endian::native) {
      convert<T, false>(first, stride, rows, components, target);
    } else {
      convert<T, true>(first, stride, rows, components, target);
    }
  });
}

void read_columns(Scalar type, std::endian order, Stored first, std::size_t stride, std::size_t rows,
                  std::size_t components, float* target) {
  const std::size_t row_bytes = components * size_of(type);
  // What needs no conversion is read to where it belongs.
  const bool as_it_is = type == Scalar::float32 && order == std::endian::native && stride == row_bytes;
  if (as_it_is && first.file != nullptr && !first.file->has(first.at, rows * row_bytes)) {
    parallel_for(rows * components, kFloatsAtOnce, [&](std::size_t begin, std::size_t end) {
      first.file->copy(first.at + begin * sizeof(float),
                       {reinterpret_cast<char*>(target + begin), (end - begin) * sizeof(float)});
    });
    return;
  }
  for_each_piece(first, stride, row_bytes, rows, [&](std::size_t begin, std::size_t end, const char* bytes) {
    convert_columns(type, order, bytes, stride, end - begin, components, target + begin * components);
  });
}

double read_value(Scalar type, std::endian order, const char* first) {
  return with_type(type, [&](auto value) {
    using T = decltype(value);
    return static_cast<double>(order == std::endian::native ? load<T, false>(first) : load<T, true>(first));
  });
}

std::uint32_t big_endian_32(const char* first) {
  return load<std::uint32_t, std::endian::native == std::endian::little>(first);
}

std::uint16_t big_endian_16(const char* first) {
  return load<std::uint16_t, std::endian::native == std::endian::little>(first);
}

}  // namespace meniscus::io
