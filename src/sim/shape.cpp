#include "sim/shape.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>

namespace meniscus {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

class Box final : public Shape {
 public:
  explicit Box(vec3 size) : half_(size * 0.5f) {
    bounds_ = {-half_, half_};
    radius_ = glm::length(half_);
    volume_ = size.x * size.y * size.z;
    const vec3 s = size * size;
    inertia_rel_ = vec3(s.y + s.z, s.z + s.x, s.x + s.y) / 12.0f;
    // A lattice on all six faces, each point once.
    constexpr int kEdge = 4;
    for (int k = 0; k <= kEdge; ++k)
      for (int j = 0; j <= kEdge; ++j)
        for (int i = 0; i <= kEdge; ++i)
          if (i == 0 || i == kEdge || j == 0 || j == kEdge || k == 0 || k == kEdge)
            touch_points_.push_back((vec3(i, j, k) * (2.0f / kEdge) - 1.0f) * half_);
  }

  NearestSurface nearest(vec3 point) const override {
    const vec3 q = glm::abs(point) - half_;
    const vec3 sign{point.x < 0 ? -1.0f : 1.0f, point.y < 0 ? -1.0f : 1.0f, point.z < 0 ? -1.0f : 1.0f};
    const vec3 out = glm::max(q, vec3(0.0f));
    const float distance = glm::length(out);
    if (distance > 0) return {distance, sign * out / distance};
    // Inside: the nearest face.
    if (q.x >= q.y && q.x >= q.z) return {q.x, {sign.x, 0, 0}};
    if (q.y >= q.z) return {q.y, {0, sign.y, 0}};
    return {q.z, {0, 0, sign.z}};
  }

 private:
  vec3 half_;
};

class Sphere final : public Shape {
 public:
  explicit Sphere(float radius) {
    radius_ = radius;
    bounds_ = {vec3(-radius), vec3(radius)};
    volume_ = 4.0f / 3.0f * kPi * radius * radius * radius;
    inertia_rel_ = vec3(0.4f * radius * radius);
    touch_points_ = {vec3(0.0f)};
    touch_radius_ = radius;
  }

  NearestSurface nearest(vec3 point) const override {
    const float length = glm::length(point);
    return {length - radius_, length > 0 ? point / length : vec3(0, 1, 0)};
  }
};

/// Along y.
class Cylinder final : public Shape {
 public:
  Cylinder(float radius, float length) : rim_(radius), half_(length / 2) {
    bounds_ = {{-radius, -half_, -radius}, {radius, half_, radius}};
    radius_ = std::hypot(radius, half_);
    volume_ = kPi * radius * radius * length;
    const float across = (3 * radius * radius + length * length) / 12;
    inertia_rel_ = {across, radius * radius / 2, across};
    constexpr int kAround = 16, kAlong = 4;
    for (int j = 0; j <= kAlong; ++j)
      for (int i = 0; i < kAround; ++i) {
        const float angle = 2 * kPi * static_cast<float>(i) / kAround;
        const float y = (2 * static_cast<float>(j) / kAlong - 1) * half_;
        touch_points_.push_back({radius * std::cos(angle), y, radius * std::sin(angle)});
      }
    touch_points_.push_back({0, half_, 0});
    touch_points_.push_back({0, -half_, 0});
  }

  NearestSurface nearest(vec3 point) const override {
    // A rectangle in the half-plane of the distance from the axis and the height.
    const float across = std::hypot(point.x, point.z);
    const vec3 outwards = across > 0 ? vec3(point.x, 0, point.z) / across : vec3(1, 0, 0);
    const vec3 along(0, point.y < 0 ? -1.0f : 1.0f, 0);
    const float a = across - rim_, b = std::abs(point.y) - half_;
    if (a > 0 && b > 0) {
      const float distance = std::hypot(a, b);
      return {distance, (outwards * a + along * b) / distance};
    }
    return a >= b ? NearestSurface{a, outwards} : NearestSurface{b, along};
  }

 private:
  float rim_, half_;
};

void check_size(float size, const char* what) {
  constexpr float kLeast = 1e-6f, kMost = 1e6f;
  if (size >= kLeast && size <= kMost) return;
  throw Error(ErrorCode::invalid_argument, {fmt::format("{} of an obstacle is out of range", what),
                                            fmt::format("{} to {} m", kLeast, kMost),
                                            fmt::format("{}", size),
                                            {},
                                            {},
                                            {},
                                            {}});
}

}  // namespace

bool Shape::nearest_within(vec3 point, float reach, NearestSurface& found) const {
  found = nearest(point);
  return found.distance <= reach;
}

std::unique_ptr<const Shape> make_shape(const ObstacleShape& shape) {
  switch (shape.kind) {
    case ObstacleShape::Kind::box:
      for (int i = 0; i < 3; ++i) check_size(shape.size[i], "an edge");
      return std::make_unique<Box>(shape.size);
    case ObstacleShape::Kind::sphere:
      check_size(shape.size.x, "the diameter");
      return std::make_unique<Sphere>(shape.size.x / 2);
    case ObstacleShape::Kind::cylinder:
      check_size(shape.size.x, "the diameter");
      check_size(shape.size.y, "the length");
      return std::make_unique<Cylinder>(shape.size.x / 2, shape.size.y);
    case ObstacleShape::Kind::mesh:
      break;
  }
  return make_mesh_shape(shape);
}

}  // namespace meniscus
