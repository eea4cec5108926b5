#include "sim/obstacle_grid.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

namespace meniscus {
namespace {

constexpr int kMostCells = 24;  ///< along an edge

}  // namespace

void ObstacleGrid::build(std::span<const Bounds> boxes) {
  bounds_ = {};
  std::size_t count = 0;
  for (const Bounds& box : boxes)
    if (!box.empty()) {
      bounds_.add(box);
      ++count;
    }
  starts_.clear();
  bodies_.clear();
  if (count == 0) return;
  const int edge = std::clamp(static_cast<int>(2 * std::cbrt(static_cast<double>(count))) + 2, 3, kMostCells);
  cells_ = glm::ivec3(edge);
  cells_per_metre_ = static_cast<float>(edge) / glm::max(bounds_.extent(), vec3(1e-12f));

  // Counted, then filled in: body after body, so that each cell's list rises.
  const auto cell_of = [&](vec3 point) {
    return glm::clamp(glm::ivec3((point - bounds_.low) * cells_per_metre_), glm::ivec3(0), cells_ - 1);
  };
  const auto for_cells = [&](const Bounds& box, auto&& body) {
    const glm::ivec3 low = cell_of(box.low), high = cell_of(box.high);
    for (int z = low.z; z <= high.z; ++z)
      for (int y = low.y; y <= high.y; ++y)
        for (int x = low.x; x <= high.x; ++x) body(static_cast<std::size_t>((z * cells_.y + y) * cells_.x + x));
  };
  starts_.assign(static_cast<std::size_t>(edge) * static_cast<std::size_t>(edge) * static_cast<std::size_t>(edge) + 1,
                 0);
  for (const Bounds& box : boxes)
    if (!box.empty()) for_cells(box, [&](std::size_t cell) { ++starts_[cell + 1]; });
  for (std::size_t i = 1; i < starts_.size(); ++i) starts_[i] += starts_[i - 1];
  bodies_.resize(starts_.back());
  std::vector<std::uint32_t> next(starts_.begin(), starts_.end() - 1);
  for (std::size_t i = 0; i < boxes.size(); ++i)
    if (!boxes[i].empty()) for_cells(boxes[i], [&](std::size_t cell) { bodies_[next[cell]++] = static_cast<int>(i); });
}

std::span<const int> ObstacleGrid::at(vec3 point) const {
  if (starts_.empty() || !(point.x >= bounds_.low.x && point.y >= bounds_.low.y && point.z >= bounds_.low.z &&
                           point.x <= bounds_.high.x && point.y <= bounds_.high.y && point.z <= bounds_.high.z))
    return {};
  const glm::ivec3 at = glm::min(glm::ivec3((point - bounds_.low) * cells_per_metre_), cells_ - 1);
  const auto cell = static_cast<std::size_t>((at.z * cells_.y + at.y) * cells_.x + at.x);
  return std::span(bodies_).subspan(starts_[cell], starts_[cell + 1] - starts_[cell]);
}

}  // namespace meniscus
