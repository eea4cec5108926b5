#include <glm/common.hpp>

#include "meniscus/base.h"

namespace meniscus {

vec3 direction_of(Axis axis) {
  switch (axis) {
    case Axis::x:
      return {1, 0, 0};
    case Axis::y:
      return {0, 1, 0};
    case Axis::z:
      break;
  }
  return {0, 0, 1};
}

std::string_view name_of(Axis axis) {
  switch (axis) {
    case Axis::x:
      return "x";
    case Axis::y:
      return "y";
    case Axis::z:
      break;
  }
  return "z";
}

void Bounds::add(vec3 point) {
  low = glm::min(low, point);
  high = glm::max(high, point);
}

void Bounds::add(const Bounds& other) {
  low = glm::min(low, other.low);
  high = glm::max(high, other.high);
}

vec3 Bounds::centre() const { return empty() ? vec3{0} : 0.5f * low + 0.5f * high; }

vec3 Bounds::extent() const { return empty() ? vec3{0} : high - low; }

Bounds Bounds::grown(float margin) const {
  if (empty()) return *this;
  return {low - vec3{margin}, high + vec3{margin}};
}

}  // namespace meniscus
