/// Masses of particles with few neighbours.
#pragma once

#include "surface/raycast_field.h"

namespace meniscus {

/// Sets field.mass and field.entry_radius by the rule of raycast_field.h, from the density of unit masses at every
/// particle that is not in a hidden cell.
void find_masses(RaycastField& field);

}  // namespace meniscus
