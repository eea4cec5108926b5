/// Splashes as a view sees them: those out of it, and those too small for their parts to be seen.
#pragma once

#include <span>

#include "meniscus/sim.h"

namespace meniscus {

/// Whether a ball may show in the picture or within a pixel of its border; true if in doubt.
bool may_show(const View& view, vec3 centre, float radius);

/// m^2 that the piece covers seen along `direction` (unit), by its opacity. The outline of a closed convex body covers
/// half the sum of what its faces do.
float covered_area(const WaterPiece& piece, vec3 direction);

/// The sphere at the pieces' middle that covers as much as all of them, seen from the view's eye.
/// @param pieces  at least one
WaterPiece merged(std::span<const WaterPiece> pieces, const View& view);

}  // namespace meniscus
