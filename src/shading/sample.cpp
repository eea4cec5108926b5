#include "shading/sample.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "shading/schlick.h"

namespace meniscus {
namespace {

using formulas::Interface;

constexpr float kPerPi = 1.0f / std::numbers::pi_v<float>;
constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// The least cosine between normal and direction to the eye.
constexpr float kLeastCosine = 0.02f;
/// How far the far side of a body of water turns a ray back to its first direction.
constexpr float kBackFromDeep = 0.9f;
constexpr float kBackFromThin = 0.3f;
/// The sun's image is at least this wide, rad^2: its true width falls between pixels.
constexpr float kLeastGlareVariance = 1.2e-4f;
/// And at most this bright, in radiances of a white ground or so: brighter spots show every stair of an edge.
constexpr float kBrightestGlare = 24.0f;

float maximum(vec3 v) { return std::max(v.x, std::max(v.y, v.z)); }

}  // namespace

vec3 diffuse_light(const Environment& environment, vec3 normal, float wrap) {
  const float facing_sun = (glm::dot(normal, environment.sun_direction()) + wrap) / (1.0f + wrap);
  return kPerPi * (environment.irradiance(normal) + std::max(0.0f, facing_sun) * environment.sun_irradiance());
}

vec3 through_medium(vec3 behind, float path, const Material& material, vec3 light) {
  const vec3 sigma_t = material.extinction + material.scattering;
  const vec3 left = formulas::beer_lambert(sigma_t, path);
  // Single scattering under even light: integral of sigma_s exp(-sigma_t s) over the path.
  const vec3 albedo = material.scattering / glm::max(sigma_t, vec3{1e-20f});
  return behind * left + material.body * light * albedo * (1.0f - left);
}

vec3 glare(const Environment& environment, vec3 direction, float variance) {
  const vec3 sun = environment.sun_glare(direction, variance + kLeastGlareVariance);
  const float peak = maximum(sun);
  return peak > 0 ? sun * (kBrightestGlare / (kBrightestGlare + peak)) : sun;
}

Mirror mirror_of(const Sample& sample, const Material& material) {
  Mirror mirror;
  mirror.ray = {sample.ray.origin + sample.depth * sample.ray.direction,
                glm::normalize(formulas::mirrored(sample.ray.direction, sample.normal))};
  // A mirror turns by twice the angle of its normal; roughness adds its own cone.
  const float cone = 0.8f * material.roughness * material.roughness;
  const float slopes = 2.0f * std::sqrt(sample.normal_variance);
  mirror.beam = {sample.beam.width + sample.beam.spread * sample.depth, sample.beam.spread + slopes + 2.0f * cone};
  mirror.variance = cone * cone + 0.25f * slopes * slopes;
  mirror.roughness = mirror.variance > 1e-6f ? std::min(std::sqrt(std::sqrt(mirror.variance) / 0.8f), 1.0f) : 0.0f;
  return mirror;
}

vec3 mirrored_sun(const Sample& sample, const Mirror& mirror, const Scene& scene) {
  const Environment& environment = scene.environment();
  if (!(glm::dot(sample.normal, environment.sun_direction()) > 0)) return vec3{0.0f};
  return glare(environment, mirror.ray.direction, mirror.variance);
}

namespace {

/// What a mirror of the sample's normal and the material's roughness shows: solids, sky and sun.
vec3 mirror_image(const Sample& sample, const Scene& scene, const Material& material) {
  const Mirror mirror = mirror_of(sample, material);
  return scene.radiance(mirror.ray, mirror.beam, mirror.roughness) + mirrored_sun(sample, mirror, scene);
}

}  // namespace

Contact contact_of(const Sample& sample, const Scene& scene) {
  Contact contact;
  const float down = -glm::dot(sample.normal, scene.ground().up);
  if (down <= 0.17f) return contact;
  contact.straight = scene.distance(sample.ray, sample.depth) - sample.depth;
  if (!(contact.straight >= 0 && contact.straight < kInfinity)) return contact;
  const float thicknesses = contact.straight / std::max(sample.thickness, 1e-20f);
  contact.weight = glm::smoothstep(0.17f, 0.42f, down) * (1.0f - glm::smoothstep(1.0f, 3.0f, thicknesses));
  return contact;
}

vec3 floor_radiance(const Sample& sample, const Contact& contact, const Scene& scene, const Material& material) {
  const Refraction refraction = refraction_of(sample, material);
  const vec3 floor =
      scene.radiance({refraction.point, sample.ray.direction}, refraction.beam(sample, contact.straight));
  return through_medium(floor, contact.straight, material, diffuse_light(scene.environment(), sample.normal, 0.5f));
}

Refraction refraction_of(const Sample& sample, const Material& material) {
  Refraction result;
  result.point = sample.ray.origin + sample.depth * sample.ray.direction;
  result.cos_i = -glm::dot(sample.ray.direction, sample.normal);
  const Interface interface = interface_of(result.cos_i, material.ior, sample.fresnel);
  result.cos_t = interface.cos_t;
  result.reflectance = std::min(1.0f, interface.reflectance * material.specular);
  result.direction = formulas::refracted(sample.ray.direction, sample.normal, material.ior, interface.cos_t);
  result.slopes = (1.0f - 1.0f / material.ior) * std::sqrt(sample.normal_variance);
  return result;
}

float Refraction::water_path(const Sample& sample, float to_solid) const {
  if (!(sample.thickness > 0)) return to_solid;
  return std::min(sample.thickness * cos_i / cos_t, to_solid);
}

Beam Refraction::beam(const Sample& sample, float path) const {
  return {sample.beam.width + sample.beam.spread * (sample.depth + path) + slopes * path, sample.beam.spread + slopes};
}

vec3 facing(vec3 normal, vec3 direction) {
  const float length = glm::dot(normal, normal);
  if (!(length > 1e-12f) || !(length < 1e12f)) return -direction;
  normal /= std::sqrt(length);
  const float along = glm::dot(normal, direction);
  if (along <= -kLeastCosine) return normal;
  // Keep the tangential part, set the part along the ray.
  const vec3 tangential = normal - along * direction;
  const float rest = glm::dot(tangential, tangential);
  if (!(rest > 1e-8f)) return -direction;
  return tangential * std::sqrt((1.0f - kLeastCosine * kLeastCosine) / rest) - kLeastCosine * direction;
}

Material tinted(const Material& material, vec3 colour) {
  Material result = material;
  const auto channel = [](float value) { return value > 0 ? std::min(value, 1.0f) : 0.0f; };
  const vec3 valid{channel(colour.x), channel(colour.y), channel(colour.z)};
  result.body = valid;
  if (!material.transparent) return result;
  // The colour is what is left of white light after the depth over which the material itself tints; half of what is
  // lost is scattered, so that coloured liquids have a body.
  const float strength = maximum(material.extinction + material.scattering);
  result.extinction = -0.5f * strength * glm::log(glm::max(valid, vec3{0.02f}));
  result.scattering = glm::max(vec3{0.6f * strength}, material.scattering);
  return result;
}

vec3 transparent_radiance(const Sample& sample, const Scene& scene, const Material& material) {
  const vec3 direction = sample.ray.direction;
  const Refraction refraction = refraction_of(sample, material);
  const vec3 point = refraction.point, inside = refraction.direction;

  // Thickness was measured along the straight ray; between two parallel faces the refracted ray takes a shorter way.
  // Water that stands on the ground, or on something else, ends there.
  float path = sample.thickness * refraction.cos_i / refraction.cos_t;
  const float to_ground = scene.distance({point, inside});
  const bool on_ground = to_ground <= path;
  if (on_ground) path = to_ground;

  // What the far side does is not known: parallel faces give the ray its first direction back, a round drop bends it
  // once more. Deep bodies are mostly taken for the first, thin ones (drops, crests) for the second; deep means that
  // they are seen to be tinted.
  const float back = glm::mix(kBackFromThin, kBackFromDeep,
                              glm::smoothstep(0.1f, 0.7f, maximum(material.extinction) * sample.thickness));
  const vec3 onward = glm::normalize(glm::mix(inside, direction, on_ground ? 0.0f : back));
  const Beam beam = refraction.beam(sample, path);
  const vec3 light = diffuse_light(scene.environment(), sample.normal, 0.5f);
  vec3 transmitted{0};
  const Contact contact = contact_of(sample, scene);
  if (contact.weight < 1.0f) {
    const vec3 behind = scene.radiance({on_ground ? point : point + path * inside, onward}, beam);
    transmitted = through_medium(behind, path, material, light);
  }
  if (contact.weight > 0.0f) {
    const vec3 floor = scene.radiance({point, direction}, beam);
    transmitted = glm::mix(transmitted, through_medium(floor, contact.straight, material, light), contact.weight);
  }
  if (refraction.reflectance <= 0) return transmitted;
  return glm::mix(transmitted, mirror_image(sample, scene, material), refraction.reflectance);
}

vec3 opaque_radiance(const Sample& sample, const Scene& scene, const Material& material) {
  const vec3 diffuse = material.body * diffuse_light(scene.environment(), sample.normal, 0.0f);
  if (!(material.specular > 0)) return diffuse;
  const float cos_i = -glm::dot(sample.ray.direction, sample.normal);
  const Interface interface = interface_of(cos_i, material.ior, sample.fresnel);
  const float reflectance = std::min(1.0f, interface.reflectance * material.specular);
  return glm::mix(diffuse, mirror_image(sample, scene, material), reflectance);
}

vec3 deep_radiance(const Ray& ray, Beam beam, const Scene& scene, const Material& material) {
  const vec3 light = diffuse_light(scene.environment(), scene.ground().up, 0.5f);
  const float to_solid = scene.distance(ray);
  // An endless path through a channel that neither absorbs nor scatters shows what is behind.
  const float path = to_solid < kInfinity ? to_solid : 1e30f;
  return through_medium(scene.radiance(ray, beam), path, material, light);
}

vec3 window_radiance(const Sample& sample, const Scene& scene, const Material& material) {
  const vec3 direction = sample.ray.direction;
  // A solid may be nearer than the surface.
  if (scene.distance(sample.ray) <= sample.depth) return deep_radiance(sample.ray, sample.beam, scene, material);

  const vec3 point = sample.ray.origin + sample.depth * direction;
  const float eta = 1.0f / material.ior;
  const Interface interface = interface_of(-glm::dot(direction, sample.normal), eta, sample.fresnel);
  const Beam beam{sample.beam.width + sample.beam.spread * sample.depth,
                  sample.beam.spread + 2.0f * std::sqrt(sample.normal_variance)};
  vec3 seen =
      deep_radiance({point, glm::normalize(formulas::mirrored(direction, sample.normal))}, beam, scene, material);
  if (interface.reflectance < 1.0f) {
    const vec3 outside = formulas::refracted(direction, sample.normal, eta, interface.cos_t);
    vec3 sky = scene.radiance({point, outside}, beam, std::min(1.0f, material.roughness));
    sky += glare(scene.environment(), outside, 0.25f * sample.normal_variance);
    seen = glm::mix(sky, seen, interface.reflectance);
  }
  const vec3 light = diffuse_light(scene.environment(), scene.ground().up, 0.5f);
  return through_medium(seen, sample.depth, material, light);
}

}  // namespace meniscus
