#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
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

View View::face(int index) const {
  const vec3 towards = index < 2 ? right : index < 4 ? up : forward;
  View view;
  view.width = view.height = height;
  view.eye = eye;
  view.half_height = 1.0f;
  view.forward = index % 2 == 0 ? towards : -towards;
  // Side faces keep the picture's up; the upper face has the back at its top, the lower one the front.
  view.up = index == 2 ? -forward : index == 3 ? forward : up;
  view.right = glm::cross(view.forward, view.up);
  return view;
}

Ray View::ray(vec2 picture_point) const {
  if (projection == Projection::cube) {
    const float size = static_cast<float>(height);
    const int index = std::clamp(static_cast<int>(picture_point.x / size), 0, 5);
    return face(index).ray({picture_point.x - static_cast<float>(index) * size, picture_point.y});
  }
  const vec2 p = on_plane(*this, picture_point);
  const vec3 offset = p.x * right + p.y * up;
  if (projection == Projection::orthographic) return {eye + offset, forward};
  return {eye, glm::normalize(forward + offset)};
}

vec3 View::project(vec3 point) const {
  const vec3 offset = point - eye;
  if (projection == Projection::cube) {
    // The face is that of the axis along which the point is farthest.
    const vec3 along{glm::dot(offset, right), glm::dot(offset, up), glm::dot(offset, forward)};
    const vec3 size = glm::abs(along);
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const int index = 2 * axis + (along[axis] < 0 ? 1 : 0);
    const vec3 on_face = face(index).project(point);
    return {on_face.x + static_cast<float>(index * height), on_face.y, on_face.z};
  }
  const float z = glm::dot(offset, forward);
  const float on_unit = projection == Projection::perspective ? 1.0f / z : 1.0f;
  const float plane_to_pixels = 0.5f * static_cast<float>(height) / half_height;
  return {0.5f * static_cast<float>(width) + glm::dot(offset, right) * on_unit * plane_to_pixels,
          0.5f * static_cast<float>(height) - glm::dot(offset, up) * on_unit * plane_to_pixels, z};
}

float View::pixel_size(float depth) const {
  const float at_one = 2.0f * half_height / static_cast<float>(height);
  return projection == Projection::orthographic ? at_one : at_one * depth;
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

View cube_view(vec3 eye, int size) {
  if (size < 1 || size > (1 << 16))
    throw Error(ErrorCode::invalid_argument, fmt::format("a cube of faces of {} pixels cannot be drawn", size));
  View view;
  view.projection = Projection::cube;
  view.width = 6 * size;
  view.height = size;
  view.eye = eye;
  view.half_height = 1.0f;
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
