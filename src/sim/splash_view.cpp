#include "sim/splash_view.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace meniscus {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

/// Unit vector along which the view sees a point.
vec3 seen_along(const View& view, vec3 point) {
  if (view.projection == Projection::orthographic) return view.forward;
  const vec3 way = point - view.eye;
  const float length = glm::length(way);
  return length > 0 ? way / length : view.forward;
}

}  // namespace

bool may_show(const View& view, vec3 centre, float radius) {
  if (view.projection == Projection::cube) return true;
  const vec3 p = centre - view.eye;
  const float x = std::abs(glm::dot(p, view.right)), y = std::abs(glm::dot(p, view.up)), z = glm::dot(p, view.forward);
  if (z < -radius) return false;
  // Half the picture's sizes with a pixel around.
  const float grown = 1 + 2 / static_cast<float>(std::max(view.height, 1));
  const float high = view.half_height * grown;
  const float wide =
      view.half_height * static_cast<float>(view.width + 2) / static_cast<float>(std::max(view.height, 1));
  if (view.projection == Projection::orthographic) return x <= wide + radius && y <= high + radius;
  return x - z * wide <= radius * std::sqrt(1 + wide * wide) && y - z * high <= radius * std::sqrt(1 + high * high);
}

float covered_area(const WaterPiece& piece, vec3 direction) {
  switch (piece.kind) {
    case WaterPiece::Kind::sphere:
      return piece.opacity * kPi * piece.radius * piece.radius;
    case WaterPiece::Kind::disk:
      return piece.opacity * kPi * piece.radius * piece.radius * std::abs(glm::dot(piece.across, direction));
    case WaterPiece::Kind::pyramid: {
      const vec3 axis = piece.to - piece.from;
      const float length = glm::length(axis);
      if (!(length > 0)) return 0;
      const vec3 a = piece.across, b = glm::cross(axis / length, a);
      const vec3 corners[] = {a, b, -a, -b};
      float sum = 2 * std::abs(glm::dot(glm::cross(a, b), direction));
      for (int i = 0; i < 4; ++i)
        sum += 0.5f * std::abs(glm::dot(glm::cross(corners[i] - axis, corners[(i + 1) % 4] - corners[i]), direction));
      return piece.opacity * 0.5f * sum;
    }
    case WaterPiece::Kind::streak:
      return piece.opacity * piece.radius *
             (2 * glm::length(glm::cross(piece.to - piece.from, direction)) + kPi * piece.radius);
  }
  return 0;
}

WaterPiece merged(std::span<const WaterPiece> pieces, const View& view) {
  const vec3 first = pieces.front().from;
  const vec3 direction = seen_along(view, first);
  float sum = 0;
  vec3 moment(0.0f);  // about the first, so that nothing is lost far from the origin
  for (const WaterPiece& piece : pieces) {
    const float area = covered_area(piece, direction);
    const vec3 middle = piece.kind == WaterPiece::Kind::pyramid  ? piece.from + (piece.to - piece.from) / 3.0f
                        : piece.kind == WaterPiece::Kind::streak ? 0.5f * (piece.from + piece.to)
                                                                 : piece.from;
    sum += area;
    moment += area * (middle - first);
  }
  WaterPiece sphere;
  sphere.from = sum > 0 ? first + moment / sum : first;
  sphere.radius = std::sqrt(sum / kPi);
  return sphere;
}

}  // namespace meniscus
