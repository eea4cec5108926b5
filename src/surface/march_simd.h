/// The two halves of density_packet, so that one list of neighbours serves several samples.
#pragma once

#include "surface/packet.h"

namespace meniscus {

/// Fills the list with the particles within the smoothing length of the box.
void gather_near(const RaycastField& field, vec3 low, vec3 high, PacketList& list);
/// Density at sixteen points from a list that holds all particles near them.
void density_from(const RaycastField& field, const PacketList& list, const PacketPoints& points, float* density);

}  // namespace meniscus
