/// Small tanks, and what is looked at in them.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <glm/geometric.hpp>

#include "meniscus/sim.h"

namespace meniscus {

/// 0.4 x 0.3 x 0.2 m with water up to `depth` m; spacing 0.02 m.
inline SimulationOptions small_tank(float depth = 0.14f) {
  SimulationOptions options;
  options.fluid.spacing = 0.02f;
  options.tank = {{0, 0, 0}, {0.4f, 0.3f, 0.2f}};
  if (depth > 0) options.blocks = {{{0, 0, 0}, {0.4f, depth, 0.2f}}};
  return options;
}

inline ObstacleOptions obstacle_of(ObstacleShape::Kind kind, vec3 size, vec3 position) {
  ObstacleOptions options;
  options.shape.kind = kind;
  options.shape.size = size;
  options.pose.position = position;
  return options;
}

/// Every particle is a number and between the walls of the tank.
inline void expect_inside(const Particles& particles, const Bounds& tank, Axis up = Axis::y) {
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const vec3 p = particles.position(i);
    for (int axis = 0; axis < 3; ++axis) {
      ASSERT_GE(p[axis], tank.low[axis]);
      if (axis != static_cast<int>(up)) {
        ASSERT_LE(p[axis], tank.high[axis]);
      }
    }
    ASSERT_LT(p[static_cast<int>(up)], tank.high[static_cast<int>(up)] + 10);
  }
}

inline float fastest(const Particles& particles) {
  const std::vector<float>& v = particles.find("velocity")->values;
  float most = 0;
  for (std::size_t i = 0; i < v.size(); i += 3) most = std::max(most, glm::length(vec3(v[i], v[i + 1], v[i + 2])));
  return most;
}

/// How deep in a ball the deepest particle is, m.
inline float depth_in_ball(const Particles& particles, vec3 centre, float radius) {
  float depth = 0;
  for (std::size_t i = 0; i < particles.size(); ++i)
    depth = std::max(depth, radius - glm::distance(particles.position(i), centre));
  return depth;
}

}  // namespace meniscus
