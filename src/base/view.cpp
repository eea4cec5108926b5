#include <fmt/format.h>
#include <cmath>
#include <glm/geometric.hpp>

#include "meniscus/base.h"

namespace meniscus {
namespace {

/// Position of a picture point on the plane at distance 1 (perspective) or in metres (orthographic).
vec2 on_plane(const View& view, vec2 picture_point) {
  const float pixels_to_plane = 2.0f * view.half_height / static_cast<float>(view.height);
  return {(picture_point.x - 0.5f * static_cast<float>(view.width)) * pixels_to_plane,
          (0.5f * static_cast<float>(view.height) - picture_point.y) * pixels_to_plane};
}

View oriented(vec3 eye, vec3 target, vec3 up_hint, int width, int height) {
  if (width < 1 || height < 1)
    throw Error(ErrorCode::invalid_argument, fmt::format("a picture of {} x {} pixels cannot be drawn", width, height));
  const vec3 towards = target - eye;
  if (!(glm::length(towards) > 0) || !std::isfinite(glm::length(towards)))
    throw Error(ErrorCode::invalid_argument, "the camera stands where it looks at, or not at a finite place");
  View view;
  view.width = width;
  view.height = height;
  view.eye = eye;
  view.forward = glm::normalize(towards);
  // Looking along the up axis: any other axis serves; take the one that is least along the view.
  if (!(glm::length(glm::cross(view.forward, up_hint)) > 1e-4f * glm::length(up_hint))) {
    const vec3 size = glm::abs(view.forward);
    up_hint = size.z <= size.x && size.z <= size.y ? vec3{0, 0, 1} : (size.y <= size.x ? vec3{0, 1, 0} : vec3{1, 0, 0});
  }
  view.right = glm::normalize(glm::cross(view.forward, up_hint));
  view.up = glm::cross(view.right, view.forward);
  return view;
}

}  // namespace

Ray View::ray(vec2 picture_point) const {
  const vec2 p = on_plane(*this, picture_point);
  const vec3 offset = p.x * right + p.y * up;
  if (projection == Projection::orthographic) return {eye + offset, forward};
  return {eye, glm::normalize(forward + offset)};
}

vec3 View::project(vec3 point) const {
  const vec3 offset = point - eye;
  const float z = glm::dot(offset, forward);
  const float on_unit = projection == Projection::perspective ? 1.0f / z : 1.0f;
  const float plane_to_pixels = 0.5f * static_cast<float>(height) / half_height;
  return {0.5f * static_cast<float>(width) + glm::dot(offset, right) * on_unit * plane_to_pixels,
          0.5f * static_cast<float>(height) - glm::dot(offset, up) * on_unit * plane_to_pixels, z};
}

float View::pixel_size(float depth) const {
  const float at_one = 2.0f * half_height / static_cast<float>(height);
  return projection == Projection::perspective ? at_one * depth : at_one;
}

View View::resized(int new_width, int new_height) const {
  View view = *this;
  view.width = new_width;
  view.height = new_height;
  return view;
}

View perspective_view(vec3 eye, vec3 target, vec3 up_hint, float vertical_fov, int width, int height) {
  if (!(vertical_fov > 0.0f && vertical_fov < 3.1415f))
    throw Error(ErrorCode::invalid_argument,
                fmt::format("a field of view of {} radians is not in (0, pi)", vertical_fov));
  View view = oriented(eye, target, up_hint, width, height);
  view.half_height = std::tan(0.5f * vertical_fov);
  return view;
}

View orthographic_view(vec3 eye, vec3 target, vec3 up_hint, float world_height, int width, int height) {
  if (!(world_height > 0.0f))
    throw Error(ErrorCode::invalid_argument, fmt::format("a picture {} m high cannot be drawn", world_height));
  View view = oriented(eye, target, up_hint, width, height);
  view.projection = Projection::orthographic;
  view.half_height = 0.5f * world_height;
  return view;
}

}  // namespace meniscus
