#include "surface/height_field_rays.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "surface/height_field_axes.h"

namespace meniscus {
namespace {

constexpr int kMostChanges = 1000;  ///< of sides along one ray, before it is given up
constexpr float kGrazing = 1e-3f;   ///< cosine that an interpolated normal keeps to the ray

vec3 unit(vec3 v, vec3 otherwise) {
  const float size = glm::length(v);
  return size > 0 ? v / size : otherwise;
}

}  // namespace

HeightFieldRays::HeightFieldRays(HeightField field, bool sides)
    : field_(std::move(field)), body_(field_), sides_(sides) {
  const double step = static_cast<double>(std::min(field_.step.x, field_.step.y));
  soon_ = field_.spacing > 0 ? static_cast<double>(field_.spacing) : step;
  nudge_ = 1e-7 * step;
}

FieldChange HeightFieldRays::enter(const FieldRay& ray, double from, double limit) const {
  return enter(ray, body_.clipped(ray, from, limit), limit);
}

FieldChange HeightFieldRays::enter(const FieldRay& ray, FieldStretch stretch, double limit) const {
  for (int i = 0; i < kMostChanges && stretch.found(); ++i) {
    FieldChange change = body_.first(ray, stretch.begin, stretch.end, true);
    if (!change.found()) return {};
    if (change.face == Face::start) change.face = stretch.first;
    if (sides_ || !is_side(change.face)) return change;
    // Not through a surface: the ray has been in the water, and may come back to it.
    const FieldChange out = leave(ray, change.t + nudge_, limit);
    if (!out.found()) return {};
    stretch = body_.clipped(ray, out.t + nudge_, limit);
  }
  return {};
}

FieldChange HeightFieldRays::leave(const FieldRay& ray, double from, double limit) const {
  const FieldStretch stretch = body_.clipped(ray, from, limit);
  if (!stretch.found() || stretch.begin > from) return {from, Face::start};
  FieldChange change = body_.first(ray, stretch.begin, stretch.end, false);
  if (!change.found() && stretch.last != Face::none) change = {stretch.end, stretch.last};
  if (change.found() && !sides_ && is_side(change.face)) return {};
  return change;
}

Crossing HeightFieldRays::into(const Ray& ray, float from, float limit) const {
  if (!(from <= limit)) return {};
  const FieldRay in_field = body_.field_ray(ray);
  double begin = static_cast<double>(from);
  const double end = static_cast<double>(limit);
  if (body_.inside(in_field, begin)) {  // against what was said
    const FieldChange out = leave(in_field, begin, std::min(end, begin + soon_));
    if (!out.found()) return crossing(ray, in_field, {begin, Face::start}, true);
    begin = out.t + nudge_;
  }
  return crossing(ray, in_field, enter(in_field, begin, end), true);
}

Crossing HeightFieldRays::out_of(const Ray& ray, float from, float limit) const {
  if (!(from <= limit)) return {};
  const FieldRay in_field = body_.field_ray(ray);
  double begin = static_cast<double>(from);
  const double end = static_cast<double>(limit);
  if (!body_.inside(in_field, begin)) {  // against what was said
    const FieldStretch stretch = body_.clipped(in_field, begin, std::min(end, begin + soon_));
    const FieldChange in = stretch.found() ? body_.first(in_field, stretch.begin, stretch.end, true) : FieldChange{};
    if (!in.found()) return crossing(ray, in_field, {begin, Face::start}, false);
    begin = in.t + nudge_;
  }
  return crossing(ray, in_field, leave(in_field, begin, end), false);
}

Crossing HeightFieldRays::crossing(const Ray& ray, const FieldRay& in_field, const FieldChange& change,
                                   bool entering) const {
  if (!change.found()) return {};
  return {static_cast<float>(change.t), normal(ray, in_field, change, entering)};
}

vec3 HeightFieldRays::hole_normal(double a, double b) const {
  // Down the slope of the bilinear mean of "is water".
  const int i = std::clamp(static_cast<int>(a), 0, body_.cells_a() - 1);
  const int j = std::clamp(static_cast<int>(b), 0, body_.cells_b() - 1);
  const auto wet = [&](int x, int y) {
    return body_.water()[static_cast<std::size_t>(y) * static_cast<std::size_t>(body_.cells_a() + 1) +
                         static_cast<std::size_t>(x)]
               ? 1.0f
               : 0.0f;
  };
  const float u = static_cast<float>(a - i), v = static_cast<float>(b - j);
  const float by_a = (1 - v) * (wet(i + 1, j) - wet(i, j)) + v * (wet(i + 1, j + 1) - wet(i, j + 1));
  const float by_b = (1 - u) * (wet(i, j + 1) - wet(i, j)) + u * (wet(i + 1, j + 1) - wet(i + 1, j));
  return FieldAxes(field_.up).place(-by_a / field_.step.x, -by_b / field_.step.y, 0.0f);
}

vec3 HeightFieldRays::normal(const Ray& ray, const FieldRay& in_field, const FieldChange& change, bool entering) const {
  const FieldAxes axes(field_.up);
  const vec3 towards = entering ? -ray.direction : ray.direction;
  const double a = in_field.a + change.t * in_field.da, b = in_field.b + change.t * in_field.db;
  switch (change.face) {
    case Face::side_a:
      return axes.place(a > 0.5 * body_.cells_a() ? 1.0f : -1.0f, 0.0f, 0.0f);
    case Face::side_b:
      return axes.place(0.0f, b > 0.5 * body_.cells_b() ? 1.0f : -1.0f, 0.0f);
    case Face::floor:
      return axes.place(0.0f, 0.0f, -1.0f);
    case Face::hole:
      return unit(hole_normal(a, b), towards);
    case Face::none:
    case Face::start:
      return towards;
    case Face::top:
      break;
  }
  const double in_a = std::clamp(a, 0.0, static_cast<double>(body_.cells_a()));
  const double in_b = std::clamp(b, 0.0, static_cast<double>(body_.cells_b()));
  const int i = std::min(static_cast<int>(in_a), body_.cells_a() - 1);
  const int j = std::min(static_cast<int>(in_b), body_.cells_b() - 1);
  const float u = static_cast<float>(in_a - i), v = static_cast<float>(in_b - j);
  vec3 normal;
  if (body_.kind(i, j) == HeightFieldBody::full) {
    const vec3 *near = field_.normal.row(j) + i, *far = field_.normal.row(j + 1) + i;
    normal = (1 - v) * ((1 - u) * near[0] + u * near[1]) + v * ((1 - u) * far[0] + u * far[1]);
  } else {
    normal = field_.at(static_cast<float>(in_a), static_cast<float>(in_b)).normal;
  }
  normal = unit(normal, axes.place(0.0f, 0.0f, 1.0f));
  // Interpolated normals may turn away from a ray that the surface itself faces: those are turned back to grazing.
  const float facing = glm::dot(normal, towards);
  if (facing < kGrazing) normal = unit(normal + (kGrazing - facing) * towards, towards);
  return normal;
}

vec3 HeightFieldRays::colour(const FieldRay& ray, double t) const {
  const double a = std::clamp(ray.a + t * ray.da, 0.0, static_cast<double>(body_.cells_a()));
  const double b = std::clamp(ray.b + t * ray.db, 0.0, static_cast<double>(body_.cells_b()));
  const int i = std::min(static_cast<int>(a), body_.cells_a() - 1),
            j = std::min(static_cast<int>(b), body_.cells_b() - 1);
  const float u = static_cast<float>(a - i), v = static_cast<float>(b - j);
  vec3 sum{0.0f};
  float weights = 0;
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 2; ++x) {
      const float weight = (x ? u : 1 - u) * (y ? v : 1 - v);
      if (!(weight > 0) || !(field_.height(i + x, j + y) > -std::numeric_limits<float>::infinity())) continue;
      sum += weight * field_.colour(i + x, j + y);
      weights += weight;
    }
  return weights > 0 ? sum / weights : sum;
}

}  // namespace meniscus
