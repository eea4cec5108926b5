/// Thickness of the water: how much of it each ray runs through.
#pragma once

#include <functional>

#include "surface/splat_camera.h"
#include "surface/thickness_cells.h"

namespace meniscus {

/// Water along the rays of a perspective or orthographic view at its pixels or at `points`, m: what spheres of radius
/// 1.25 spacings that each count for the water of one particle add up to, smoothed.
///
/// Not by one sphere a particle: cells amidst well filled ones are known by the number of their particles alone, whole
/// blocks of them are one box, and what is small in the picture is a point whose water is spread by the same amount
/// afterwards. Within a twentieth of the spheres' sums where the water is deeper than four spacings, and the water of
/// all particles before the eye is kept.
/// @param spacing  m
Image<float> splatted_thickness(const BandGrid& grid, float spacing, const View& view, std::span<const vec2> points);
/// The same of water that is seen more than once: its cells are counted once.
Image<float> splatted_thickness(const CountedCells& counted, float spacing, const View& view,
                                std::span<const vec2> points);

/// Water whose thickness is summed.
struct WaterBody {
  Bounds bounds;      ///< of its particles
  std::size_t count;  ///< of them
  float spacing;      ///< m
};

/// splatted_thickness() of water whose sums are made elsewhere.
/// @param sum  gives summed_water() of all of it through a camera
Image<float> thickness_by_sums(const WaterBody& water, const View& view, std::span<const vec2> points,
                               const std::function<Image<float>(const SplatCamera&)>& sum);

/// A picture between the centres of its pixels, at `points`.
Image<float> sampled_picture(const Image<float>& picture, std::span<const vec2> points);

}  // namespace meniscus
