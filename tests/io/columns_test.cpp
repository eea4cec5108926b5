// Columns of binary numbers become floats: every type, both byte orders, side by side and in rows.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "io/positions.h"
#include "io/unwritten.h"

namespace meniscus::io {
namespace {

constexpr std::size_t kRows = 9001;  // two blocks of rows and a part of one

constexpr std::array kTypes{Scalar::int8,   Scalar::uint8, Scalar::int16,  Scalar::uint16,  Scalar::int32,
                            Scalar::uint32, Scalar::int64, Scalar::uint64, Scalar::float32, Scalar::float64};

/// Bytes of every kind, the same each time.
std::vector<char> some_bytes(std::size_t size) {
  std::vector<char> bytes(size);
  std::uint32_t state = 1;
  for (char& byte : bytes) {
    state = state * 1664525u + 1013904223u;
    byte = static_cast<char>(state >> 24);
  }
  return bytes;
}

/// The value at a place, put together byte by byte.
float value_at(Scalar type, std::endian order, const char* first) {
  const std::size_t size = size_of(type);
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < size; ++i)
    bits = bits << 8 | static_cast<unsigned char>(first[order == std::endian::big ? i : size - 1 - i]);
  switch (type) {
    case Scalar::int8:
      return static_cast<float>(static_cast<std::int8_t>(bits));
    case Scalar::int16:
      return static_cast<float>(static_cast<std::int16_t>(bits));
    case Scalar::int32:
      return static_cast<float>(static_cast<std::int32_t>(bits));
    case Scalar::int64:
      return static_cast<float>(static_cast<std::int64_t>(bits));
    case Scalar::float32:
      return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
    case Scalar::float64:
      return static_cast<float>(std::bit_cast<double>(bits));
    default:
      return static_cast<float>(bits);
  }
}

bool same(float a, float b) {
  return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b) || (std::isnan(a) && std::isnan(b));
}

TEST(Columns, AreWhatTheirBytesSayInEveryTypeOrderAndStride) {
  for (const Scalar type : kTypes)
    for (const std::endian order : {std::endian::little, std::endian::big})
      for (const std::size_t components : {1u, 2u, 3u, 4u})
        for (const std::size_t gap : {0u, 5u}) {
          const std::size_t size = size_of(type), stride = components * size + gap, rows = 67;
          const std::vector<char> bytes = some_bytes(1 + rows * stride);
          std::vector<float> values(rows * components);
          read_columns(type, order, bytes.data() + 1, stride, rows, components, values.data());  // not aligned
          for (std::size_t i = 0; i < values.size(); ++i)
            ASSERT_TRUE(same(values[i],
                             value_at(type, order, bytes.data() + 1 + i / components * stride + i % components * size)))
                << "type " << static_cast<int>(type) << ", value " << i << ", " << components << " components, gap "
                << gap;
        }
}

TEST(Columns, OfPositionsAndOfWhatStandsBesideThemComeOutOfOnePass) {
  constexpr std::size_t kStride = 4 * 7;  // velocity, position, and something that is left out
  std::vector<char> bytes = some_bytes(kRows * kStride);
  const char* first = bytes.data();
  std::vector<float> velocity(3 * kRows);
  const std::vector<RowPart> parts{{Scalar::float32, 0, 3, velocity.data()}};
  Particles particles;
  particles.x = {1, 2, 3};  // what was there is replaced
  set_positions(Scalar::float32, std::endian::big,
                {Column{first + 12, kStride}, {first + 16, kStride}, {first + 20, kStride}}, kRows, {}, particles,
                {first, kStride, parts});
  ASSERT_EQ(particles.size(), kRows);
  const std::array<const std::vector<float>*, 3> columns{&particles.x, &particles.y, &particles.z};
  for (std::size_t i = 0; i < kRows; ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      const char* at = first + i * kStride + 4 * c;
      ASSERT_TRUE(same((*columns[c])[i], value_at(Scalar::float32, std::endian::big, at + 12))) << i;
      ASSERT_TRUE(same(velocity[3 * i + c], value_at(Scalar::float32, std::endian::big, at))) << i;
    }
}

TEST(Columns, FarFromZeroAreCountedFromTheirOriginInEveryBlock) {
  std::vector<double> values(3 * kRows);
  for (std::size_t i = 0; i < kRows; ++i) {
    values[3 * i] = 4e6 + 1e-4 * static_cast<double>(i);
    values[3 * i + 1] = 1e-4 * static_cast<double>(i);
  }
  Particles particles;
  set_positions(values, {}, particles);
  ASSERT_NE(particles.origin.x, 0);
  for (std::size_t i = 0; i < kRows; ++i) {
    ASSERT_EQ(particles.x[i], static_cast<float>(values[3 * i] - particles.origin.x)) << i;
    ASSERT_EQ(particles.y[i], static_cast<float>(values[3 * i + 1])) << i;
  }
}

TEST(UnwrittenVectors, AreVectorsOfTheirSize) {
  std::vector<float> values{1, 2};
  resize_unwritten(values, 1000);
  ASSERT_EQ(values.size(), 1000u);
  EXPECT_GE(values.capacity(), 1000u);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i);
  values.push_back(1000);
  std::vector<float> copy = values;
  for (std::size_t i = 0; i < copy.size(); ++i) ASSERT_EQ(copy[i], static_cast<float>(i));
  resize_unwritten(copy, 3);
  EXPECT_EQ(copy.size(), 3u);
  resize_unwritten(copy, 0);
  EXPECT_TRUE(copy.empty());
}

TEST(UnwrittenVectors, RefuseWhatNoMemoryHolds) {
  std::vector<float> values{1};
  EXPECT_THROW(resize_unwritten(values, std::numeric_limits<std::size_t>::max() / 2), std::length_error);
  EXPECT_TRUE(values.empty() || values.size() == 1) << "and stay whole";
}

}  // namespace
}  // namespace meniscus::io
