/// The ground that it rains on: its cells as the settings describe them, and its shape as a mesh.
#pragma once

#include <memory>

#include "meniscus/render.h"

namespace meniscus {

/// The options of the cells, with materials and heights from images, made-up ruts, or a body seen from above.
/// @param seen  the body's scene, where ground.mesh is set; may be null else
/// @throws Error  as read_png(); invalid_argument: a mesh and no scene, heights that are not finite
GroundOptions ground_cells(const RainGround& ground, const Scene* seen);

/// Heights of the bed as triangles through the middles of the cells, with a skirt that runs out into a plane.
/// @param plane  m along up, of the scene's ground around the cells
Mesh relief_mesh(const WetGround& ground, float plane);

/// Lowest bed of all cells, m along up.
float lowest_bed(const WetGround& ground);
float highest_bed(const WetGround& ground);

}  // namespace meniscus
