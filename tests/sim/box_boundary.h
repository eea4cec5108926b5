/// The walls of a box, open above, and bodies that are balls or plates: what the solvers are tested against.
#pragma once

#include <algorithm>

#include "sim/fluid.h"

namespace meniscus {

/// Six or five walls of a tank.
class BoxBoundary : public Boundary {
 public:
  explicit BoxBoundary(Bounds box) : box_(box) {}
  int walls_near(vec3 point, float reach, Wall (&walls)[kMostWalls]) const override {
    int count = 0;
    for (int axis = 0; axis < 3; ++axis)
      for (const float side : {1.0f, -1.0f}) {
        if (axis == 1 && side < 0) continue;  // open above
        const float distance = side > 0 ? point[axis] - box_.low[axis] : box_.high[axis] - point[axis];
        if (distance > reach) continue;
        vec3 normal{0.0f};
        normal[axis] = side;
        walls[count++] = {distance, normal, vec3{0.0f}, -1};
      }
    std::sort(walls, walls + count, [](const Wall& a, const Wall& b) { return a.distance < b.distance; });
    return count;
  }
  std::size_t bodies() const override { return 0; }
  vec3 centre(std::size_t) const override { return vec3{0.0f}; }

 private:
  Bounds box_;
};

/// A ball without a tank, moving and turning.
class BallBoundary : public Boundary {
 public:
  BallBoundary(vec3 centre, float radius, vec3 velocity, vec3 turn)
      : centre_(centre), radius_(radius), velocity_(velocity), turn_(turn) {}
  int walls_near(vec3 point, float reach, Wall (&walls)[kMostWalls]) const override {
    const vec3 away = point - centre_;
    const float distance = length(away) - radius_;
    if (distance > reach) return 0;
    const vec3 normal = normalize(away);
    walls[0] = {distance, normal, velocity_ + cross(turn_, radius_ * normal), 0};
    return 1;
  }
  std::size_t bodies() const override { return 1; }
  vec3 centre(std::size_t) const override { return centre_; }

 private:
  vec3 centre_;
  float radius_;
  vec3 velocity_, turn_;
};

/// Sum of m v and of x cross m v, in double precision.
struct Momentum {
  glm::dvec3 linear{0.0}, angular{0.0};
};
inline Momentum momentum_of(const Fluid& fluid, double mass, vec3 centre) {
  Momentum sum;
  for (std::size_t i = 0; i < fluid.size(); ++i) {
    const glm::dvec3 v = mass * glm::dvec3(fluid.vx[i], fluid.vy[i], fluid.vz[i]);
    sum.linear += v;
    sum.angular += glm::cross(glm::dvec3(fluid.x[i], fluid.y[i], fluid.z[i]) - glm::dvec3(centre), v);
  }
  return sum;
}

/// A lattice of water within a box, half a spacing from its sides.
inline Fluid block_of_water(Bounds box, float spacing) {
  Fluid fluid;
  const vec3 extent = box.extent();
  for (int k = 0; k < static_cast<int>(extent.z / spacing + 0.5f); ++k)
    for (int j = 0; j < static_cast<int>(extent.y / spacing + 0.5f); ++j)
      for (int i = 0; i < static_cast<int>(extent.x / spacing + 0.5f); ++i)
        fluid.add(box.low + spacing * (vec3(i, j, k) + 0.5f), vec3{0.0f});
  return fluid;
}

inline double kinetic_energy(const Fluid& fluid, double mass) {
  double sum = 0;
  for (std::size_t i = 0; i < fluid.size(); ++i)
    sum += 0.5 * mass *
           (double(fluid.vx[i]) * fluid.vx[i] + double(fluid.vy[i]) * fluid.vy[i] + double(fluid.vz[i]) * fluid.vz[i]);
  return sum;
}
inline double potential_energy(const Fluid& fluid, double mass) {
  double sum = 0;
  for (std::size_t i = 0; i < fluid.size(); ++i) sum += 9.81 * mass * fluid.y[i];
  return sum;
}

}  // namespace meniscus
