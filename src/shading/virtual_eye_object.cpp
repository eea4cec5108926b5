#include "shading/virtual_eye_object.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace meniscus {
namespace {

/// The scale that is allowed; outside of it the eye looks along the axis, and there is nothing to correct.
constexpr float kLeastScale = 0.02f, kMostScale = 4.0f;

/// The main axis' cut with the plane, or the foot of the box's centre where it is not cut.
vec3 axis_cut(const ApproximatingPlane& plane, const WaterObject& object) {
  const float top = plane.height(object.axis_top), end = plane.height(object.axis_end);
  if (top * end < 0) return glm::mix(object.axis_top, object.axis_end, top / (top - end));
  return plane.projected(object.box_centre);
}

}  // namespace

vec3 nearest_point(const ApproximatingPlane& plane, vec3 eye, const WaterObject& object) {
  const vec3 foot = plane.projected(eye), cut = axis_cut(plane, object);
  const vec3 way = cut - foot;
  // The last stretch of the way that lies in the box, by its three pairs of faces.
  float enter = 0, leave = 1;
  for (const vec3& half : object.half_axes) {
    const float square = glm::dot(half, half);
    if (!(square > 0)) continue;
    // In units of the half axis: -1 and 1 are the faces.
    const float start = glm::dot(foot - object.box_centre, half) / square, along = glm::dot(way, half) / square;
    if (std::abs(along) < 1e-9f) {
      if (std::abs(start) > 1) return cut;
      continue;
    }
    const float a = (-1 - start) / along, b = (1 - start) / along;
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter <= leave ? foot + enter * way : cut;
}

VirtualEye VirtualEye::reflected(const ApproximatingPlane& plane, vec3 eye) {
  VirtualEye result;
  result.plane_ = plane;
  result.eye_ = eye;
  result.position_ = reflected_eye(plane, eye);
  result.reflected_ = true;
  return result;
}

VirtualEye VirtualEye::refracted(const ApproximatingPlane& plane, vec3 eye, vec3 a, float ratio,
                                 const VirtualEyeOptions& options) {
  VirtualEye result;
  result.plane_ = plane;
  result.eye_ = eye;
  result.ratio_ = ratio;
  result.position_ = options.displaced_eye ? refracted_eye(plane, eye, a, ratio).value_or(eye) : eye;
  result.per_point_ = options.displaced_eye && options.per_point;
  result.pivot_ = a;
  return result;
}

VirtualEye VirtualEye::refracted(const ApproximatingPlane& plane, vec3 eye, const WaterObject& object, float ratio,
                                 const VirtualEyeOptions& options) {
  // The far end of the main axis, and the near one where the object does not reach the plane.
  const bool top_first = plane.height(object.axis_top) > plane.height(object.axis_end);
  const vec3 near_end = top_first ? object.axis_top : object.axis_end;
  const vec3 far_end = top_first ? object.axis_end : object.axis_top;
  vec3 pivot = nearest_point(plane, eye, object), a = pivot;
  if (plane.height(near_end) < 0) {
    pivot = near_end;
    a = refraction_point(plane, eye, pivot, ratio);
  } else if (!refracted_eye(plane, eye, a, ratio)) {
    // An eye in the water sees the foot of what stands out of it at total reflection; its middle it does see.
    pivot = 0.5f * (pivot + far_end);
    a = refraction_point(plane, eye, pivot, ratio);
  }
  VirtualEye result = refracted(plane, eye, a, ratio, options);
  result.pivot_ = pivot;
  if (!options.displaced_eye || !options.scale_correction || result.per_point_) return result;

  // b, at the end of the axis' parallel through the pivot, is to be seen where it is seen in truth: scaled it lies as
  // near as it can to the ray from the virtual eye in the direction in which its true ray is refracted.
  const vec3 axis = far_end - near_end;
  const float length = glm::length(axis);
  if (!(length > 0) || !(plane.height(far_end) < 0)) return result;
  result.axis_ = axis / length;
  const float reach = glm::dot(far_end - pivot, result.axis_);
  const vec3 b = pivot + reach * result.axis_;
  if (!(reach > 1e-6f * length) || !(plane.height(b) < 0)) return result;
  const vec3 b_real = refraction_point(plane, eye, b, ratio);
  const vec3 d = glm::normalize(b - b_real);
  const vec3 missed = b - result.position_ - glm::dot(b - result.position_, d) * d;
  const vec3 across = result.axis_ - glm::dot(result.axis_, d) * d;
  const float square = glm::dot(across, across);
  if (!(square > 1e-4f)) return result;
  // Beside a, directions differ by `ratio` of what they differ by in the air: so much of its width is seen there.
  result.across_ = ratio;
  result.scale_ = std::clamp(1.0f - glm::dot(missed, across) / (square * reach), kLeastScale, kMostScale);
  return result;
}

std::optional<MapRay> VirtualEye::ray(vec3 direction) const {
  const float along = glm::dot(direction, plane_.normal);
  if (reflected_ ? !(along > 0) : !(along < 0)) return std::nullopt;
  if (per_point_) {
    const auto entry = entry_of(plane_, eye_, direction, ratio_);
    if (!entry) return std::nullopt;
    const float length = glm::length(*entry - eye_);
    return MapRay{{*entry - length * direction, direction}, length, 1.0f};
  }
  MapRay result{{position_, direction}, 0, 1};
  if (scale_ != 1.0f || across_ != 1.0f) {
    // The object scaled around the pivot is met by a ray where the object itself is met by the ray scaled back.
    const auto scaled_back = [&](vec3 v) {
      return v / across_ + (1.0f / scale_ - 1.0f / across_) * glm::dot(v, axis_) * axis_;
    };
    result.ray.origin = pivot_ + scaled_back(position_ - pivot_);
    const vec3 scaled = scaled_back(direction);
    result.scale = glm::length(scaled);
    result.ray.direction = scaled / result.scale;
  }
  const float down = glm::dot(result.ray.direction, plane_.normal);
  if (reflected_ ? !(down > 0) : !(down < 0)) return std::nullopt;
  result.from = std::max(0.0f, -plane_.height(result.ray.origin) / down);
  return result;
}

}  // namespace meniscus
