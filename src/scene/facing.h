/// Cosines of light on interpolated normals.
#pragma once

#include <algorithm>
#include <glm/geometric.hpp>

#include "meniscus/base.h"

namespace meniscus {

/// Cosine of light on a face with an interpolated normal, that goes to zero smoothly where the flat face itself turns
/// away, so that neither light leaks through nor facets show.                                          [Chiang2019]
inline float facing(vec3 normal, vec3 face_normal, vec3 towards_light) {
  const float cos_normal = glm::dot(normal, towards_light);
  if (!(cos_normal > 0)) return 0;
  const float cos_face = glm::dot(face_normal, towards_light);
  if (!(cos_face > 0)) return 0;
  const float agree = glm::dot(normal, face_normal);
  if (agree > 0.99999f) return cos_normal;
  const float g = std::min(1.0f, cos_face / (cos_normal * std::max(agree, 1e-4f)));
  return cos_normal * (g + g * g - g * g * g);
}

}  // namespace meniscus
