#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "shading/virtual_eye.h"
#include "shading/water_object_shape.h"

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Rays start this many texels before the plane, so that lookups between texels at the waterline find the object.
constexpr float kBeforePlane = 1.5f;
/// Lookups of an object by position: each but the last moves along the ray to the face that is seen.
constexpr int kPasses = 3;

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

}  // namespace

EyeSide::EyeSide(const Inputs& inputs, bool reflected)
    : scene_(inputs.scene),
      still_scene_(without(inputs.scene, inputs.objects)),
      up_(inputs.field.up),
      by_position_(inputs.options.static_position),
      objects_by_position_(inputs.options.object_position),
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
    body.radius = body.radius * std::max(1.0f, virtual_eye.scale()) +
                  std::abs(virtual_eye.scale() - 1.0f) * glm::length(body.centre - virtual_eye.pivot());
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

  // A box that most of what stands still lies around: the tank, or the ground alone.
  const vec3 up = direction_of(up_);
  const Tank& tank = inputs.scene.tank();
  room_ = water;
  if (tank.style != TankStyle::none && !tank.inside.empty()) {
    room_ = tank.inside;
  } else {
    const Ground& ground = inputs.scene.ground();
    for (int k = 0; k < 3; ++k) {
      if (up[k] > 0.5f) {
        if (ground.visible && std::abs(ground.up[k]) > 0.99f) room_.low[k] = ground.height * ground.up[k];
      } else {
        room_.low[k] = -kInfinity;
        room_.high[k] = kInfinity;
      }
    }
  }
  for (int k = 0; k < 3; ++k)
    if (up[k] > 0.5f) room_.high[k] = kInfinity;
  nothing_still_ = above_side && tank.style == TankStyle::none && still_scene_.solids().empty();

  object_map_ = std::make_unique<CubeMap>(
      inputs.size, [this](auto directions, auto texels) { return draw_objects(directions, texels); });
  still_map_ = std::make_unique<CubeMap>(
      inputs.size, [this](auto directions, auto texels) { return draw_still(directions, texels); });
}

bool EyeSide::draw_objects(std::span<const vec3> directions, std::span<MapTexel> texels) const {
  struct Nearest {
    float distance = kInfinity;  ///< m in the map
    float from = 0;
    SolidHit hit;
    Ray ray{};
    std::int32_t object = -1;
  };
  const vec3 middle = glm::normalize(directions.front() + directions.back());
  const float half_angle = std::acos(std::clamp(glm::dot(middle, directions.front()), -1.0f, 1.0f)) * 1.5f;
  const float texel = object_map_->texel_angle();
  std::vector<Nearest> nearest;
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const Body& body = bodies_[k];
    if (!per_point_) {
      const vec3 way = body.centre - eyes_[k].position();
      const float length = glm::length(way);
      if (length > body.radius && std::acos(std::clamp(glm::dot(way / length, middle), -1.0f, 1.0f)) >
                                      std::asin(body.radius / length) + half_angle)
        continue;
    }
    for (std::size_t i = 0; i < directions.size(); ++i) {
      const auto ray = eyes_[k].ray(directions[i]);
      if (!ray) continue;
      const float cosine = std::abs(glm::dot(ray->ray.direction, eyes_[k].plane().normal));
      const float before = std::min(kBeforePlane * texel / std::max(cosine, 0.02f), 0.05f) * ray->from;
      const SolidHit hit = body.solids.hit(ray->ray, {0.0f, texel}, ray->from - before);
      if (!hit.found()) continue;
      if (nearest.empty()) nearest.resize(directions.size());
      if (hit.distance / ray->scale < nearest[i].distance)
        nearest[i] = {hit.distance / ray->scale, ray->from, hit, ray->ray, body.index};
    }
  }
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    const Nearest& found = nearest[i];
    if (found.object < 0) continue;
    texels[i].radiance = scene_.lit(found.hit, found.ray, {0.0f, texel});
    texels[i].alpha = 1;
    texels[i].distance = objects_by_position_ ? found.hit.distance : std::max(0.0f, found.hit.distance - found.from);
    texels[i].normal = found.hit.face_normal;
    texels[i].object = found.object;
  }
  return !nearest.empty();
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
    texels[i].distance = by_position_ ? hit.distance : std::max(0.0f, hit.distance - ray->from);
    texels[i].normal = hit.face_normal;
  }
  return any;
}

float EyeSide::way_out(vec3 from, vec3 direction) const {
  float way = kInfinity;
  for (int k = 0; k < 3; ++k) {
    const float wall = direction[k] > 0 ? room_.high[k] : room_.low[k];
    if (direction[k] != 0 && std::isfinite(wall)) way = std::min(way, std::max(0.0f, (wall - from[k]) / direction[k]));
  }
  return way;
}

void EyeSide::look_still(vec3 from, vec3 direction, EyeLook& look) const {
  if (nothing_still_) return;
  vec3 towards = direction;
  float distance = -1;
  if (by_position_) {
    // The place where the ray leaves the room, corrected by the face that the map shows there.
    const vec3 eye = still_eye_.position();
    distance = way_out(from, direction);
    if (distance < kInfinity) {
      towards = from + distance * direction - eye;
      const CubeMap::Cell cell = still_map_->at(towards);
      if (!cell.first) return;
      if (const MapTexel& texel = cell.nearest(); texel.alpha > 0) {
        // Seen along the ray to the very point, not along the nearest texel's.
        const float away = glm::length(towards);
        const vec3 shown = eye + texel.distance / away * towards;
        const float along = glm::dot(direction, texel.normal);
        if (along < -1e-4f) {
          const float corrected = glm::dot(shown - from, texel.normal) / along;
          if (corrected > 0) distance = corrected;
        }
      }
      towards = from + distance * direction - eye;
    }
  }
  const CubeMap::Cell cell = still_map_->at(towards);
  if (!cell.first) return;
  float sum = 0;
  for (int k = 0; k < 4; ++k) {
    const MapTexel& texel = cell.texel(k);
    const float weight = cell.weight(k);
    look.still += weight * texel.radiance;
    look.still_alpha += weight * texel.alpha;
    if (texel.alpha > 0) sum += weight * texel.alpha * texel.distance;
  }
  if (look.still_alpha > 0)
    look.still_distance = by_position_ && distance < kInfinity ? distance : sum / look.still_alpha;
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
  const CubeMap::Cell cell = object_map_->at(direction);
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
      cell = object_map_->at(towards);
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
    if (!cell.first || !(distance < nearest)) continue;
    EyeLook one;
    add(cell, from, body.index, one);
    if (!(one.object_alpha > 0)) continue;
    nearest = distance;
    look.object = one.object + (1.0f - one.object_alpha) * look.object;
    look.object_alpha = one.object_alpha + (1.0f - one.object_alpha) * look.object_alpha;
    look.object_distance = distance;
  }
}

EyeLook EyeSide::look(vec3 from, vec3 direction) const {
  EyeLook look;
  look_still(from, direction, look);
  if (bodies_.empty()) return look;
  if (objects_by_position_)
    look_by_position(from, direction, look);
  else
    look_by_direction(from, direction, look);
  return look;
}

}  // namespace meniscus
