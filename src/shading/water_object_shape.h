/// Shapes of bodies in the water: outlines and oriented boxes.
#pragma once

#include <span>

#include "meniscus/shading.h"

namespace meniscus {

/// Corners of a placed body's triangles in the world, three a triangle.
std::vector<vec3> world_triangles(const PlacedSolid& placed);

/// A horizontal place along a and b, the horizontal axes in the order x, y, z.
vec2 horizontal(vec3 point, Axis up);
vec3 raised(vec2 place, float level, Axis up);

/// Convex hull, counter-clockwise; fewer than three points where the points are on a line.
std::vector<vec2> convex_hull(std::vector<vec2> points);
/// Distance of two convex polygons; 0 where they overlap.
float distance_between(std::span<const vec2> one, std::span<const vec2> other);
/// The polygon's points moved away from its centre by `margin` m.
std::vector<vec2> grown_outline(std::span<const vec2> outline, float margin);

/// Places of the part of the triangles between two heights, cut at these.
std::vector<vec2> slab_places(std::span<const vec3> triangles, Axis up, float low, float high);

/// The smaller of the upright box along the world's axes and the box along the principal axes of the triangles' area.
struct OrientedBox {
  vec3 centre{0.0f};
  std::array<vec3, 3> half_axes{};  ///< the first is the one along which the box is highest
};
OrientedBox oriented_box(std::span<const vec3> triangles, vec3 up);

}  // namespace meniscus
