/// Bilateral Gaussian filter of the normal map.
#pragma once

#include "meniscus/surface.h"

namespace meniscus {

/// Smooths normals over a window of (2 radius + 1)^2 pixels with weights
///   exp(-r^2 / (2 sigma^2)) exp(-e^2 / (2 tolerance^2)) exp(-(1 - n . n') / sharpness)       [AurichWeule1995]
/// where r is the distance in pixels, sigma = radius / 2, and e the distance of the neighbour's surface point
/// from the tangent plane of the pixel: a plane seen at a slant is smoothed whole, nothing across a depth edge.
/// @param depth      m along the rays of `view`; infinite where there is no surface
/// @param radius     px, 1 .. 128
/// @param tolerance  m
/// @return           unit normals, zero where there is no surface
Image<vec3> filtered_normals(const View& view, const Image<float>& depth, const Image<vec3>& normals, int radius,
                             float tolerance);

/// Gives single points the smoothness of the filtered map: the mean of the normals around that belong to the same
/// piece of surface, where there are any.
/// @param coarse     depth and filtered normals of the view's pixels
/// @param points     picture points of the N x 1 images of `fine`, whose normals are replaced
/// @param tolerance  m
void take_filtered_normals(const View& view, const SurfaceBuffers& coarse, std::span<const vec2> points,
                           float tolerance, SurfaceBuffers& fine);

/// 1 - cosine of the angle at which two normals stop mixing in the filter: about 30 degrees.
constexpr float kNormalSharpness = 0.13f;

}  // namespace meniscus
