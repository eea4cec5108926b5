#include "shading/trapezium.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "shading/water_object_shape.h"

namespace meniscus {
namespace {

/// Half widths by the object's size: of what it covers seen from above, waves beside it move its picture.
constexpr float kAtObject = 1.5f, kAtEye = 1.75f;
/// The inner part of the half width in which the weight is one.
constexpr float kCore = 0.7f;

}  // namespace

Trapezium::Trapezium(const WaterObject& object, vec2 eye, Axis up, const VirtualEyeOptions& options) {
  const vec2 low = horizontal(object.bounds.low, up), high = horizontal(object.bounds.high, up);
  const vec2 centre = 0.5f * (low + high), way = eye - centre;
  const float distance = glm::length(way);
  towards_ = distance > 0 ? way / distance : vec2{1, 0};
  const vec2 across{-towards_.y, towards_.x};
  const vec2 half = 0.5f * (high - low);
  const float half_across = std::abs(half.x * across.x) + std::abs(half.y * across.y);
  const float half_along = std::abs(half.x * towards_.x) + std::abs(half.y * towards_.y);
  a_ = options.trapezium_a > 0 ? options.trapezium_a : kAtObject * std::max(half_across, 0.25f * half_along);
  b_ = options.trapezium_b > 0 ? options.trapezium_b : kAtEye * std::max(half_across, 0.25f * half_along);
  start_ = centre - half_along * towards_;
  length_ = distance + half_along;
  soft_ = std::max(0.5f * half_along, 0.25f * a_);
  everywhere_ = distance < half_along;
}

float Trapezium::weight(vec2 m) const {
  if (everywhere_) return 1.0f;
  const vec2 offset = m - start_;
  const float along = glm::dot(offset, towards_), across = std::abs(offset.x * -towards_.y + offset.y * towards_.x);
  if (along <= -soft_) return 0.0f;
  const float half = glm::mix(a_, b_, std::clamp(along / length_, 0.0f, 1.0f));
  const float beside = 1.0f - glm::smoothstep(kCore * half, half, across);
  return along >= 0 ? beside : beside * glm::smoothstep(-soft_, 0.0f, along);
}

}  // namespace meniscus
