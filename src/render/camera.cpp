#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "meniscus/render.h"

namespace meniscus {
namespace {

/// right: first horizontal axis; back: where the camera stands at azimuth 0.
struct Horizon {
  vec3 right, back;
};

Horizon horizon_of(Axis up) {
  const vec3 right = up == Axis::x ? vec3{0, 1, 0} : vec3{1, 0, 0};
  return {right, glm::cross(right, direction_of(up))};
}

std::array<vec3, 8> corners_of(const Bounds& box) {
  std::array<vec3, 8> corners;
  for (std::size_t i = 0; i < corners.size(); ++i)
    corners[i] = {i & 1u ? box.high.x : box.low.x, i & 2u ? box.high.y : box.low.y, i & 4u ? box.high.z : box.low.z};
  return corners;
}

/// Never empty and never flat to a point, so that every camera has something to look at.
Bounds something_to_see(Bounds bounds) {
  if (bounds.empty()) return {vec3{-0.5f}, vec3{0.5f}};
  const vec3 extent = bounds.extent();
  const float longest = std::max({extent.x, extent.y, extent.z});
  return longest > 0 ? bounds : bounds.grown(0.5f);
}

/// Tangents of half the field of view, across and up, less the margin.
struct Room {
  float x, y;
};

/// A corner across or up, and along the view.
struct Seen {
  float at, z;
};

/// Where in [low, high] an eye at `z` leaves as much of the picture free on the one side of the corners as on the
/// other, by bisection: the difference falls as the eye moves.
float in_the_middle(const std::array<Seen, 8>& corners, float low, float high, float z) {
  const auto difference = [&](float eye) {
    float most = -INFINITY, least = INFINITY;
    for (const Seen& corner : corners) {
      const float tangent = (corner.at - eye) / std::max(corner.z - z, 1e-20f);
      most = std::max(most, tangent);
      least = std::min(least, tangent);
    }
    return most + least;
  };
  for (int i = 0; i < 40; ++i) {
    const float middle = 0.5f * (low + high);
    (difference(middle) > 0 ? low : high) = middle;
  }
  return 0.5f * (low + high);
}

/// The eye of a given orientation nearest to the box that sees all of its corners. With camera coordinates p of the
/// corners and e of the eye, |p.x - e.x| <= room.x (p.z - e.z), and the same for y, bound e.z from above, each by
/// itself; the smaller bound holds, and the picture's middle is put into what room is left.
vec3 tightest_eye(const Bounds& bounds, const View& oriented, Room room) {
  std::array<Seen, 8> across, up;
  float right = -INFINITY, left = -INFINITY, top = -INFINITY, bottom = -INFINITY;
  const std::array<vec3, 8> corners = corners_of(bounds);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const float z = glm::dot(corners[i], oriented.forward);
    across[i] = {glm::dot(corners[i], oriented.right), z};
    up[i] = {glm::dot(corners[i], oriented.up), z};
    right = std::max(right, across[i].at - room.x * z);
    left = std::max(left, -across[i].at - room.x * z);
    top = std::max(top, up[i].at - room.y * z);
    bottom = std::max(bottom, -up[i].at - room.y * z);
  }
  const float z = std::min(-(right + left) / (2 * room.x), -(top + bottom) / (2 * room.y));
  return in_the_middle(across, right + room.x * z, -left - room.x * z, z) * oriented.right +
         in_the_middle(up, top + room.y * z, -bottom - room.y * z, z) * oriented.up + z * oriented.forward;
}

/// Distance from the target at which an eye that looks at it sees all corners.
float distance_to_see(const Bounds& bounds, vec3 target, const View& oriented, Room room) {
  float distance = 0;
  for (const vec3 corner : corners_of(bounds)) {
    const vec3 p = corner - target;
    const float z = glm::dot(p, oriented.forward);
    distance = std::max({distance, std::abs(glm::dot(p, oriented.right)) / room.x - z,
                         std::abs(glm::dot(p, oriented.up)) / room.y - z});
  }
  return distance;
}

void check(const CameraOptions& options) {
  const auto refuse = [](const char* what, float value, const char* expected) {
    throw Error(
        ErrorCode::invalid_argument,
        {fmt::format("{} of the camera is out of range", what), expected, fmt::format("{}", value), {}, {}, {}, {}});
  };
  if (!(options.fov_deg > 0 && options.fov_deg < 180)) refuse("the field of view", options.fov_deg, "0 to 180 degrees");
  if (!(options.margin >= 0 && options.margin < 1)) refuse("the margin", options.margin, "0 to 1");
  if (options.elevation_deg && !(std::abs(*options.elevation_deg) <= 90))
    refuse("the elevation", *options.elevation_deg, "-90 to 90 degrees");
  if (options.azimuth_deg && !std::isfinite(*options.azimuth_deg))
    refuse("the azimuth", *options.azimuth_deg, "degrees");
  if (!std::isfinite(options.orbit_deg)) refuse("the orbit", options.orbit_deg, "degrees");
  if (options.distance && !(*options.distance > 0 && std::isfinite(*options.distance)))
    refuse("the distance", *options.distance, "more than 0 m");
  if (options.orthographic_height && !(*options.orthographic_height > 0 && std::isfinite(*options.orthographic_height)))
    refuse("the orthographic height", *options.orthographic_height, "more than 0 m");
}

}  // namespace

float default_azimuth_deg(const Bounds& bounds, Axis up) {
  const Horizon horizon = horizon_of(up);
  const vec3 extent = something_to_see(bounds).extent();
  const float across = std::abs(glm::dot(extent, horizon.right)), along = std::abs(glm::dot(extent, horizon.back));
  return across >= along ? 30.0f : 60.0f;
}

vec3 direction_towards(Axis up, float azimuth_deg, float elevation_deg) {
  const Horizon horizon = horizon_of(up);
  const float azimuth = glm::radians(azimuth_deg), elevation = glm::radians(elevation_deg);
  return glm::normalize(std::cos(elevation) * (std::cos(azimuth) * horizon.back + std::sin(azimuth) * horizon.right) +
                        std::sin(elevation) * direction_of(up));
}

View fitted_view(const Bounds& water, Axis up, const CameraOptions& options, float turned_deg, int width, int height) {
  check(options);
  const Bounds bounds = something_to_see(water);
  const vec3 up_direction = direction_of(up);
  const float fov = glm::radians(options.fov_deg);
  const float aspect = static_cast<float>(width) / static_cast<float>(std::max(height, 1));
  const float elevation = options.elevation_deg.value_or(16.0f);
  const float azimuth = options.azimuth_deg.value_or(default_azimuth_deg(bounds, up));
  const vec3 target = options.target.value_or(bounds.centre());
  const float tangent = std::tan(0.5f * fov) * (1 - options.margin);
  const Room room{tangent * aspect, tangent};

  // Straight down or up, the top of the picture is where the camera at a low elevation would look to.
  const auto looking = [&](vec3 eye, vec3 at, float around_deg) {
    const vec3 along = glm::normalize(eye - at);
    const bool vertical = std::abs(glm::dot(along, up_direction)) > 0.9999f;
    const vec3 hint = vertical
                          ? -direction_towards(up, around_deg, 0) * (glm::dot(along, up_direction) > 0 ? 1.0f : -1.0f)
                          : up_direction;
    if (options.orthographic_height)
      return orthographic_view(eye, at, hint, *options.orthographic_height, width, height);
    return perspective_view(eye, at, hint, fov, width, height);
  };

  // An eye that was given stands; an orbit takes it around the target.
  if (options.eye) {
    const vec3 offset = *options.eye - target;
    const float turn = glm::radians(turned_deg);
    const vec3 turned = std::cos(turn) * offset + std::sin(turn) * glm::cross(up_direction, offset) +
                        (1 - std::cos(turn)) * glm::dot(up_direction, offset) * up_direction;  // Rodrigues
    return looking(target + (turned_deg == 0 ? offset : turned), target, azimuth + turned_deg);
  }

  const vec3 towards = direction_towards(up, azimuth + turned_deg, elevation);
  const View oriented = looking(target + towards, target, azimuth + turned_deg);
  if (options.orthographic_height || options.distance) {
    // Parallel rays start outside of everything.
    const float radius = glm::length(bounds.extent()) + glm::length(bounds.centre() - target);
    return looking(target + options.distance.value_or(radius) * towards, target, azimuth + turned_deg);
  }
  if (options.orbit_deg != 0 || options.target) {
    float distance = distance_to_see(bounds, target, oriented, room);
    if (options.orbit_deg != 0) {
      constexpr int kPlaces = 72;  // the distance is that of the whole turn: it must not breathe
      for (int i = 0; i < kPlaces; ++i) {
        const float around = azimuth + 360.0f * static_cast<float>(i) / kPlaces;
        const View there = looking(target + direction_towards(up, around, elevation), target, around);
        distance = std::max(distance, distance_to_see(bounds, target, there, room));
      }
    }
    return looking(target + distance * towards, target, azimuth + turned_deg);
  }
  View view = oriented;
  view.eye = tightest_eye(bounds, oriented, room);
  return view;
}

}  // namespace meniscus
