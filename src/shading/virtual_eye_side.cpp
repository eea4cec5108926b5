#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <numbers>

#include "shading/virtual_eye.h"
#include "shading/water_object_shape.h"

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kPerPi = std::numbers::inv_pi_v<float>;
/// Rays start this many texels before the plane, so that lookups between texels at the waterline find the object.
constexpr float kBeforePlane = 1.5f;
/// Part of its way from which a ray meets an object a second time, for its light.
constexpr float kShortly = 1e-4f;
/// Lookups of an object by position: each but the last moves along the ray to the face that is seen.
constexpr int kPasses = 3;
/// Texels between objects in the same map at least.
constexpr float kApart = 4.0f;

/// The scene without some of its solids.
Scene without(const Scene& scene, std::span<const WaterObject> objects) {
  std::vector<bool> taken(scene.solids().size(), false);
  for (const WaterObject& object : objects)
    for (const std::size_t solid : object.solids) taken[solid] = true;
  std::vector<PlacedSolid> left;
  for (std::size_t i = 0; i < taken.size(); ++i)
    if (!taken[i]) left.push_back(scene.solids()[i]);
  Scene rest = scene;
  rest.set_solids(std::move(left));
  return rest;
}

Scene alone(const Scene& scene, const WaterObject& object) {
  Ground nowhere;
  nowhere.visible = false;
  Scene bodies(scene.environment(), nowhere);
  std::vector<PlacedSolid> solids;
  for (const std::size_t solid : object.solids) solids.push_back(scene.solids()[solid]);
  bodies.set_solids(std::move(solids));
  return bodies;
}

/// The object's plane with its normal on the eye's side, and the eye on that side.
ApproximatingPlane plane_of(const WaterObject& object, vec3 eye, bool eye_above) {
  ApproximatingPlane plane{object.plane_point, eye_above ? object.plane_normal : -object.plane_normal};
  const float least = 1e-3f * glm::length(eye - object.plane_point);
  const float height = plane.height(eye);
  if (!(height > least)) plane.point -= (least - height) * plane.normal;
  return plane;
}

/// What is held for the hits of some rays.
struct StillHits {
  std::vector<float> distance, presence;
  std::vector<std::int32_t> face;
  std::vector<vec3> albedo;
  std::vector<SolidHit> others;

  FaceHits of_size(std::size_t size) {
    distance.resize(size);
    presence.resize(size);
    face.resize(size);
    albedo.resize(size);
    others.resize(size);
    return {distance, face, albedo, presence, others};
  }
};

/// A hit on a plane as one of a solid.
SolidHit plane_hit(const FaceHits& hits, std::size_t i) {
  SolidHit hit;
  hit.distance = hits.distance[i];
  hit.normal[hits.face[i] / 2] = hits.face[i] % 2 == 1 ? 1.0f : -1.0f;
  hit.face_normal = hit.normal;
  hit.albedo = hits.albedo[i];
  hit.presence = hits.presence[i];
  return hit;
}

}  // namespace

EyeSide::EyeSide(const Inputs& inputs, bool reflected)
    : scene_(inputs.scene),
      still_scene_(without(inputs.scene, inputs.objects)),
      up_(inputs.field.up),
      by_position_(inputs.options.static_position),
      objects_by_position_(inputs.options.object_position),
      light_(inputs.light),
      slack_(inputs.slack) {
  const vec3 eye = inputs.view.eye;
  const bool above_side = inputs.eye_above == reflected;  // of the water: what this side shows stands above it
  VirtualEyeOptions object_options = inputs.options;
  if (objects_by_position_) object_options.per_point = object_options.scale_correction = false;
  for (std::size_t i = 0; i < inputs.objects.size(); ++i) {
    const WaterObject& object = inputs.objects[i];
    if (inputs.options.trapezium)
      trapezia_.emplace_back(object, horizontal(inputs.plane.projected(eye), up_), up_, inputs.options);
    if (above_side ? object.under && !object.pierces : !object.under) continue;
    const ApproximatingPlane plane = plane_of(object, eye, inputs.eye_above);
    eyes_.push_back(reflected ? VirtualEye::reflected(plane, eye)
                              : VirtualEye::refracted(plane, eye, object, inputs.ratio, object_options));
    const VirtualEye& virtual_eye = eyes_.back();
    Body body{alone(scene_, object),  static_cast<std::int32_t>(i),
              object.bounds.centre(), 0.5f * glm::length(object.bounds.extent()),
              object.axis_top,        object.axis_end - object.axis_top};
    // Scaled about a point that is not its centre, the ball moves.
    const float along = virtual_eye.scale(), across = virtual_eye.scale_across();
    body.radius =
        body.radius * std::max({1.0f, along, across}) +
        std::max(std::abs(along - 1.0f), std::abs(across - 1.0f)) * glm::length(body.centre - virtual_eye.pivot());
    bodies_.push_back(std::move(body));
  }
  per_point_ = !reflected && object_options.per_point && inputs.options.displaced_eye;

  // What stands still is seen through the plane of the whole water; exact where the view's centre meets it.
  vec3 a = inputs.plane.point;
  const float down = glm::dot(inputs.view.forward, inputs.plane.normal);
  if (down < 0) a = eye - inputs.plane.height(eye) / down * inputs.view.forward;
  const Bounds water = inputs.field.bounds();
  a = inputs.plane.projected(glm::clamp(a, water.low, water.high));
  VirtualEyeOptions still_options = inputs.options;
  still_options.per_point = false;
  still_eye_ = reflected ? VirtualEye::reflected(inputs.plane, eye)
                         : VirtualEye::refracted(inputs.plane, eye, a, inputs.ratio, still_options);

  nothing_still_ = above_side && inputs.scene.tank().style == TankStyle::none && still_scene_.solids().empty();

  share_maps(inputs.size);
  if (!by_position_)
    still_map_ = std::make_unique<CubeMap>(
        inputs.size, [this](auto directions, auto texels) { return draw_still(directions, texels); });
}

void EyeSide::share_maps(int size) {
  std::size_t count = 1;
  if (objects_by_position_) {
    std::vector<Cone> cones;
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
      const vec3 way = bodies_[k].centre - eyes_[k].position();
      const float length = glm::length(way), texel = 2.0f / static_cast<float>(size);
      if (length > bodies_[k].radius)
        cones.push_back({way / length, std::asin(bodies_[k].radius / length) + 0.5f * kApart * texel});
      else
        cones.push_back({vec3{0, 0, 1}, 2 * std::numbers::pi_v<float>});
    }
    const std::vector<std::size_t> layers = map_layers(cones);
    for (std::size_t k = 0; k < layers.size(); ++k) {
      bodies_[k].map = layers[k];
      count = std::max(count, layers[k] + 1);
    }
  }
  for (std::size_t map = 0; map < count; ++map)
    object_maps_.push_back(std::make_unique<CubeMap>(
        size, [this, map](auto directions, auto texels) { return draw_objects(map, directions, texels); }));
}

bool EyeSide::draw_objects(std::size_t map, std::span<const vec3> directions, std::span<MapTexel> texels) const {
  const vec3 middle = glm::normalize(directions.front() + directions.back());
  const float half_angle = std::acos(std::clamp(glm::dot(middle, directions.front()), -1.0f, 1.0f)) * 1.5f;
  const float texel = object_maps_[map]->texel_angle();
  std::vector<float> nearest;  // m in the map
  std::vector<Ray> seen_by(directions.size()), rays;
  std::vector<float> beyond(directions.size()), starts, scales;
  std::vector<std::size_t> which;
  std::vector<SolidHit> hits;
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const Body& body = bodies_[k];
    if (body.map != map) continue;
    if (!per_point_) {
      const vec3 way = body.centre - eyes_[k].position();
      const float length = glm::length(way);
      if (length > body.radius && std::acos(std::clamp(glm::dot(way / length, middle), -1.0f, 1.0f)) >
                                      std::asin(body.radius / length) + half_angle)
        continue;
    }
    rays.clear();
    starts.clear();
    scales.clear();
    which.clear();
    for (std::size_t i = 0; i < directions.size(); ++i) {
      const auto ray = eyes_[k].ray(directions[i]);
      if (!ray) continue;
      const float cosine = std::abs(glm::dot(ray->ray.direction, eyes_[k].plane().normal));
      const float before = std::min(kBeforePlane * texel / std::max(cosine, 0.02f), 0.05f) * ray->from;
      const float start = ray->from - before;
      rays.push_back({ray->ray.origin + start * ray->ray.direction, ray->ray.direction});
      starts.push_back(start);
      scales.push_back(ray->scale);
      which.push_back(i);
      beyond[i] = ray->from;
    }
    hits.assign(rays.size(), SolidHit{});
    body.solids.hits(rays, {0.0f, texel}, hits);
    for (std::size_t j = 0; j < rays.size(); ++j) {
      if (!hits[j].found()) continue;
      if (nearest.empty()) nearest.assign(directions.size(), kInfinity);
      const std::size_t i = which[j];
      const float distance = starts[j] + hits[j].distance;
      if (!(distance / scales[j] < nearest[i])) continue;
      nearest[i] = distance / scales[j];
      texels[i].alpha = 1;
      texels[i].distance = objects_by_position_ ? distance : std::max(0.0f, distance - beyond[i]);
      texels[i].normal = hits[j].face_normal;
      texels[i].object = body.index;
      // From just before the object the whole scene shows the same place in all its light.
      const float shortly = std::min(kShortly * distance, hits[j].distance);
      seen_by[i] = {rays[j].origin + (hits[j].distance - shortly) * rays[j].direction, rays[j].direction};
    }
  }
  if (nearest.empty()) return false;
  rays.clear();
  which.clear();
  float width = 0;
  for (std::size_t i = 0; i < nearest.size(); ++i)
    if (nearest[i] < kInfinity) {
      rays.push_back(seen_by[i]);
      which.push_back(i);
      width += texel * nearest[i];
    }
  std::vector<vec3> radiance(rays.size());
  scene_.radiance(rays, {width / static_cast<float>(rays.size()), 0.0f}, radiance);
  for (std::size_t j = 0; j < rays.size(); ++j) texels[which[j]].radiance = radiance[j];
  return true;
}

bool EyeSide::draw_still(std::span<const vec3> directions, std::span<MapTexel> texels) const {
  const Beam beam{0.0f, still_map_->texel_angle()};
  bool any = false;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const auto ray = still_eye_.ray(directions[i]);
    if (!ray) continue;
    const float cosine = std::abs(glm::dot(directions[i], still_eye_.plane().normal));
    const float from = std::max(0.0f, ray->from - slack_ / std::max(cosine, 1e-3f));
    const SolidHit hit = still_scene_.hit(ray->ray, beam, from);
    if (!hit.found()) continue;
    any = true;
    texels[i].radiance = hit.presence * scene_.lit(hit, ray->ray, beam);
    texels[i].alpha = hit.presence;
    texels[i].distance = std::max(0.0f, hit.distance - ray->from);
    texels[i].normal = hit.face_normal;
  }
  return any;
}

void EyeSide::look_still(std::span<const Ray> rays, Beam beam, std::span<EyeLook> looks) const {
  if (nothing_still_) return;
  if (!by_position_) {
    for (std::size_t i = 0; i < rays.size(); ++i) look_still_by_direction(rays[i].direction, looks[i]);
    return;
  }
  thread_local StillHits held;
  const FaceHits hits = held.of_size(rays.size());
  still_scene_.face_hits(rays, beam, hits);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const std::int32_t face = hits.face[i];
    if (face == FaceHits::kNothing) continue;
    EyeLook& look = looks[i];
    const Ray& ray = rays[i];
    look.still_distance = hits.distance[i];
    if (face != FaceHits::kOther) {
      look.still_alpha = hits.presence[i];
      vec3 light;
      if (light_->at(face, ray.origin + hits.distance[i] * ray.direction, light)) {
        look.still = hits.presence[i] * kPerPi * hits.albedo[i] * light;
        continue;
      }
    }
    const SolidHit hit = face == FaceHits::kOther ? hits.others[i] : plane_hit(hits, i);
    look.still_alpha = hit.presence;
    look.still = hit.presence * scene_.lit(hit, ray, beam);
  }
}

void EyeSide::look_still_by_direction(vec3 direction, EyeLook& look) const {
  const CubeMap::Cell cell = still_map_->at(direction);
  if (!cell.first) return;
  float sum = 0;
  for (int k = 0; k < 4; ++k) {
    const MapTexel& texel = cell.texel(k);
    const float weight = cell.weight(k);
    look.still += weight * texel.radiance;
    look.still_alpha += weight * texel.alpha;
    if (texel.alpha > 0) sum += weight * texel.alpha * texel.distance;
  }
  if (look.still_alpha > 0) look.still_distance = sum / look.still_alpha;
}

void EyeSide::add(const CubeMap::Cell& cell, vec3 from, std::int32_t only, EyeLook& look) const {
  std::int32_t last = -1;
  float share = 1;
  for (int k = 0; k < 4; ++k) {
    const MapTexel& texel = cell.texel(k);
    if (texel.object < 0 || (only >= 0 && texel.object != only)) continue;
    if (!trapezia_.empty() && texel.object != last) {
      last = texel.object;
      share = trapezia_[static_cast<std::size_t>(last)].weight(horizontal(from, up_));
    }
    const float weight = share * cell.weight(k);
    look.object += weight * texel.radiance;
    look.object_alpha += weight;
    look.object_distance += weight * texel.distance;
  }
  if (look.object_alpha > 0) look.object_distance /= look.object_alpha;
}

void EyeSide::look_by_direction(vec3 from, vec3 direction, EyeLook& look) const {
  const CubeMap::Cell cell = object_maps_.front()->at(direction);
  if (cell.first) add(cell, from, -1, look);
}

void EyeSide::look_by_position(vec3 from, vec3 direction, EyeLook& look) const {
  float nearest = kInfinity;
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const Body& body = bodies_[k];
    const vec3 way = body.centre - from;
    const float middle = glm::dot(way, direction), beside = glm::dot(way, way) - middle * middle;
    if (beside > body.radius * body.radius || middle < -body.radius) continue;
    // The ray's nearest point to the main axis lies in most objects that it meets.
    const vec3 offset = body.axis_top - from;
    const float along = glm::dot(body.axis, direction), square = glm::dot(body.axis, body.axis);
    const float determinant = square - along * along;
    float on_axis = 0.5f;
    if (determinant > 1e-6f * square)
      on_axis =
          std::clamp((along * glm::dot(offset, direction) - glm::dot(offset, body.axis)) / determinant, 0.0f, 1.0f);
    float distance = std::max(0.0f, glm::dot(offset + on_axis * body.axis, direction));
    const vec3 eye = eyes_[k].position();
    CubeMap::Cell cell;
    for (int pass = 0; pass < kPasses; ++pass) {
      const vec3 towards = from + distance * direction - eye;
      cell = object_maps_[body.map]->at(towards);
      if (!cell.first || pass == kPasses - 1) break;
      const MapTexel& texel = cell.nearest();
      if (texel.object != body.index) break;
      // Onto the plane of the face that is seen there, or as near to it as the object is large.
      const vec3 shown = eye + texel.distance / glm::length(towards) * towards;
      const float facing = glm::dot(direction, texel.normal);
      float next = glm::dot(shown - from, direction);
      if (facing < -0.05f) next = glm::dot(shown - from, texel.normal) / facing;
      distance = std::clamp(next, std::max(0.0f, middle - body.radius), middle + body.radius);
    }
    if (!cell.first) continue;
    EyeLook one;
    add(cell, from, body.index, one);
    if (!(one.object_alpha > 0)) continue;
    // Behind or before what has been found.
    if (distance < nearest) {
      look.object = one.object + (1.0f - one.object_alpha) * look.object;
      look.object_distance = nearest = distance;
    } else {
      look.object += (1.0f - look.object_alpha) * one.object;
    }
    look.object_alpha += (1.0f - look.object_alpha) * one.object_alpha;
  }
}

void EyeSide::look(std::span<const Ray> rays, Beam beam, std::span<EyeLook> looks) const {
  std::fill(looks.begin(), looks.end(), EyeLook{});
  look_still(rays, beam, looks);
  if (bodies_.empty()) return;
  for (std::size_t i = 0; i < rays.size(); ++i)
    if (objects_by_position_)
      look_by_position(rays[i].origin, rays[i].direction, looks[i]);
    else
      look_by_direction(rays[i].origin, rays[i].direction, looks[i]);
}

}  // namespace meniscus
