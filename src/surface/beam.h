/// Rays that run close together: they share what is gathered from the grid, then each has a short list of its own,
/// of the particles within reach of the stretch that it looks at. Compiled once for each instruction set.
#pragma once

#include "surface/packet.h"

namespace meniscus {

constexpr int kBeam = 64;        ///< rays at most
using BeamMask = std::uint64_t;  ///< bit i: ray i

/// The particles near a stretch of one ray, by what is left of them along it: the one at distance r of the place t has
///   s(t) = 1 - r^2 / h^2 = core - (t / h - place)^2
/// with `place` where along the ray it is nearest, in units of h, from the start of the stretch. Filled up with
/// particles of no mass to a whole number of vectors.
struct RayList {
  AlignedFloats place, core, mass;
  AlignedFloats per_h;  ///< 1/m, if field.has_sizes()
  std::size_t count = 0;
  void reserve(std::size_t wanted, bool sizes);
};

/// Room that a thread keeps from beam to beam.
struct BeamLists {
  static constexpr int kRays = 8;    ///< that are looked at in turn, so that none waits for what it has just written
  static constexpr int kLevels = 3;  ///< the whole beam's, a quarter's, a sixteenth's
  PacketList near[kLevels];
  RayList ray[kRays];
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
