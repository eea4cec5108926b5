/// Rays in any direction followed through the particles' density to where they cross the surface.
#pragma once

#include "surface/march_cells.h"

namespace meniscus {

/// Surface::crossings on a density field. The density is sampled every field.step along each ray where MarchCells
/// cannot tell, more densely next to its start, which is mostly a point on the surface; crossings are refined as those
/// of see(), and have the normals of [Xiao2017] 3.3 without the filter in the picture.
///
/// A ray is given a spacing to come to the side that `inside` says; if it stays on the other one it crosses where it
/// starts. Sixteen consecutive rays share their work where they are near each other; what a ray finds does not depend
/// on the others.
/// @throws Error invalid_argument: spans of different lengths
void march_crossings(const RaycastField& field, const MarchCells& cells, std::span<const Ray> rays,
                     std::span<const float> from, std::span<const float> limit, std::span<const std::uint8_t> inside,
                     std::span<Crossing> found);

}  // namespace meniscus
