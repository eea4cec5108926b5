/// Scenes and surfaces whose radiance is known in closed form.
#pragma once

#include <cmath>
#include <glm/geometric.hpp>

#include "../scene/hdr_writing.h"
#include "meniscus/shading.h"

namespace meniscus::tests {

/// The same radiance from everywhere, no sun.
inline Environment uniform_environment(vec3 radiance = vec3{1.0f}) {
  const TemporaryFile file(flat_hdr(16, 8, [&](int, int) { return radiance; }));
  EnvironmentOptions options;
  options.hdr_path = file.path();
  return Environment(options);
}

/// White from above, black from below, no sun.
inline Environment half_lit_environment() {
  const TemporaryFile file(flat_hdr(64, 512, [](int, int y) { return y < 256 ? vec3{1.0f} : vec3{0.0f}; }));
  EnvironmentOptions options;
  options.hdr_path = file.path();
  return Environment(options);
}

inline Scene without_ground(Environment environment) {
  Ground ground;
  ground.visible = false;
  return Scene(std::move(environment), ground);
}

/// A view straight along `direction` onto the origin, from 5 m.
inline View looking(vec3 direction, int width = 8, int height = 6) {
  const vec3 unit = glm::normalize(direction);
  return orthographic_view(-5.0f * unit, vec3{0.0f}, {0.1f, 1, 0.3f}, 1e-4f, width, height);
}

/// Every sample shows the same surface.
inline SurfaceBuffers even(int width, int height, float depth, vec3 normal, float thickness) {
  SurfaceBuffers buffers;
  buffers.depth = Image<float>(width, height, depth);
  buffers.normal = Image<vec3>(width, height, normal);
  buffers.thickness = Image<float>(width, height, thickness);
  buffers.coverage = Image<float>(width, height, 1.0f);
  return buffers;
}

/// A material that is a bare interface: no absorption, no scattering.
inline Material clear(float ior = 1.333f) {
  Material material;
  material.ior = ior;
  return material;
}

/// Fresnel's reflectance by the sine and tangent laws, in double precision.
inline double reflectance(double angle, double eta) {
  if (angle < 1e-6) return std::pow((eta - 1) / (eta + 1), 2);
  const double behind = std::asin(std::sin(angle) / eta);
  return 0.5 * (std::pow(std::sin(angle - behind) / std::sin(angle + behind), 2) +
                std::pow(std::tan(angle - behind) / std::tan(angle + behind), 2));
}

}  // namespace meniscus::tests
