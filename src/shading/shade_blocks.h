/// Pictures of water seen from the air, refracted by its thickness, shaded many pixels at a time.
#pragma once

#include "meniscus/shading.h"
#include "shading/normal_variance.h"

namespace meniscus {

/// What shade() was asked for.
struct ShadeInputs {
  const View& view;
  std::span<const vec2> points;
  const SurfaceBuffers& water;
  const Scene& scene;
  const Material& material;
  const OpticsInputs& optics;
  const NormalVariance& variance;
  const SceneBuffers* behind;  ///< of the same pixels; null: rays
  Beam beam;                   ///< of a pixel
};

/// The sun's disc, at least a pixel wide.
vec3 sun_disc(const Ray& ray, Beam beam, const Scene& scene);

/// Whether shade_pixels() can do this.
bool takes_blocks(const ShadeInputs& inputs);
/// Radiance of the pixels [begin, end), by transparent_radiance() or opaque_radiance() to rounding. Without panes of
/// glass before it.
void shade_pixels(const ShadeInputs& inputs, std::size_t begin, std::size_t end, vec3* picture);

}  // namespace meniscus
