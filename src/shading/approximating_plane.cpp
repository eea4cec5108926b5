#include "shading/approximating_plane.h"

#include <cmath>
#include <glm/geometric.hpp>

namespace meniscus {

float ApproximatingPlane::height(vec3 at) const { return glm::dot(at - point, normal); }

vec3 ApproximatingPlane::projected(vec3 at) const { return at - height(at) * normal; }

vec3 reflected_eye(const ApproximatingPlane& plane, vec3 eye) { return eye - 2.0f * plane.height(eye) * plane.normal; }

std::optional<vec3> snell(vec3 incident, vec3 normal, float ratio) {
  const float along = glm::dot(incident, normal);
  const float k = 1.0f - ratio * ratio * (1.0f - along * along);
  if (!(k > 0)) return std::nullopt;
  return glm::normalize(ratio * incident - (ratio * along + std::sqrt(k)) * normal);
}

vec3 refraction_point(const ApproximatingPlane& plane, vec3 eye, vec3 target, float ratio) {
  const glm::dvec3 foot(plane.projected(eye)), end(plane.projected(target));
  const double above = std::abs(static_cast<double>(plane.height(eye)));
  const double below = std::abs(static_cast<double>(plane.height(target)));
  const double way = glm::length(end - foot);
  if (!(way > 0)) return vec3(foot);
  // ratio sin_i - sin_t rises with the distance from the eye's foot.
  double low = 0, high = way;
  for (int i = 0; i < 60; ++i) {
    const double x = 0.5 * (low + high), rest = way - x;
    const double sin_i = x / std::hypot(x, above), sin_t = rest / std::hypot(rest, below);
    (static_cast<double>(ratio) * sin_i < sin_t ? low : high) = x;
  }
  return vec3(foot + (0.5 * (low + high) / way) * (end - foot));
}

std::optional<vec3> refracted_eye(const ApproximatingPlane& plane, vec3 eye, vec3 a, float ratio) {
  const vec3 way = a - eye;
  const float length = glm::length(way);
  if (!(length > 0)) return std::nullopt;
  const auto direction = snell(way / length, plane.normal, ratio);
  if (!direction) return std::nullopt;
  return a - length * *direction;
}

std::optional<vec3> entry_of(const ApproximatingPlane& plane, vec3 eye, vec3 direction, float ratio) {
  const float along = glm::dot(direction, plane.normal);
  if (!(along < 0)) return std::nullopt;
  const vec3 tangential = (direction - along * plane.normal) / ratio;
  const float rest = 1.0f - glm::dot(tangential, tangential);
  if (!(rest > 1e-8f)) return std::nullopt;
  const vec3 incident = tangential - std::sqrt(rest) * plane.normal;
  return eye + (plane.height(eye) / std::sqrt(rest)) * incident;
}

}  // namespace meniscus
