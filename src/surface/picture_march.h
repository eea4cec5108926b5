/// The march of a whole picture: from where rays may first meet water to where they do.
#pragma once

#include "surface/raycast_field.h"

namespace meniscus {

/// Fills buffers.depth and buffers.coverage from buffers.entry and buffers.exit, all of one size: that of the view, or
/// N x 1 for `points`. Entry and exit are m along the rays; entry > exit where nothing is met. Rays march upwards
/// through the iso-value, downwards where buffers.eye_in_water.                              [Xiao2017] 3.2
void march_picture(const RaycastField& field, const View& view, std::span<const vec2> points, SurfaceBuffers& buffers);

}  // namespace meniscus
