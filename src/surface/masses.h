/// Masses of particles with few neighbours.
#pragma once

#include "surface/packet.h"
#include "surface/raycast_field.h"

namespace meniscus {

/// Sets field.mass and field.entry_radius by the rule of raycast_field.h, from the density of unit masses at every
/// particle that is not in a hidden cell. All have to stand as make_field() sets them: what is neither thin nor packed
/// closely is left as it is.
void find_masses(RaycastField& field);

/// Particles near a block of cells by rows of cells along x, relative to the block's middle, in halves of a smoothing
/// length.
struct MassRows {
  AlignedFloats x, y, z;
  AlignedFloats fall;     ///< -(x^2 + y^2 + z^2) / 4
  std::size_t count = 0;  ///< sixteen more may be read

  /// @param middle  m, of the block
  /// @param sorted  first .. last of the grid's particles, which are added
  void add(const RaycastField& field, vec3 middle, BandGrid::Run sorted);
};

/// Particles of one row of cells that follow each other, and where in MassRows all stand that are nearer to them than a
/// smoothing length.
struct MassGroup {
  static constexpr std::size_t kRows = 9;
  std::uint32_t sorted;  ///< first in the grid
  std::uint32_t first;   ///< first in MassRows
  std::uint32_t count;   ///< 1 .. kPacket
  std::array<std::uint32_t, kRows> begin, end;
};

/// A particle whose mass or entry radius is not that of particles inside the water.
struct MassException {
  std::uint32_t sorted;
  float density;  ///< of unit masses, in relation to that inside the water
};

/// Appends the particles of the groups whose density is less than `thin`, exactly, or may be more than
/// kPackedDensity, then up to 0.003 more than it is.
void find_exceptions(const RaycastField& field, const MassRows& rows, std::span<const MassGroup> groups, float thin,
                     std::vector<MassException>& exceptions);

}  // namespace meniscus
