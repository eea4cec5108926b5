/// Where spray can and cannot make a surface.
#pragma once

#include "surface/raycast_field.h"

namespace meniscus {

/// Makes the entry spheres of particles with few others around as small as their surface allows, and takes them away
/// where the iso-value cannot be reached at all: no ray starts to march there. With n particles within two smoothing
/// lengths, none heavier than m, the density d away from the nearest of them is at most n m spacing^3 W(d, h); the
/// sphere is that where this falls to the iso-value, and so much larger that a ray that grazes it is sampled on either
/// side. Fields of particles that are alike, whose radii have been found.
void shrink_entries_of_spray(RaycastField& field);

}  // namespace meniscus
