#include "sim/simulation_room.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace meniscus {
namespace {

constexpr float kApart_rel = 0.9f;  ///< of a spacing, between new water and what is there

}  // namespace

Room::Room(const Bounds& bounds, float least, const Fluid& fluid)
    : low_(bounds.low - least), cell_(least), least2_(least * least) {
  const vec3 extent = bounds.extent() + 2 * least;
  for (int i = 0; i < 3; ++i) cells_[i] = static_cast<int>(extent[i] / cell_) + 1;
  heads_.assign(
      static_cast<std::size_t>(cells_.x) * static_cast<std::size_t>(cells_.y) * static_cast<std::size_t>(cells_.z), -1);
  const vec3 high = low_ + extent;
  for (std::size_t i = 0; i < fluid.size(); ++i) {
    const vec3 p{fluid.x[i], fluid.y[i], fluid.z[i]};
    if (p.x >= low_.x && p.y >= low_.y && p.z >= low_.z && p.x <= high.x && p.y <= high.y && p.z <= high.z) take(p);
  }
}

glm::ivec3 Room::cell_of(vec3 point) const {
  return glm::clamp(glm::ivec3(glm::floor((point - low_) / cell_)), glm::ivec3(0), cells_ - 1);
}

std::size_t Room::index(glm::ivec3 cell) const {
  return (static_cast<std::size_t>(cell.z) * static_cast<std::size_t>(cells_.y) + static_cast<std::size_t>(cell.y)) *
             static_cast<std::size_t>(cells_.x) +
         static_cast<std::size_t>(cell.x);
}

bool Room::free(vec3 point) const {
  const glm::ivec3 at = cell_of(point);
  const glm::ivec3 low = glm::max(at - 1, glm::ivec3(0)), high = glm::min(at + 1, cells_ - 1);
  for (int z = low.z; z <= high.z; ++z)
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x; ++x)
        for (std::int32_t i = heads_[index({x, y, z})]; i >= 0; i = nexts_[static_cast<std::size_t>(i)]) {
          const vec3 way = points_[static_cast<std::size_t>(i)] - point;
          if (glm::dot(way, way) < least2_) return false;
        }
  return true;
}

void Room::take(vec3 point) {
  std::int32_t& head = heads_[index(cell_of(point))];
  nexts_.push_back(head);
  head = static_cast<std::int32_t>(points_.size());
  points_.push_back(point);
}

void add_block(Fluid& fluid, const Bounds& block, float spacing, const Obstacles& obstacles, std::size_t most) {
  // A hair's breadth of rounding does not cost a layer.
  const glm::dvec3 layers = glm::floor(glm::dvec3(block.high - block.low) / static_cast<double>(spacing) + 1e-3);
  const double count = layers.x * layers.y * layers.z;
  if (!(count + static_cast<double>(fluid.size()) <= static_cast<double>(most)))
    throw Error(ErrorCode::limit_exceeded, {"there is more water than particles are allowed",
                                            fmt::format("at most {} particles", most),
                                            fmt::format("{:.0f}", count + static_cast<double>(fluid.size())),
                                            {},
                                            {},
                                            {},
                                            "take a larger spacing, less water or a larger limit"});
  if (!(count >= 1)) return;
  const glm::ivec3 n(layers);
  const vec3 first = block.low + spacing / 2;
  Room room({first, first + vec3(n - 1) * spacing}, kApart_rel * spacing, fluid);
  for (int z = 0; z < n.z; ++z)
    for (int y = 0; y < n.y; ++y)
      for (int x = 0; x < n.x; ++x) {
        const vec3 point = first + vec3(x, y, z) * spacing;
        if (obstacles.clearance(point, spacing) < 0.49f * spacing || !room.free(point)) continue;
        fluid.add(point, vec3(0.0f));
      }
}

float depth_inside(const Fluid& fluid, const Obstacles& obstacles, std::size_t obstacle) {
  const Bounds bounds = obstacles.bounds(obstacle);
  float depth = 0;
  for (std::size_t i = 0; i < fluid.size(); ++i) {
    const vec3 p{fluid.x[i], fluid.y[i], fluid.z[i]};
    if (!(p.x >= bounds.low.x && p.y >= bounds.low.y && p.z >= bounds.low.z && p.x <= bounds.high.x &&
          p.y <= bounds.high.y && p.z <= bounds.high.z))
      continue;
    NearestSurface nearest;
    if (obstacles.nearest(obstacle, p, 0, nearest)) depth = std::max(depth, -nearest.distance);
  }
  return depth;
}

}  // namespace meniscus
