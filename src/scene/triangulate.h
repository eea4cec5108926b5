/// Polygons cut into triangles.
#pragma once

#include "meniscus/base.h"

namespace meniscus {

/// Cuts ears off a polygon in space, which may be concave and slightly bent; one that crosses itself becomes triangles
/// of some kind. Appends three corners a triangle, count - 2 triangles.
/// @param polygon  indices of points, in order around it
void triangulate(std::span<const vec3> points, std::span<const std::uint32_t> polygon,
                 std::vector<std::uint32_t>& corners);

}  // namespace meniscus
