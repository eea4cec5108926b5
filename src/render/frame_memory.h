/// What a frame's drawing holds in memory.
#pragma once

#include "meniscus/render.h"

namespace meniscus {

/// Whether the water can be drawn in slabs: nothing asks where rays go on inside of it.
bool can_be_cut(SurfaceMethod method, RefractionMethod refraction, bool transparent, bool caustics, bool rain);
bool can_be_cut(const PictureOptions& picture);

/// Pixels that rays are cast for: four times the picture's with Antialias::full.
std::uint64_t ray_pixels(const PictureOptions& picture);

/// Bytes of pictures, light and the film's encoder while a frame is drawn, without the surface's own buffers.
std::uint64_t picture_bytes(const PictureOptions& picture, PictureFormat format);

/// Bytes of the surface of so many particles while it is made or seen; of what is left of it in `slabs`.
/// @param bounds  m; empty: not known, a tank of water is taken
std::uint64_t surface_bytes(std::uint64_t particles, const Bounds& bounds, float spacing, const PictureOptions& picture,
                            int slabs);
/// Slabs that keep the surface within `bytes`; 1 where it fits as a whole; 0: none do.
int slabs_for(std::uint64_t bytes, std::uint64_t particles, const Bounds& bounds, float spacing,
              const PictureOptions& picture);

/// The least of the surface's bytes that will do: in slabs, if it can be cut.
std::uint64_t least_surface_bytes(std::uint64_t particles, const Bounds& bounds, float spacing,
                                  const PictureOptions& picture);

/// The resident set of this process now, bytes.
std::uint64_t resident_bytes();

/// "1.5 GB"
std::string size_text(std::uint64_t bytes);

/// The refusal of a frame that does not fit, with what would help: only options with which it would fit.
/// @param least  bytes that the frame would do with, drawn with other options
Error does_not_fit(const PictureOptions& picture, std::uint64_t limit, const std::string& path,
                   const std::string& problem, FunctionRef<std::uint64_t(const PictureOptions&)> least);

}  // namespace meniscus
