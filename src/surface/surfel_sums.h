/// Density, its gradient and the curvature of its iso-surface at sixteen points; compiled once for each instruction
/// set.
#pragma once

#include "surface/packet.h"

namespace meniscus {

struct IsoSums {
  alignas(64) float density[kPacket];  ///< relative, as RaycastField says
  alignas(64) float gx[kPacket];       ///< gradient of the density, 1/m
  alignas(64) float gy[kPacket];
  alignas(64) float gz[kPacket];
  alignas(64) float curvature[kPacket];  ///< mean curvature, 1/m, > 0 where the water bulges; see iso_sums()
};

/// Sums over the list at all sixteen points.
/// @param normals  null: no curvature. Else unit vectors n out of the water, and the curvature is half the divergence
///                 of the normals, -(laplacian - n . H n) / (2 |gradient|) with H the second derivatives.
void iso_sums(const RaycastField& field, const PacketList& list, const PacketPoints& points,
              const PacketPoints* normals, IsoSums& sums);

}  // namespace meniscus
