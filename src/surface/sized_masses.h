/// Masses of particles that have sizes of their own.
#pragma once

#include "surface/raycast_field.h"

namespace meniscus {

/// Masses and entry radii of all levels from the density of all levels at each particle's place, by the rules of its
/// own size; masses must be one before. Particles of hidden cells are left as they are.
void find_sized_masses(RaycastField& field);

}  // namespace meniscus
