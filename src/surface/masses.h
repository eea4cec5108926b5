/// Masses of particles with few neighbours.
#pragma once

#include "surface/packet.h"
#include "surface/raycast_field.h"

namespace meniscus {

/// Sets field.mass and field.entry_radius by the rule of raycast_field.h, from the density of unit masses at every
/// particle that is not in a hidden cell.
void find_masses(RaycastField& field);

/// Points near each other, at which densities are summed over one list of particles.
struct MassPoints {
  static constexpr std::size_t kMost = 64;
  std::size_t count = 0;
  std::uint32_t index[kMost];  ///< sorted
  alignas(64) float x[kMost];
  alignas(64) float y[kMost];
  alignas(64) float z[kMost];
};

/// rho of unit masses, in relation to the density inside the water, at all of the points.
/// @param density  MassPoints::kMost values
void unit_densities(const RaycastField& field, const MassPoints& points, PacketList& list, float* density);

}  // namespace meniscus
