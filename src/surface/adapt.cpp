// A field bent towards planes around objects [Cords2008] 2.2.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "meniscus/surface.h"
#include "surface/height_field_axes.h"

namespace meniscus {
namespace {

constexpr float kDry = -std::numeric_limits<float>::infinity();
constexpr float kUpright = 0.1f;  ///< of the normal along up: steeper planes are no water

float distance_to_edge(vec2 p, vec2 from, vec2 to) {
  const vec2 edge = to - from;
  const float size2 = glm::dot(edge, edge);
  const float part = size2 > 0 ? std::clamp(glm::dot(p - from, edge) / size2, 0.0f, 1.0f) : 0.0f;
  return glm::length(p - from - part * edge);
}

/// Distance to a convex polygon, 0 inside.
float distance_to(std::span<const vec2> outline, vec2 p) {
  float least = std::numeric_limits<float>::infinity();
  bool left = false, right = false;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const vec2 from = outline[k], to = outline[(k + 1) % outline.size()];
    const vec2 edge = to - from, off = p - from;
    const float turn = edge.x * off.y - edge.y * off.x;
    left = left || turn > 0;
    right = right || turn < 0;
    least = std::min(least, distance_to_edge(p, from, to));
  }
  return outline.size() > 2 && !(left && right) ? 0.0f : least;
}

/// A plane as it is mixed in.
struct Bend {
  const PlaneAdaptation* plane;
  vec3 normal;
  vec2 low, high;  ///< m, box of where it reaches
};

bool usable(const PlaneAdaptation& plane, const FieldAxes& axes, vec3& normal) {
  const float size = glm::length(plane.normal);
  if (plane.outline.empty() || !(size > 0) || !std::isfinite(size) || !(plane.width >= 0) ||
      !std::isfinite(plane.width))
    return false;
  if (!std::isfinite(plane.point.x + plane.point.y + plane.point.z)) return false;
  for (const vec2 p : plane.outline)
    if (!std::isfinite(p.x + p.y)) return false;
  normal = plane.normal / size;
  return normal[axes.up] > kUpright;
}

}  // namespace

void adapt(HeightField& field, std::span<const PlaneAdaptation> planes) {
  const FieldAxes axes(field.up);
  std::vector<Bend> bends;
  for (const PlaneAdaptation& plane : planes) {
    Bend bend{&plane, {}, plane.outline.empty() ? vec2{0.0f} : plane.outline[0], {}};
    if (!usable(plane, axes, bend.normal)) continue;
    bend.high = bend.low;
    for (const vec2 p : plane.outline) {
      bend.low = {std::min(bend.low.x, p.x), std::min(bend.low.y, p.y)};
      bend.high = {std::max(bend.high.x, p.x), std::max(bend.high.y, p.y)};
    }
    bend.low -= plane.width;
    bend.high += plane.width;
    bends.push_back(bend);
  }
  if (bends.empty() || field.empty()) return;
  if (field.normal.size() != field.height.size()) find_normals(field);
  parallel_for(static_cast<std::size_t>(field.height.height()), 8, [&](std::size_t begin, std::size_t end) {
    for (int j = static_cast<int>(begin); j < static_cast<int>(end); ++j)
      for (int i = 0; i < field.height.width(); ++i) {
        float& level = field.height(i, j);
        if (!(level > kDry)) continue;
        const vec2 p{field.low.x + static_cast<float>(i) * field.step.x,
                     field.low.y + static_cast<float>(j) * field.step.y};
        // Of several planes each counts by w / (1 - w): where one is all there is, the others are nothing.
        float most = 0, weights = 0, level_sum = 0;
        vec3 normal_sum{0.0f};
        for (const Bend& bend : bends) {
          if (p.x < bend.low.x || p.y < bend.low.y || p.x > bend.high.x || p.y > bend.high.y) continue;
          const float away = distance_to(bend.plane->outline, p);
          const float part = away <= 0 ? 1.0f : bend.plane->width > 0 ? 1.0f - away / bend.plane->width : 0.0f;
          if (!(part > 0)) continue;
          most = std::max(most, part);
          const float weight = part / std::max(1.0f - part, 1e-6f);
          const vec3 off = bend.plane->point - axes.place(p.x, p.y, 0.0f);
          weights += weight;
          level_sum += weight * (glm::dot(off, bend.normal) / bend.normal[axes.up]);
          normal_sum += weight * bend.normal;
        }
        if (!(weights > 0)) continue;
        level = std::max(level + most * (level_sum / weights - level), std::min(field.floor, level));
        const vec3 normal = (1.0f - most) * field.normal(i, j) + most * glm::normalize(normal_sum);
        field.normal(i, j) = glm::normalize(normal);
      }
  });
}

}  // namespace meniscus
