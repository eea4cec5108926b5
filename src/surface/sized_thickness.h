/// Thickness of particles that have sizes of their own.
#pragma once

#include "surface/raycast_field.h"

namespace meniscus {

/// As splatted_thickness(), level by level, each smoothed over its own largest spacing.
Image<float> sized_thickness(const RaycastField& field, const View& view, std::span<const vec2> points);

}  // namespace meniscus
