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

/// The same, and all pixels that show water made of particles where they are wider than four thirds of a spacing, with
/// those around it that have water in their thickness: drops, and what the surface is like between two rays, would come
/// and go from picture to picture.
std::vector<std::uint32_t> with_wide_pixels(std::vector<std::uint32_t> pixels, const Surface& surface, const View& view,
                                            const SurfaceBuffers& buffers);

constexpr std::size_t kPixelsAtOnce = 16384;  ///< bounds the memory: about 650 bytes a pixel

/// Draws those pixels anew as the average of 4 x 4 rays in each, or of four where those see about the same; coverage
/// and thickness become means as well. Pixels wider than half a spacing of the surface's particles always have 4 x 4,
/// whose normals are their own: those of the picture's pixels lie too far apart to tell them.
/// @param at_once  pixels whose rays are cast together: more for surfaces that do much work for each question
void refine_pixels(const Surface& surface, const View& view, const Scene& scene, const Material& material,
                   const OpticsInputs& optics, std::span<const std::uint32_t> pixels, SurfaceBuffers& buffers,
                   Image<vec3>& radiance, std::size_t at_once = kPixelsAtOnce);

/// The buffers of a picture of twice the size at its own size: coverage and thickness are means; depth, normal and
/// the rest are of the nearest of the four, colour is the mean of those that show water.
SurfaceBuffers halved(const SurfaceBuffers& fine);

}  // namespace meniscus
