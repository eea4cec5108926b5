// Light on solids and what leaves them.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "meniscus/formulas.h"
#include "scene/direction_map.h"
#include "scene/facing.h"
#include "scene/scene_parts.h"

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kPerPi = 1.0f / std::numbers::pi_v<float>;
/// Half of the width of the sun's disc, radians.
constexpr float kSunRadius = 0.00465f;
constexpr float kBrightestGlare = 200.0f;
/// Radians: coats whose mirror images are blurred by less show bodies sharp.
constexpr float kSharpCoat = 0.008f;
/// Radiance of a lamp's mirror image below which nobody asks what stands before the lamp.
constexpr float kFaintestGlare = 1e-6f;

/// Points of the unit disc, the first four on its edge.
constexpr std::array<vec2, 16> kDisc{{{0.92f, 0.38f},
                                      {-0.38f, 0.92f},
                                      {-0.92f, -0.38f},
                                      {0.38f, -0.92f},
                                      {0.25f, 0.10f},
                                      {-0.10f, 0.25f},
                                      {-0.25f, -0.10f},
                                      {0.10f, -0.25f},
                                      {0.33f, 0.56f},
                                      {-0.56f, 0.33f},
                                      {-0.33f, -0.56f},
                                      {0.56f, -0.33f},
                                      {0.63f, 0.02f},
                                      {-0.02f, 0.63f},
                                      {-0.63f, -0.02f},
                                      {0.02f, -0.63f}}};

}  // namespace

void Scene::Parts::aim_at_sun() {
  const vec3 sun = environment.sun_direction();
  const UpFrame frame = up_frame(sun);
  for (std::size_t i = 0; i < kDisc.size(); ++i) {
    sun_offsets[i] = kDisc[i].x * frame.east + kDisc[i].y * frame.north;
    sun_points[i] = glm::normalize(sun + kSunRadius * sun_offsets[i]);
  }
  sun_path.direction = sun;
  sun_path.cone = 2.0f * kSunRadius;
  for (int face = kTankFace; face <= kGroundFace; ++face) {
    const auto i = static_cast<std::size_t>(face);
    plane_normals[i] = normal_of(face);
    plane_skies[i] = environment.irradiance(plane_normals[i]);
    plane_cosines[i] = facing(plane_normals[i], plane_normals[i], sun);
  }
}

Ray Scene::Parts::sun_ray(vec3 start, vec3 face_normal, float footprint, std::size_t number) const {
  // Starting points stay in the face, where they do not fall under it.
  vec3 beside = (0.5f * footprint) * sun_offsets[number];
  beside -= glm::dot(beside, face_normal) * face_normal;
  return {start + beside, sun_points[number]};
}

vec3 Scene::Parts::sun_seen(vec3 point, vec3 face_normal, float footprint) const {
  const vec3 sun = environment.sun_direction();
  const float away = clearance(point);
  const vec3 start = point + away * face_normal;
  vec3 light{1.0f};
  if (body) light = body->light_transmittance({start, sun}, kInfinity);
  if (!solids) return light;
  // A cone around the sun that starts as wide as what is averaged: four rays on its edge, more where they disagree.
  if (!solids->near({start, sun}, footprint, 2.0f * kSunRadius)) return light;
  int seen = 0;
  for (std::size_t first = 0; first < sun_points.size(); first += 4) {
    Ray rays[4];
    for (std::size_t k = 0; k < 4; ++k) rays[k] = sun_ray(start, face_normal, footprint, first + k);
    seen += std::popcount(static_cast<unsigned>(solids->passing(rays)));
    if (first == 0 && seen == 0) return vec3{0.0f};
    if (first == 0 && seen == 4) return light;
  }
  return light * (static_cast<float>(seen) / static_cast<float>(sun_points.size()));
}

vec3 Scene::Parts::irradiance(vec3 point, vec3 normal, vec3 face_normal, float footprint) const {
  WaterLight::Light light;
  if (water_light) light = water_light->at(point, normal);
  vec3 sum = light.sky * environment.irradiance(normal) + light.refracted;

  const float sun_facing = facing(normal, face_normal, environment.sun_direction());
  const vec3 sun = light.sun * environment.sun_irradiance() * sun_facing;
  if (sun != vec3{0.0f}) sum += (solids || body) ? sun * sun_seen(point, face_normal, footprint) : sun;

  if (!lamps.empty()) sum += lamp_irradiance(point, normal, face_normal, light.lamps);
  return sum;
}

vec3 Scene::Parts::lamp_irradiance(vec3 point, vec3 normal, vec3 face_normal, vec3 fraction) const {
  vec3 sum{0.0f};
  for (const PointLight& lamp : lamps) {
    const vec3 way = lamp.position - point;
    const float length = glm::length(way);
    if (!(length > 0)) continue;
    const vec3 towards = way / length;
    vec3 arrives = fraction * lamp.intensity * (facing(normal, face_normal, towards) / (length * length));
    if (arrives == vec3{0.0f}) continue;
    const Ray ray{point + clearance(point) * face_normal, towards};
    if (body) arrives *= body->light_transmittance(ray, length);
    if (solids && solids->blocks(ray, 0, length)) continue;
    sum += arrives;
  }
  return sum;
}

vec3 Scene::Parts::lamp_glare(vec3 point, const SolidHit& hit, vec3 direction, Beam beam) const {
  const float cos_out = -glm::dot(hit.normal, direction);
  if (!(cos_out > 0)) return vec3{0.0f};
  // Variance of the facets' slopes: a cone of mirrored rays is twice as wide as that of the normals. Not less than
  // what the beam spans and a lamp of a degree.
  const float sigma = 0.4f * hit.roughness * hit.roughness;
  const float alpha2 = 2.0f * (sigma * sigma + 0.02f * beam.spread * beam.spread) + 1.5e-5f;
  const auto smith = [&](float c) { return std::sqrt(alpha2 + (1.0f - alpha2) * c * c); };
  const float smith_out = smith(cos_out);
  vec3 sum{0.0f};
  vec3 fraction{-1.0f};
  for (const PointLight& lamp : lamps) {
    const vec3 way = lamp.position - point;
    const float length2 = glm::dot(way, way);
    if (!(length2 > 0)) continue;
    const float length = std::sqrt(length2);
    const vec3 towards = way / length;
    const float cos_in = glm::dot(hit.normal, towards);
    if (!(cos_in > 0) || !(glm::dot(hit.face_normal, towards) > 0)) continue;
    const vec3 between = towards - direction;
    const float between_length = glm::length(between);
    if (!(between_length > 1e-6f)) continue;
    const vec3 half = between / between_length;
    const float cos_half = glm::dot(hit.normal, half);
    // Facets as [Walter2007] eq. 20, 23, 33, 34; the shadowing's denominators cancel.
    const float d = cos_half * cos_half * (alpha2 - 1.0f) + 1.0f;
    const float facets = alpha2 * kPerPi / (d * d);
    const float shadowing = 0.5f / (cos_in * smith_out + cos_out * smith(cos_in));
    const float reflectance = formulas::fresnel_reflectance(glm::dot(half, towards), hit.ior);
    vec3 glare = lamp.intensity * (reflectance * facets * shadowing * cos_in / length2);
    if (std::max({glare.x, glare.y, glare.z}) < kFaintestGlare) continue;
    const Ray ray{point + clearance(point) * hit.face_normal, towards};
    if (body) glare *= body->light_transmittance(ray, length);
    if (solids && solids->blocks(ray, 0, length)) continue;
    if (fraction.x < 0) fraction = water_light ? water_light->at(point, hit.normal).lamps : vec3{1.0f};
    sum += fraction * glare;
  }
  return glm::min(sum, vec3{kBrightestGlare});
}

vec3 Scene::irradiance(vec3 point, vec3 normal, vec3 face_normal) const {
  return parts_->irradiance(point, normal, face_normal, 0.0f);
}

vec3 Scene::lit(const SolidHit& hit, const Ray& ray, Beam beam) const { return parts_->lit(hit, ray, beam); }

vec3 Scene::Parts::lit(const SolidHit& hit, const Ray& ray, Beam beam) const {
  const float width = beam.width + beam.spread * hit.distance;
  const vec3 point = ray.origin + hit.distance * ray.direction;
  const vec3 diffuse = hit.albedo * kPerPi * irradiance(point, hit.normal, hit.face_normal, width);
  if (hit.roughness >= 1.0f) return diffuse;

  // A clear coat: its mirror image of what surrounds the solid, which shows no coats itself, and of the sun.
  const float reflectance = formulas::fresnel_reflectance(-glm::dot(hit.normal, ray.direction), hit.ior);
  const float sigma = 0.8f * hit.roughness * hit.roughness;
  const auto mirrored = [&](vec3 normal) {
    const vec3 direction = formulas::mirrored(ray.direction, normal);
    const float under = glm::dot(direction, hit.face_normal);
    return under < 0.01f ? glm::normalize(direction + (0.01f - under) * hit.face_normal) : direction;
  };
  const vec3 start = point + clearance(point) * hit.face_normal;
  const Beam widened{width, beam.spread + 2.0f * sigma};
  const auto shown_along = [&](vec3 along) {
    const SolidHit seen = this->hit({start, along}, widened, 0, kInfinity);
    vec3 shown{0.0f};
    if (seen.presence < 1.0f || !seen.found()) shown = environment.radiance(along, hit.roughness);
    if (!seen.found()) return shown;
    const vec3 there = start + seen.distance * along;
    const vec3 body_light = seen.albedo * kPerPi * irradiance(there, seen.normal, seen.face_normal, width);
    return glm::mix(shown, body_light, seen.presence);
  };
  const vec3 direction = mirrored(hit.normal);
  vec3 image = shown_along(direction);
  // The sky is blurred as it is; edges of bodies are by facets that lean to the eye and away from it, as these draw a
  // mirror image longest on ground seen at a slant. Weights and places of a Gaussian's mean [Abramowitz1964] 25.4.46
  if (sigma > kSharpCoat && (solids || body)) {
    const vec3 slant = ray.direction - glm::dot(ray.direction, hit.normal) * hit.normal;
    const float length = glm::length(slant);
    if (length > 1e-3f) {
      const vec3 lean = (0.5f * 1.7320508f * std::min(sigma, 0.3f) / length) * slant;
      image = (2.0f / 3.0f) * image + (1.0f / 6.0f) * (shown_along(mirrored(glm::normalize(hit.normal + lean))) +
                                                       shown_along(mirrored(glm::normalize(hit.normal - lean))));
    }
  }
  vec3 glare = environment.sun_glare(direction, sigma * sigma);
  if (glare != vec3{0.0f}) {
    if (water_light) glare *= water_light->at(point, hit.normal).sun;
    if (facing(hit.normal, hit.face_normal, environment.sun_direction()) > 0)
      image += glm::min(glare * sun_seen(point, hit.face_normal, width), vec3{kBrightestGlare});
  }
  // Rough coats lose contrast and with it their mirror image, until none is left.
  const float share = reflectance * (1.0f - hit.roughness);
  vec3 light = (1.0f - share) * diffuse + share * image;
  if (!lamps.empty()) light += (1.0f - hit.roughness) * lamp_glare(point, hit, ray.direction, beam);
  return light;
}

vec3 Scene::radiance(const Ray& ray, float footprint) const { return radiance(ray, Beam{0.0f, footprint}); }

vec3 Scene::radiance(const Ray& ray, Beam beam, float roughness) const {
  const SolidHit found = hit(ray, beam);
  if (!found.found()) return parts_->environment.radiance(ray.direction, roughness);
  const vec3 seen = lit(found, ray, beam);
  if (found.presence >= 1.0f) return seen;
  return glm::mix(parts_->environment.radiance(ray.direction, roughness), seen, found.presence);
}

}  // namespace meniscus
