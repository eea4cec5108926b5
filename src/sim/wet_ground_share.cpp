/// How the water of a hit is shared between a cell and its neighbours.                   [Mizukami2013] 4.6.1, fig. 7
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "meniscus/sim.h"
#include "sim/ground_constants.h"

namespace meniscus {
namespace {

constexpr std::size_t kOutside = static_cast<std::size_t>(-1);

/// One of the cells that share: its water's level over that of the cell that was hit, m.
struct Sharer {
  std::size_t cell;
  double level;
};

}  // namespace

void WetGround::add(std::size_t cell, double volume) {
  if (cell >= size())
    throw Error(ErrorCode::invalid_argument,
                {"there is no such cell", fmt::format("below {}", size()), fmt::format("{}", cell), {}, {}, {}, {}});
  const double edge = options_.cell;
  if (!(volume >= 0 && volume <= kMostWater * edge * edge))
    throw Error(ErrorCode::invalid_argument, {"a hit brings an amount of water that is out of range",
                                              fmt::format("0 to {:g} m of depth on a cell", kMostWater),
                                              fmt::format("{:g} m^3", volume),
                                              {},
                                              {},
                                              {},
                                              {}});
  fallen_ += volume;
  const double left = soak(cell, volume / (edge * edge));
  if (left > 0) share(cell, left);
}

void WetGround::share(std::size_t cell, double depth) {
  // The cell first, then its neighbours; levels as differences, which keep their precision far from the origin.
  const auto width = static_cast<std::size_t>(width_), height = static_cast<std::size_t>(height_);
  const std::size_t i = cell % width, j = cell / width;
  const double bed = bed_[cell], water = depth_[cell];
  const auto neighbour = [&](bool there, std::size_t n) -> Sharer {
    if (!there) return {kOutside, -water};  // ground of the same height, without water
    return {n, (static_cast<double>(bed_[n]) - bed) + (depth_[n] - water)};
  };
  std::array<Sharer, 5> sharers{Sharer{cell, 0.0}, neighbour(i > 0, cell - 1), neighbour(i + 1 < width, cell + 1),
                                neighbour(j > 0, cell - width), neighbour(j + 1 < height, cell + width)};
  const double edge = options_.cell;
  const auto give = [&](std::size_t to, double part) {
    if (to == kOutside) {
      drained_ += part * edge * edge;
    } else {
      depth_[to] += soak(to, part);
      stir(to);
    }
  };

  // Fig. 7 b, step 2: all of the water leaves for the lower neighbours, if they stay lower.
  int lower = 0;
  double highest = -water;
  for (std::size_t n = 1; n < 5; ++n) {
    if (!(sharers[n].level < 0)) continue;
    highest = lower == 0 ? sharers[n].level : std::max(highest, sharers[n].level);
    ++lower;
  }
  if (lower > 0 && 0 > highest + depth / lower) {
    for (std::size_t n = 1; n < 5; ++n)
      if (sharers[n].level < 0) give(sharers[n].cell, depth / lower);
    return;
  }

  // Step 3, and fig. 7 a as the case of equal levels: the lowest are filled up to one level.
  for (std::size_t n = 1; n < sharers.size(); ++n)  // five: sorted by insertion
    for (std::size_t m = n; m > 0 && sharers[m].level < sharers[m - 1].level; --m)
      std::swap(sharers[m], sharers[m - 1]);
  std::size_t filled = 0;
  double sum = 0, level = 0;
  do {
    sum += sharers[filled++].level;
    level = (depth + sum) / static_cast<double>(filled);
  } while (filled < sharers.size() && sharers[filled].level < level);
  double left = depth;
  for (std::size_t n = filled; n-- > 1;) {
    const double part = std::clamp(level - sharers[n].level, 0.0, left);
    give(sharers[n].cell, part);
    left -= part;
  }
  give(sharers[0].cell, left);  // what is left, so that rounding makes no water
}

}  // namespace meniscus
