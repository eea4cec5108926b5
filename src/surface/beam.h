/// Rays that run close together: they share what is gathered from the grid, then fours of them have short lists of
/// their own, of the particles within reach of the stretches that they look at. Compiled once for each instruction set.
#pragma once

#include "surface/packet.h"

namespace meniscus {

constexpr int kBeam = 64;        ///< rays at most
using BeamMask = std::uint64_t;  ///< bit i: ray i

/// Room that a thread keeps from beam to beam.
struct BeamLists {
  PacketList whole, part, four[4];  ///< near all of a beam's rays, near sixteen, near four
};

/// `count` rays; beyond them the packets that they fill in part hold copies. Rays that follow each other should run
/// close together, four and sixteen of them closer than all.
struct Beam {
  PacketRays rays[kBeam / kPacket];
  float entry[kBeam], exit[kBeam], depth[kBeam];  ///< m along each ray
  int count = 0;
  float along = 0, across = 0;  ///< m: what rays look at is shared if it lies within so much of each other

  vec3 origin(int i) const {
    const PacketRays& of = rays[i / kPacket];
    const int l = i % kPacket;
    return {of.ox[l], of.oy[l], of.oz[l]};
  }
  vec3 direction(int i) const {
    const PacketRays& of = rays[i / kPacket];
    const int l = i % kPacket;
    return {of.dx[l], of.dy[l], of.dz[l]};
  }
};

/// Marches the rays from `entry` to `exit` until the density crosses the iso-value: upwards, or downwards when
/// `from_inside`. Fills beam.depth, +infinity where nothing is met.                              [Xiao2017] 3.2
void march_beam(const RaycastField& field, bool from_inside, BeamLists& lists, Beam& beam);

}  // namespace meniscus
