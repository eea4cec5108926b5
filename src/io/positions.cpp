#include "io/positions.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "io/unwritten.h"

namespace meniscus::io {
namespace {

constexpr double kFar = 8;  ///< spreads
constexpr std::size_t kGrain = 1 << 16;

struct Range {
  glm::dvec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};
};

/// Of the finite values.
Range range_of(Scalar type, std::endian order, const std::array<Column, 3>& columns, std::size_t rows) {
  Range all;
  std::mutex mutex;  // least and most do not depend on the order in which they are found
  parallel_for(rows, kGrain, [&](std::size_t begin, std::size_t end) {
    Range piece;
    for (int axis = 0; axis < 3; ++axis) {
      const Column& column = columns[static_cast<std::size_t>(axis)];
      for (std::size_t row = begin; row < end; ++row) {
        const double value = read_value(type, order, column.first + row * column.stride);
        if (!std::isfinite(value)) continue;
        piece.low[axis] = std::min(piece.low[axis], value);
        piece.high[axis] = std::max(piece.high[axis], value);
      }
    }
    const std::lock_guard lock(mutex);
    all.low = glm::min(all.low, piece.low);
    all.high = glm::max(all.high, piece.high);
  });
  return all;
}

/// Zero, or a round number amidst positions that lie far from zero.
glm::dvec3 origin_of(const Range& range, double scale) {
  const glm::dvec3 low = range.low * scale, high = range.high * scale;
  const double spread = std::max({high.x - low.x, high.y - low.y, high.z - low.z});
  glm::dvec3 origin{0.0};
  if (!(spread > 0) || !std::isfinite(spread)) return origin;
  const double round = std::pow(10.0, std::ceil(std::log10(spread)));
  for (int axis = 0; axis < 3; ++axis) {
    const double middle = 0.5 * (low[axis] + high[axis]);
    const double near = round * std::round(middle / round);
    if (std::abs(middle) > kFar * spread && std::isfinite(near)) origin[axis] = near;
  }
  return origin;
}

}  // namespace

void set_positions(Scalar type, std::endian order, const std::array<Column, 3>& columns, std::size_t rows,
                   const ReadOptions& options, Particles& particles, const RowParts& beside) {
  const std::array<std::vector<float>*, 3> targets{&particles.x, &particles.y, &particles.z};
  for (std::vector<float>* target : targets) resize_unwritten(*target, rows);
  const bool wide = size_of(type) > 4 || type == Scalar::int32 || type == Scalar::uint32;
  particles.origin = options.origin.value_or(glm::dvec3{0.0});
  if (wide && !options.origin && rows > 0)
    particles.origin = origin_of(range_of(type, order, columns, rows), options.scale);
  const double scale = options.scale;
  // Block by block: interleaved columns come from memory once.
  parallel_for(rows, kRowsAtOnce, [&](std::size_t begin, std::size_t end) {
    read_rows(beside, order, begin, end);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Column& column = columns[axis];
      const double origin = particles.origin[static_cast<glm::length_t>(axis)];
      const char* first = column.first + begin * column.stride;
      float* target = targets[axis]->data() + begin;
      if (origin == 0 && scale == 1) {
        read_columns(type, order, first, column.stride, end - begin, 1, target);
        continue;
      }
      for (std::size_t row = 0; row < end - begin; ++row)
        target[row] = static_cast<float>(read_value(type, order, first + row * column.stride) * scale - origin);
    }
  });
}

void set_positions(std::span<const double> values, const ReadOptions& options, Particles& particles) {
  constexpr std::array<double, 3> kNone{};  // no values stand nowhere, and nowhere has no second column
  const char* first = reinterpret_cast<const char*>(values.empty() ? kNone.data() : values.data());
  constexpr std::size_t kRow = 3 * sizeof(double);
  set_positions(Scalar::float64, std::endian::native,
                {Column{first, kRow}, {first + sizeof(double), kRow}, {first + 2 * sizeof(double), kRow}},
                values.size() / 3, options, particles);
}

}  // namespace meniscus::io
