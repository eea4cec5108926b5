#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "shading/schlick.h"
#include "shading/virtual_eye.h"

namespace meniscus {
namespace {

/// A surface that leans more than this from the water's plane (its cosine) is a side of the water: the maps are not
/// made for it.
constexpr float kSide = 0.1f;
constexpr float kEndless = 1e30f;

/// What a look shows through clear air.
vec3 in_air(const EyeLook& look, vec3 environment) {
  const vec3 behind = look.still + (1.0f - look.still_alpha) * environment;
  return look.object + (1.0f - look.object_alpha) * behind;
}

/// What it shows through water.
/// @param most  m of water on the way at most
vec3 in_water(const EyeLook& look, vec3 environment, float most, const Material& material, vec3 light) {
  vec3 seen{0.0f};
  if (look.object_alpha < 1.0f) {
    const vec3 behind = look.still + (1.0f - look.still_alpha) * environment;
    const float path = std::min({look.still_distance, most, kEndless});
    seen = (1.0f - look.object_alpha) * through_medium(behind, path, material, light);
  }
  if (look.object_alpha > 0) {
    const vec3 shown = look.object / look.object_alpha;
    seen += look.object_alpha * through_medium(shown, look.object_distance, material, light);
  }
  return seen;
}

}  // namespace

vec3 virtual_eye_radiance(const Sample& sample, const VirtualEyes& eyes, const Scene& scene, const Material& material,
                          bool eye_in_water) {
  if (glm::dot(sample.normal, eyes.plane().normal) < kSide)
    return eye_in_water ? window_radiance(sample, scene, material) : transparent_radiance(sample, scene, material);
  const Environment& environment = scene.environment();
  const vec3 direction = sample.ray.direction;
  const vec3 light = diffuse_light(environment, sample.normal, 0.5f);
  if (eye_in_water) {
    // A solid may be nearer than the surface.
    if (scene.distance(sample.ray) <= sample.depth) return deep_radiance(sample.ray, sample.beam, scene, material);
    const vec3 point = sample.ray.origin + sample.depth * direction;
    const float eta = 1.0f / material.ior;
    const formulas::Interface interface = interface_of(-glm::dot(direction, sample.normal), eta, sample.fresnel);
    const vec3 mirrored = glm::normalize(formulas::mirrored(direction, sample.normal));
    vec3 seen{0.0f};
    if (interface.reflectance > 0)
      seen =
          in_water(eyes.reflected().look(point, mirrored), environment.radiance(mirrored), kEndless, material, light);
    if (interface.cos_t > 0) {
      const vec3 outside = formulas::refracted(direction, sample.normal, eta, interface.cos_t);
      vec3 sky = environment.radiance(outside, std::min(1.0f, material.roughness));
      sky = in_air(eyes.refracted().look(point, outside), sky);
      sky += glare(environment, outside, 0.25f * sample.normal_variance);
      seen = glm::mix(sky, seen, interface.reflectance);
    }
    return through_medium(seen, sample.depth, material, light);
  }

  const Refraction refraction = refraction_of(sample, material);
  vec3 seen{0.0f};
  if (refraction.reflectance < 1.0f) {
    const EyeLook look = eyes.refracted().look(refraction.point, refraction.direction);
    // Where nothing is met the thickness tells how much water there is.
    float most = kEndless;
    vec3 beyond{0.0f};
    if (look.still_alpha < 1.0f) beyond = environment.radiance(refraction.direction);
    if (!(look.still_alpha > 0)) most = refraction.water_path(sample, kEndless);
    seen = in_water(look, beyond, most, material, light);
  }
  if (!(refraction.reflectance > 0)) return seen;
  const Mirror mirror = mirror_of(sample, material);
  const vec3 sky = environment.radiance(mirror.ray.direction, mirror.roughness);
  vec3 image = in_air(eyes.reflected().look(refraction.point, mirror.ray.direction), sky);
  image += mirrored_sun(sample, mirror, scene);
  return glm::mix(seen, image, refraction.reflectance);
}

}  // namespace meniscus
