#include "scene/tank_body.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>

#include "meniscus/formulas.h"
#include "scene/footprint.h"
#include "scene/tiles.h"

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// overlap() and bulge() in diagonals of the tank.
constexpr float kOverlap = 2e-6f;
constexpr float kBulge = 0.015f;

bool in_range(vec3 v, float high) {
  return v.x >= 0 && v.y >= 0 && v.z >= 0 && v.x <= high && v.y <= high && v.z <= high;
}

/// Where a ray crosses the plane on which the coordinate `axis` is `value`; behind the origin or along it: infinity.
float plane_distance(const Ray& ray, int axis, float value) {
  const float t = (value - ray.origin[axis]) / ray.direction[axis];
  return t >= 0 ? t : kInfinity;
}

bool within(const Bounds& box, vec3 point, int axis, float margin) {
  return point[axis] >= box.low[axis] - margin && point[axis] <= box.high[axis] + margin;
}

vec3 unit(int axis, float sign) {
  vec3 v{0.0f};
  v[axis] = sign;
  return v;
}

}  // namespace

TankStyle tank_style_of(std::string_view name) {
  if (name == "none") return TankStyle::none;
  if (name == "glass") return TankStyle::glass;
  if (name == "tiled") return TankStyle::tiled;
  throw Error(ErrorCode::invalid_argument,
              {"there is no such tank", "none, glass or tiled", std::string(name), {}, {}, {}, {}});
}

TankBody::TankBody(const Tank& tank) : tank_(tank) {
  const auto fail = [](std::string problem) { throw Error(ErrorCode::invalid_argument, std::move(problem)); };
  const vec3 extent = tank.inside.extent();
  const float longest = std::max({extent.x, extent.y, extent.z});
  if (tank.inside.empty() || !(std::min({extent.x, extent.y, extent.z}) > 0) || !std::isfinite(longest))
    fail("a tank has no space inside");
  up_ = tank.up.x > 0.999f ? 0 : tank.up.y > 0.999f ? 1 : tank.up.z > 0.999f ? 2 : -1;
  if (up_ < 0) fail("a tank's up direction is not +x, +y or +z");
  side_ = (up_ + 1) % 3;
  other_ = (up_ + 2) % 3;
  if (!(tank.thickness >= 0) || !std::isfinite(tank.thickness) || !(tank.tile >= 0) || !std::isfinite(tank.tile))
    fail("the thickness of a tank's walls or the edge of its tiles is negative or not finite");
  if (!in_range(tank.albedo, 1e6f) || !in_range(tank.joint_albedo, 1e6f) || !in_range(tank.glass_tint, 1.0f))
    fail("a colour of a tank is out of range");
  if (tank_.thickness == 0) tank_.thickness = 0.01f * longest;
  if (tank_.tile == 0) tank_.tile = longest / 12.0f;
  for (int axis = 0; axis < 3; ++axis)
    tile_[axis] = extent[axis] / std::max(1.0f, std::round(extent[axis] / tank_.tile));

  outside_ = tank.inside.grown(tank_.thickness);
  outside_.low[up_] = tank.inside.low[up_];
  outside_.high[up_] = tank.inside.high[up_];
  overlap_ = kOverlap * glm::length(outside_.extent());
  bulge_ = kBulge * glm::length(extent);

  // Bars stand outside of the space for the water and on the height of its floor and its upper edge.
  const float thick = std::min(tank_.thickness, 0.5f * extent[up_]);
  std::size_t count = 0;
  for (const int along : {side_, other_, up_})
    for (int k = 0; k < 4; ++k) {
      Bounds bar = outside_;
      const int s = (along + 1) % 3, t = (along + 2) % 3;
      const auto narrow = [&](int axis, bool high) {
        const float width = axis == up_ ? thick : tank_.thickness;
        (high ? bar.low : bar.high)[axis] = high ? outside_.high[axis] - width : outside_.low[axis] + width;
      };
      narrow(s, (k & 1) != 0);
      narrow(t, (k & 2) != 0);
      bars_[count++] = bar;
    }
}

bool TankBody::opens_ground(vec3 point) const {
  if (tank_.style != TankStyle::tiled) return false;
  return within(tank_.inside, point, side_, 0) && within(tank_.inside, point, other_, 0) &&
         within(tank_.inside, point, up_, overlap_);
}

SolidHit TankBody::hit(const Ray& ray, Beam beam, float from, float limit) const {
  return tank_.style == TankStyle::tiled ? tiled_hit(ray, beam, from, limit) : bar_hit(ray, from, limit);
}

vec3 TankBody::tiles(vec3 point, int axis, const Ray& ray, float width) const {
  const int s = (axis + 1) % 3, t = (axis + 2) % 3;
  const float cos_in = std::max(1e-4f, std::abs(ray.direction[axis]));
  const vec2 on_plane{(point[s] - tank_.inside.low[s]) / tile_[s], (point[t] - tank_.inside.low[t]) / tile_[t]};
  const vec2 extent{footprint(width, cos_in, ray.direction[s]) / tile_[s],
                    footprint(width, cos_in, ray.direction[t]) / tile_[t]};
  return glm::mix(tank_.albedo, tank_.joint_albedo, joint_fraction(on_plane, extent, kJoint));
}

SolidHit TankBody::tiled_hit(const Ray& ray, Beam beam, float from, float limit) const {
  const Bounds& inside = tank_.inside;
  SolidHit hit;
  int hit_axis = -1;
  // Outwards through each pair of walls, and down through the floor.
  for (int axis = 0; axis < 3; ++axis) {
    const float along = ray.direction[axis];
    if (along == 0 || (axis == up_ && along > 0)) continue;
    const float distance = plane_distance(ray, axis, along > 0 ? inside.high[axis] : inside.low[axis]);
    if (!(distance >= from && distance <= limit && distance < hit.distance)) continue;
    const vec3 point = ray.origin + distance * ray.direction;
    if (!within(inside, point, (axis + 1) % 3, overlap_) || !within(inside, point, (axis + 2) % 3, overlap_)) continue;
    hit.distance = distance;
    hit.normal = unit(axis, along > 0 ? -1.0f : 1.0f);
    hit_axis = axis;
  }
  bool rim = false;
  if (ray.direction[up_] < 0) {
    const float distance = plane_distance(ray, up_, inside.high[up_]);
    if (distance >= from && distance <= limit && distance < hit.distance) {
      const vec3 point = ray.origin + distance * ray.direction;
      // A wall's rim is there for the rays for which the wall is: those that leave the tank through it.
      for (const int axis : {side_, other_}) {
        const int across = axis == side_ ? other_ : side_;
        const bool low = point[axis] < inside.low[axis] && ray.direction[axis] < 0;
        const bool high = point[axis] > inside.high[axis] && ray.direction[axis] > 0;
        rim = rim || ((low || high) && within(outside_, point, axis, 0) && within(outside_, point, across, 0));
      }
      if (rim) {
        hit.distance = distance;
        hit.normal = unit(up_, 1.0f);
      }
    }
  }
  if (!hit.found()) return hit;
  hit.face_normal = hit.normal;
  hit.albedo =
      rim ? tank_.joint_albedo
          : tiles(ray.origin + hit.distance * ray.direction, hit_axis, ray, beam.width + beam.spread * hit.distance);
  return hit;
}

SolidHit TankBody::bar_hit(const Ray& ray, float from, float limit) const {
  SolidHit hit;
  const vec3 inverse = 1.0f / ray.direction;
  /// Distances at which the ray enters and leaves a box; where it starts inside, only leaving is a hit.
  const auto cross = [&](const Bounds& box, float& enter, float& leave, int& axis_in) {
    enter = -kInfinity;
    leave = kInfinity;
    axis_in = 0;
    for (int axis = 0; axis < 3; ++axis) {
      if (ray.direction[axis] == 0) {
        if (!within(box, ray.origin, axis, 0)) return false;
        continue;
      }
      const float a = (box.low[axis] - ray.origin[axis]) * inverse[axis];
      const float b = (box.high[axis] - ray.origin[axis]) * inverse[axis];
      if (std::min(a, b) > enter) {
        enter = std::min(a, b);
        axis_in = axis;
      }
      leave = std::min(leave, std::max(a, b));
    }
    return enter <= leave;
  };
  float enter = 0, leave = 0;
  int axis = 0;
  if (!cross(outside_, enter, leave, axis) || leave < from || enter > limit) return hit;
  for (const Bounds& bar : bars_) {
    if (!cross(bar, enter, leave, axis) || enter < from || enter > limit || enter >= hit.distance || enter < 0)
      continue;
    hit.distance = enter;
    hit.normal = unit(axis, ray.direction[axis] > 0 ? -1.0f : 1.0f);
  }
  hit.face_normal = hit.normal;
  hit.albedo = kEdgeColour;
  hit.roughness = kEdgeRoughness;
  hit.ior = kGlass;
  return hit;
}

TankBody::Pane TankBody::pane(float cos_in) const {
  // Both faces with all reflections between them, and the way through the glass.
  const formulas::Interface face = formulas::fresnel(cos_in, kGlass);
  const float both = 2.0f * face.reflectance / (1.0f + face.reflectance);
  const vec3 tint = glm::pow(tank_.glass_tint, vec3{1.0f / std::max(face.cos_t, 0.1f)});
  return {0.0f, vec3{0.0f}, both, (1.0f - both) * tint};
}

TankBody::Panes TankBody::panes(const Ray& ray, float limit) const {
  Panes result;
  if (tank_.style != TankStyle::glass) return result;
  for (const int axis : {side_, other_})
    for (const bool high : {false, true}) {
      const float along = ray.direction[axis];
      if (along == 0) continue;
      const float distance = plane_distance(ray, axis, high ? outside_.high[axis] : outside_.low[axis]);
      // What stands at the pane itself is not behind it.
      if (!(distance < kInfinity && distance < limit * (1.0f - 1e-5f))) continue;
      const vec3 point = ray.origin + distance * ray.direction;
      if (!within(outside_, point, (axis + 1) % 3, 0) || !within(outside_, point, (axis + 2) % 3, 0)) continue;
      Pane pane = this->pane(std::abs(along));
      pane.distance = distance;
      pane.normal = unit(axis, along > 0 ? -1.0f : 1.0f);
      int at = result.count++;
      for (; at > 0 && result.panes[static_cast<std::size_t>(at - 1)].distance > distance; --at)
        result.panes[static_cast<std::size_t>(at)] = result.panes[static_cast<std::size_t>(at - 1)];
      result.panes[static_cast<std::size_t>(at)] = pane;
    }
  return result;
}

bool TankBody::keeps_light_out(const Ray& ray, float from, float limit) const {
  if (tank_.style != TankStyle::tiled) return false;
  const Bounds& inside = tank_.inside;
  const bool above_floor = ray.origin[up_] > inside.low[up_] + 0.02f * bulge_ && ray.origin[up_] < inside.high[up_];
  for (int axis = 0; axis < 3; ++axis) {
    const float along = ray.direction[axis];
    if (along == 0) continue;
    for (const bool high : {false, true}) {
      if (axis == up_ && high) continue;
      const float distance = ((high ? inside.high[axis] : inside.low[axis]) - ray.origin[axis]) / along;
      const bool outwards = (along > 0) == high;
      const float nearest = outwards && axis != up_ && above_floor ? -bulge_ / std::abs(along) : from;
      if (!(distance >= nearest && distance <= limit)) continue;
      const vec3 point = ray.origin + std::max(distance, 0.0f) * ray.direction;
      if (within(inside, point, (axis + 1) % 3, bulge_) && within(inside, point, (axis + 2) % 3, bulge_) &&
          point[up_] < inside.high[up_])
        return true;
    }
  }
  return false;
}

vec3 TankBody::light_transmittance(const Ray& ray, float length) const {
  if (keeps_light_out(ray, 0, length)) return vec3{0.0f};
  vec3 left{1.0f};
  const Panes crossed = panes(ray, length);
  for (int k = 0; k < crossed.count; ++k) left *= crossed.panes[static_cast<std::size_t>(k)].transmittance;
  return left;
}

}  // namespace meniscus
