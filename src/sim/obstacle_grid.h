/// Which bodies are near a place: what lets the water far from all of them pass for free.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "meniscus/base.h"

namespace meniscus {

class ObstacleGrid {
 public:
  /// @param boxes  m, one a body; empty ones are nowhere
  void build(std::span<const Bounds> boxes);
  /// The bodies whose boxes may hold the point, in rising order.
  std::span<const int> at(vec3 point) const;

 private:
  Bounds bounds_;
  vec3 cells_per_metre_{0.0f};
  glm::ivec3 cells_{0};
  std::vector<std::uint32_t> starts_;  ///< of each cell's part of bodies_, and the end; x fastest
  std::vector<int> bodies_;
};

}  // namespace meniscus
