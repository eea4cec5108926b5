/// Rays followed through the union of balls, one a particle.
#pragma once

#include "surface/march_cells.h"

namespace meniscus {

/// The cells that balls of this radius reach into; none is known to be inside.
MarchCells ball_cells(const BandGrid& grid, float radius);

/// What Surface::crossings() promises, for the union of the balls: into the first ball, or out of the last one of those
/// that follow each other without a gap.
void ball_crossings(const BandGrid& grid, float radius, const MarchCells& cells, std::span<const Ray> rays,
                    std::span<const float> from, std::span<const float> limit, std::span<const std::uint8_t> inside,
                    std::span<Crossing> found);

}  // namespace meniscus
