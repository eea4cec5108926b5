/// From what is seen of the water and of the scene to radiance.
#pragma once

#include "meniscus/base.h"
#include "meniscus/scene.h"
#include "meniscus/surface.h"

namespace meniscus {

/// What the liquid looks like.
struct Material {
  std::string name = "water";
  bool transparent = true;  ///< false: an opaque body of `body` colour
  float ior = 1.333f;       ///< index of refraction, > 1
  vec3 extinction{0.0f};    ///< absorption, 1/m per channel (Beer-Lambert)
  vec3 scattering{0.0f};    ///< turbidity, 1/m per channel: what is scattered shows `body`
  vec3 body{0.8f};          ///< linear colour of the diffuse part
  float roughness = 0.0f;   ///< of the reflection, 0 mirror .. 1
  float specular = 1.0f;    ///< factor of the Fresnel reflection; 0 switches it off (clay)
};

/// A preset: water, milk, oil, ink, clay, plastic (opaque and coloured), ...
/// @param scale  m: a depth over which clear water of this scene should be seen to be tinted
/// @throws Error invalid_argument naming the presets
Material material_preset(std::string_view name, float scale);
std::vector<std::string> material_names();

/// Radiance, linear, of every picture point: water over scene. Where coverage is fractional both are mixed.
/// @param points  as given to Surface::see; empty: pixel centres
Image<vec3> shade(const View& view, std::span<const vec2> points, const SurfaceBuffers& water, const Scene& scene,
                  const Material& material, StageTimes* times = nullptr);

/// The water's soft shadow on the ground: the surface's thickness seen from the sun, with Fresnel and
/// Beer-Lambert losses, blurred by the sun's size, and the sky light that the water takes away around it.
/// @param region  where the water mostly is, m, so that a few drops far away do not coarsen it; empty: all of it
std::shared_ptr<const GroundLight> ground_light(const Surface& surface, const Environment& environment,
                                                const Ground& ground, const Material& material,
                                                StageTimes* times = nullptr, const Bounds& region = {});

}  // namespace meniscus
