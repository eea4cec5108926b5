/// Thickness of the water from particles that no grid has sorted.
#pragma once

#include "meniscus/base.h"

namespace meniscus {

/// As splatted_thickness(), of all particles one by one: no memory but the picture's, and no boxes for the midst of the
/// water. The two differ by a hundredth of the mean thickness (root mean square, tanks of 1.5 and 5 million particles
/// whose spacing is a pixel).
/// @param spacing  m
Image<float> particle_thickness(const Particles& particles, float spacing, const View& view,
                                std::span<const vec2> points);

}  // namespace meniscus
