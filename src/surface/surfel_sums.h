/// Density, its gradient and the curvatures of its iso-surface at sixteen points; compiled once for each instruction
/// set.
#pragma once

#include "surface/packet.h"

namespace meniscus {

struct IsoSums {
  alignas(64) float density[kPacket];  ///< relative, as RaycastField says
  alignas(64) float gx[kPacket];       ///< gradient of the density, 1/m
  alignas(64) float gy[kPacket];
  alignas(64) float gz[kPacket];
  /// Curvature in a frame of two tangents t, u: t K t, u K u and t K u, 1/m, > 0 where the water bulges; see iso_sums()
  alignas(64) float tt[kPacket];
  alignas(64) float uu[kPacket];
  alignas(64) float tu[kPacket];
};

/// Two unit vectors along the surface, across each other.
struct PacketTangents {
  PacketPoints t, u;
};

/// Sums over the list at all sixteen points.
/// @param tangents  null: no curvature. Else K = -H / |gradient| with the second derivatives H of the density.
void iso_sums(const RaycastField& field, const PacketList& list, const PacketPoints& points,
              const PacketTangents* tangents, IsoSums& sums);

}  // namespace meniscus
