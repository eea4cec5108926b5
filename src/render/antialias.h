/// The pixels in which the water's outline or one of its folds passes, and their pictures from many rays.
#pragma once

#include <cstdint>

#include "meniscus/render.h"

namespace meniscus {

/// Indices (row by row) of the pixels that differ from one of their four neighbours: in coverage, or because the
/// ground hides the water in one of them; in depth, by more than two spacings beyond what the slope of the surface
/// explains; or in normal, by more than 35 degrees.
/// @param solids  what is seen of the scene without water, if it has edges and outlines of its own
std::vector<std::uint32_t> silhouette_pixels(const View& view, const SurfaceBuffers& buffers, const Scene& scene,
                                             float spacing, const SceneBuffers* solids = nullptr);

constexpr std::size_t kPixelsAtOnce = 16384;  ///< bounds the memory: about 650 bytes a pixel

/// Draws those pixels anew as the average of 4 x 4 rays in each, or of four where those see about the same; coverage
/// and thickness become means as well.
/// @param at_once  pixels whose rays are cast together: more for surfaces that do much work for each question
void refine_pixels(const Surface& surface, const View& view, const Scene& scene, const Material& material,
                   const OpticsInputs& optics, std::span<const std::uint32_t> pixels, SurfaceBuffers& buffers,
                   Image<vec3>& radiance, std::size_t at_once = kPixelsAtOnce);

/// The buffers of a picture of twice the size at its own size: coverage and thickness are means; depth, normal and
/// the rest are of the nearest of the four, colour is the mean of those that show water.
SurfaceBuffers halved(const SurfaceBuffers& fine);

}  // namespace meniscus
