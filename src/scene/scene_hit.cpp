// What rays meet.
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "scene/chequer.h"
#include "scene/footprint.h"
#include "scene/planes.h"
#include "scene/scene_parts.h"

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

float smooth(float t) {
  t = std::clamp(t, 0.0f, 1.0f);
  return t * t * t * (t * (6.0f * t - 15.0f) + 10.0f);
}

float largest(vec3 v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

}  // namespace

float Scene::Parts::ground_distance(const Ray& ray) const {
  const float down = -glm::dot(ray.direction, ground.up);
  if (!ground.visible || !(down > 1e-7f)) return kInfinity;
  return std::max(0.0f, (glm::dot(ray.origin, ground.up) - ground.height) / down);
}

SolidHit Scene::Parts::ground_hit(const Ray& ray, float distance, Beam beam, float from, float limit) const {
  SolidHit hit;
  if (!(distance < kInfinity) || distance < from || distance > limit) return hit;
  const vec3 point = ray.origin + distance * ray.direction;
  if (body && body->opens_ground(point)) return hit;

  // How much of the ground is left of the haze.
  const float cos_down = -glm::dot(ray.direction, ground.up);
  float presence = smooth(cos_down / kHorizonHaze);
  if (ground.fade_radius > 0) {
    const vec3 offset = point - ground.centre;
    const float along = glm::dot(offset, ground.up);
    const float from_centre = std::sqrt(std::max(0.0f, glm::dot(offset, offset) - along * along));
    presence *= 1.0f - smooth((from_centre / ground.fade_radius - 0.15f) / 0.85f);
  }
  if (!(presence > 0)) return hit;
  hit.distance = distance;
  hit.normal = hit.face_normal = ground.up;
  hit.presence = presence;
  hit.covered = true;
  hit.albedo = ground.albedo;
  if (ground.square > 0) {
    const float width = beam.width + beam.spread * distance;
    const float scale = 1.0f / ground.square;
    const vec2 on_plane{glm::dot(point, u_axis) * scale, glm::dot(point, v_axis) * scale};
    const vec2 extent{footprint(width, cos_down, glm::dot(ray.direction, u_axis)),
                      footprint(width, cos_down, glm::dot(ray.direction, v_axis))};
    hit.albedo = glm::mix(ground.second_albedo, ground.albedo, chequer_fraction(on_plane, extent * scale));
  }
  return hit;
}

float Scene::Parts::clearance(vec3 point) const { return 3e-5f * largest(point) + grain; }

bool Scene::Parts::blocks(const Ray& ray, float from, float limit) const {
  if (solids && solids->blocks(ray, from, limit)) return true;
  if (body && body->keeps_light_out(ray, from, limit)) return true;
  const float distance = ground_distance(ray);
  return distance < kInfinity && distance > from && distance < limit &&
         !(body && body->opens_ground(ray.origin + distance * ray.direction));
}

float Scene::ground_distance(const Ray& ray) const { return parts_->ground_distance(ray); }

SolidHit Scene::hit(const Ray& ray, Beam beam, float from, float limit) const {
  return parts_->hit(ray, beam, from, limit);
}

SolidHit Scene::Parts::hit(const Ray& ray, Beam beam, float from, float limit) const {
  SolidHit nearest;
  if (body) nearest = body->hit(ray, beam, from, limit);
  const float ground = ground_distance(ray);
  if (ground < kInfinity && ground * (1.0f + kTie) < nearest.distance)
    if (const SolidHit hit = ground_hit(ray, ground, beam, from, limit); hit.found()) nearest = hit;
  if (solids) {
    const SolidHit hit = solids->hit(ray, beam, from, std::min(limit, nearest.distance));
    if (hit.found()) nearest = hit;
  }
  if (cover && nearest.covered) cover_hit(ray, beam, nearest);
  return nearest;
}

void Scene::Parts::cover_hit(const Ray& ray, Beam beam, SolidHit& hit) const {
  const vec3 point = ray.origin + hit.distance * ray.direction;
  const float width = beam.width + beam.spread * hit.distance;
  cover->cover({&point, 1}, {&ray.direction, 1}, {&width, 1}, {&hit, 1});
}

float Scene::distance(const Ray& ray, float from) const {
  const Parts& parts = *parts_;
  float nearest = kInfinity;
  if (parts.body) nearest = parts.body->hit(ray, {}, from, kInfinity).distance;
  const float ground = parts.ground_distance(ray);
  if (ground < nearest) nearest = std::min(nearest, parts.ground_hit(ray, ground, {}, from, nearest).distance);
  if (parts.solids) nearest = std::min(nearest, parts.solids->distance(ray, from, nearest));
  return nearest;
}

bool Scene::blocked(vec3 from, vec3 to) const {
  const vec3 way = to - from;
  const float length = glm::length(way), start = parts_->clearance(from), end = parts_->clearance(to);
  if (!(length > start + end)) return false;
  return parts_->blocks({from, way / length}, start, length - end);
}

bool Scene::shadowed(vec3 from, vec3 direction) const {
  return parts_->blocks({from, direction}, parts_->clearance(from), kInfinity);
}

}  // namespace meniscus
