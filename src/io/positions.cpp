#include "io/positions.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <functional>
#include <mutex>

#include "io/file_bytes.h"
#include "io/unwritten.h"
#include "io/words.h"

namespace meniscus::io {
namespace {

constexpr double kFar = 8;  ///< spreads

struct Range {
  glm::dvec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};
};

/// Three columns of one type, and what is read beside them.
struct Columns {
  Scalar type;
  std::endian order;
  std::array<Column, 3> axes;
  RowParts beside;

  /// Calls visit with the columns in memory of pieces of the rows, on all threads: from row `begin` to before `end`,
  /// the first byte of each axis in row `begin` and that of what is beside.
  using Visit =
      FunctionRef<void(std::size_t begin, std::size_t end, const std::array<const char*, 3>& axes, const char* beside)>;
  void for_each_piece(std::size_t rows, Visit visit) const;
};

void Columns::for_each_piece(std::size_t rows, Visit visit) const {
  const std::size_t size = size_of(type), stride = axes[0].stride;
  // Whether they stand in the same rows, and from where to where in these.
  const auto less = [](const Stored& a, const Stored& b) { return std::less<>()(a.at, b.at); };
  std::array<Stored, 4> firsts{axes[0].first, axes[1].first, axes[2].first, axes[0].first};
  if (!beside.parts.empty()) firsts[3] = beside.first;
  const auto [least, last] = std::minmax_element(firsts.begin(), firsts.end(), less);
  const Stored first = *least;
  const std::size_t row_bytes = std::max<std::size_t>(
      (reinterpret_cast<std::uintptr_t>(last->at) - reinterpret_cast<std::uintptr_t>(first.at)) + size,
      beside.parts.empty() ? 0 : stride);
  const bool together = row_bytes <= stride && axes[1].stride == stride && axes[2].stride == stride;
  if (together) {
    io::for_each_piece(first, stride, row_bytes, rows, [&](std::size_t begin, std::size_t end, const char* bytes) {
      visit(begin, end,
            {bytes + (axes[0].first.at - first.at), bytes + (axes[1].first.at - first.at),
             bytes + (axes[2].first.at - first.at)},
            bytes + (firsts[3].at - first.at));
    });
    return;
  }
  std::array<PieceBuffers, 3> buffers;
  parallel_for(rows, rows_of_piece(first, stride), [&](std::size_t begin, std::size_t end) {
    std::array<PieceBuffers::Lease, 3> buffer{PieceBuffers::Lease(buffers[0]), PieceBuffers::Lease(buffers[1]),
                                              PieceBuffers::Lease(buffers[2])};
    std::array<const char*, 3> bytes{};
    for (std::size_t axis = 0; axis < 3; ++axis)
      bytes[axis] = buffer[axis]->bytes(axes[axis].first + begin * axes[axis].stride,
                                        (end - begin - 1) * axes[axis].stride + size);
    visit(begin, end, bytes, nullptr);
  });
}

/// Of the finite values.
Range range_of(const Columns& columns, std::size_t rows) {
  Range all;
  std::mutex mutex;  // least and most do not depend on the order in which they are found
  columns.for_each_piece(
      rows, [&](std::size_t begin, std::size_t end, const std::array<const char*, 3>& axes, const char* /*beside*/) {
        Range piece;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const auto at = static_cast<glm::length_t>(axis);
          for (std::size_t row = 0; row < end - begin; ++row) {
            const double value = read_value(columns.type, columns.order, axes[axis] + row * columns.axes[axis].stride);
            if (!std::isfinite(value)) continue;
            piece.low[at] = std::min(piece.low[at], value);
            piece.high[at] = std::max(piece.high[at], value);
          }
        }
        const std::lock_guard lock(mutex);
        all.low = glm::min(all.low, piece.low);
        all.high = glm::max(all.high, piece.high);
      });
  return all;
}

/// Converts a piece on this thread; `axes` and `targets` are those of its first row.
void convert_positions(const Columns& columns, const std::array<const char*, 3>& axes, std::size_t rows, double scale,
                       const glm::dvec3& origin, const std::array<float*, 3>& targets) {
  constexpr std::size_t kWord = sizeof(float);
  const bool is_triple = columns.type == Scalar::float32 && axes[1] == axes[0] + kWord && axes[2] == axes[1] + kWord;
  if (is_triple && scale == 1 && origin == glm::dvec3(0.0)) {
    split_triples(axes[0], columns.axes[0].stride, columns.order != std::endian::native, rows, targets[0], targets[1],
                  targets[2]);
    return;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t stride = columns.axes[axis].stride;
    const double middle = origin[static_cast<glm::length_t>(axis)];
    if (middle == 0 && scale == 1) {
      convert_columns(columns.type, columns.order, axes[axis], stride, rows, 1, targets[axis]);
      continue;
    }
    for (std::size_t row = 0; row < rows; ++row)
      targets[axis][row] =
          static_cast<float>(read_value(columns.type, columns.order, axes[axis] + row * stride) * scale - middle);
  }
}

std::size_t count_non_finite(std::span<const float> values) {
  // Without branches: as fast as they come from the cache.
  constexpr std::uint32_t kExponent = 0x7f800000u;
  std::uint32_t count = 0;
  for (const float value : values)
    count += static_cast<std::uint32_t>((std::bit_cast<std::uint32_t>(value) & kExponent) == kExponent);
  return count;
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
  const Columns source{type, order, columns, beside};
  if (wide && !options.origin && rows > 0)
    particles.origin = origin_of(range_of({type, order, columns, {}}, rows), options.scale);
  const double scale = options.scale;
  std::atomic<std::size_t> non_finite{0};
  source.for_each_piece(
      rows, [&](std::size_t begin, std::size_t end, const std::array<const char*, 3>& axes, const char* bytes) {
        convert_rows(beside, order, bytes, begin, end);
        std::array<float*, 3> to{};
        for (std::size_t axis = 0; axis < 3; ++axis) to[axis] = targets[axis]->data() + begin;
        convert_positions(source, axes, end - begin, scale, particles.origin, to);
        std::size_t count = 0;
        for (const float* values : to) count += count_non_finite({values, end - begin});
        if (count > 0) non_finite += count;
      });
  particles.dropped_non_finite = non_finite;
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
