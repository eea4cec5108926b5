#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "meniscus/particles.h"
#include "particles/chosen.h"

namespace meniscus {
namespace {

constexpr std::size_t kGrain = 16384;

/// A particle with its cell; cells are numbered by 31 bits an axis and never stored where they are empty.
struct Placed {
  std::array<std::uint32_t, 3> cell;  ///< x, y, z
  std::uint32_t index;
};

/// By z, then y, then x, so that cells adjacent in x are one contiguous run.
bool before(const std::array<std::uint32_t, 3>& a, const std::array<std::uint32_t, 3>& b) {
  if (a[2] != b[2]) return a[2] < b[2];
  if (a[1] != b[1]) return a[1] < b[1];
  return a[0] < b[0];
}

/// Sorts by the cell: 11 bits a pass from x's lowest to z's highest, only as many as the domain needs.
void sort_by_cell(std::vector<Placed>& items, const std::array<std::uint32_t, 3>& last) {
  constexpr std::uint32_t kBits = 11;
  std::vector<Placed> other(items.size());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::uint32_t shift = 0; shift < 32 && last[axis] >> shift > 0; shift += kBits) {
      std::array<std::size_t, 1 << kBits> starts{};
      const auto digit = [&](const Placed& item) { return item.cell[axis] >> shift & ((1u << kBits) - 1); };
      for (const Placed& item : items) ++starts[digit(item)];
      std::size_t sum = 0;
      for (std::size_t& start : starts) sum += std::exchange(start, sum);
      for (const Placed& item : items) other[starts[digit(item)]++] = item;
      items.swap(other);
    }
  }
}

/// Whether particle `item` has `neighbours` others within the radius. `rows` are for each of the nine rows of cells
/// around it a place at or before the row's first particle; they move on with the items.
bool has_neighbours(const Particles& particles, const std::vector<Placed>& items, const Placed& item,
                    std::array<std::size_t, 9>& rows, double radius2, std::size_t neighbours) {
  const glm::dvec3 point(particles.position(item.index));
  std::size_t count = 0;
  for (std::size_t row = 0; row < 9; ++row) {
    std::array<std::uint32_t, 3> first = item.cell;
    const std::uint32_t y = first[1] + static_cast<std::uint32_t>(row % 3),
                        z = first[2] + static_cast<std::uint32_t>(row / 3);
    first = {first[0] - 1, y - 1, z - 1};  // cells are numbered from 1, so nothing wraps
    const std::array<std::uint32_t, 3> last{first[0] + 2, first[1], first[2]};
    while (rows[row] < items.size() && before(items[rows[row]].cell, first)) ++rows[row];
    for (std::size_t i = rows[row]; i < items.size() && !before(last, items[i].cell); ++i) {
      if (items[i].index == item.index) continue;
      const glm::dvec3 offset = glm::dvec3(particles.position(items[i].index)) - point;
      count += offset.x * offset.x + offset.y * offset.y + offset.z * offset.z <= radius2;
      if (count >= neighbours) return true;
    }
  }
  return false;
}

}  // namespace

Particles without_isolated(const Particles& particles, float radius, int neighbours) {
  if (!(radius >= 0) || !std::isfinite(radius)) {
    ErrorDetail detail;
    detail.problem = "the radius of the search for isolated particles is out of range";
    detail.expected = "0 m or more";
    detail.found = std::to_string(radius);
    throw Error(ErrorCode::invalid_argument, detail);
  }
  if (neighbours <= 0 || particles.empty()) return particles;

  // Cells at least as wide as the radius, so that neighbours lie in the 27 around; wider only where the domain is
  // so large that floats could not tell such small cells apart.
  const Bounds bounds = particles.bounds();
  const glm::dvec3 low(bounds.low), extent = glm::dvec3(bounds.high) - low;
  const double longest = std::max({extent.x, extent.y, extent.z});
  const double cell = std::max({1.000001 * double{radius}, longest * 0x1p-30, 1e-300});
  std::vector<Placed> items(particles.size());
  parallel_for(items.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const glm::dvec3 place = (glm::dvec3(particles.position(i)) - low) / cell;
      const auto number = [](double v) { return static_cast<std::uint32_t>(v) + 1; };
      items[i] = {{number(place.x), number(place.y), number(place.z)}, static_cast<std::uint32_t>(i)};
    }
  });
  const auto last = [&](double e) { return static_cast<std::uint32_t>(e / cell) + 1; };
  sort_by_cell(items, {last(extent.x), last(extent.y), last(extent.z)});

  std::vector<std::uint8_t> kept(particles.size());
  parallel_for(items.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    std::array<std::size_t, 9> rows;
    for (std::size_t row = 0; row < 9; ++row) {
      const auto& c = items[begin].cell;
      const std::array<std::uint32_t, 3> first{c[0] - 1, c[1] + static_cast<std::uint32_t>(row % 3) - 1,
                                               c[2] + static_cast<std::uint32_t>(row / 3) - 1};
      rows[row] = static_cast<std::size_t>(
          std::partition_point(items.begin(), items.end(), [&](const Placed& p) { return before(p.cell, first); }) -
          items.begin());
    }
    for (std::size_t i = begin; i < end; ++i) {
      kept[items[i].index] = has_neighbours(particles, items, items[i], rows, double{radius} * radius,
                                            static_cast<std::size_t>(neighbours));
    }
  });
  return chosen(particles, kept);
}

}  // namespace meniscus
