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
