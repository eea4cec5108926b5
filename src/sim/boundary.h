/// What the water runs against: the tank's walls and the obstacles, as one particle meets them.
#pragma once

#include "meniscus/base.h"

namespace meniscus {

/// A wall near a point: solid is everything beyond a plane.
struct Wall {
  float distance = 0;   ///< m, of the point from the wall; negative: inside the solid
  vec3 normal{0.0f};    ///< unit, out of the solid
  vec3 velocity{0.0f};  ///< m/s, of the solid there
  int body = -1;        ///< index of the obstacle; -1: the tank
};

/// What the water does to a body in one step.
struct Impulse {
  vec3 linear{0.0f};   ///< N s
  vec3 angular{0.0f};  ///< N m s, about the body's centre
};

class Boundary {
 public:
  static constexpr int kMostWalls = 8;
  virtual ~Boundary() = default;
  /// The walls within `reach` m of the point, nearest first where there are more than kMostWalls; how many.
  /// Called from many threads at once.
  virtual int walls_near(vec3 point, float reach, Wall (&walls)[kMostWalls]) const = 0;
  /// False: no point of the box is within `reach` m of a wall. Asked for many particles at once, it saves asking each.
  virtual bool may_touch(const Bounds& box, float reach) const {
    static_cast<void>(box), static_cast<void>(reach);
    return true;
  }
  /// Obstacles, present or not.
  virtual std::size_t bodies() const = 0;
  /// Centre of mass of an obstacle, m.
  virtual vec3 centre(std::size_t body) const = 0;
};

}  // namespace meniscus
