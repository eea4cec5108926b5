/// Thickness of the water from one sphere a particle.
#pragma once

#include "particles/band_grid.h"

namespace meniscus {

/// Water along the rays of a perspective or orthographic view at its pixels or at `points`, m: the summed chords of
/// spheres of radius 1.25 spacings that each count for the water of one particle, smoothed.
/// @param spacing  m
Image<float> splatted_thickness(const BandGrid& grid, float spacing, const View& view,
                                std::span<const vec2> points);

/// A picture between the centres of its pixels, at `points`.
Image<float> sampled_picture(const Image<float>& picture, std::span<const vec2> points);

}  // namespace meniscus
