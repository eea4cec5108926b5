/// The axes of what lies over a horizontal grid.
#pragma once

#include "meniscus/base.h"

namespace meniscus {

/// Indices of the axes in a vec3: a and b in the order x, y, z, and up.
struct FieldAxes {
  int a, b, up;
  explicit FieldAxes(Axis axis) : a(axis == Axis::x ? 1 : 0), b(axis == Axis::z ? 1 : 2), up(static_cast<int>(axis)) {}

  vec3 place(float along_a, float along_b, float along_up) const {
    vec3 p{0.0f};
    p[a] = along_a;
    p[b] = along_b;
    p[up] = along_up;
    return p;
  }
};

}  // namespace meniscus
