/// The normals of a whole picture.
#pragma once

#include "surface/raycast_field.h"

namespace meniscus {

/// Fills buffers.normal, and buffers.colour where the particles have colours, where buffers.depth is finite; not
/// filtered yet. A ray that starts in the water meets the face that the view's plane cuts.      [Xiao2017] 3.3
void find_picture_normals(const RaycastField& field, const View& view, std::span<const vec2> points,
                          SurfaceBuffers& buffers);

}  // namespace meniscus
