/// New water: where particles may stand.
#pragma once

#include "sim/fluid.h"
#include "sim/obstacles.h"

namespace meniscus {

/// Keeps particles of one neighbourhood apart.
class Room {
 public:
  /// @param bounds  m, of what is asked about
  /// @param least   m; nearer than this are two particles too close
  Room(const Bounds& bounds, float least, const Fluid& fluid);
  bool free(vec3 point) const;
  void take(vec3 point);

 private:
  glm::ivec3 cell_of(vec3 point) const;
  std::size_t index(glm::ivec3 cell) const;

  vec3 low_;
  float cell_;
  float least2_;
  glm::ivec3 cells_;
  std::vector<std::int32_t> heads_;  ///< newest point of each cell, -1: none
  std::vector<std::int32_t> nexts_;
  std::vector<vec3> points_;
};

/// Particles at rest on a lattice in the block, half a spacing from its lower sides and from walls and obstacles, none
/// too close to what is there.
/// @throws Error limit_exceeded: more particles than `most` in all
void add_block(Fluid& fluid, const Bounds& block, float spacing, const Obstacles& obstacles, std::size_t most);

/// How deep in the obstacle the deepest particle is, m; 0: none is inside.
float depth_inside(const Fluid& fluid, const Obstacles& obstacles, std::size_t obstacle);

}  // namespace meniscus
