#include "surface/masses.h"

#include "surface/packet.h"

namespace meniscus {
namespace {

/// Masses and radii of the particles first .. last (not included), at most sixteen that are near each other.
void find_packet(RaycastField& field, const MassRule& rule, std::size_t first, std::size_t last, PacketList& list) {
  PacketPoints points;
  alignas(64) float density[kPacket];
  for (std::size_t l = 0; l < kPacket; ++l) {
    const std::size_t from = std::min(first + l, last - 1);
    points.x[l] = field.grid.x()[from];
    points.y[l] = field.grid.y()[from];
    points.z[l] = field.grid.z()[from];
  }
  density_packet(field, points, static_cast<PacketMask>((1u << (last - first)) - 1u), true, list, density);
  for (std::size_t i = first; i < last; ++i) {
    field.mass[i] = mass_at(rule, density[i - first]);
    field.entry_radius[i] = entry_radius_at(field.options, density[i - first]);
  }
}

}  // namespace

void find_masses(RaycastField& field) {
  constexpr std::size_t kBlocks = 4;
  const MassRule rule = mass_rule(field.options);
  const BandGrid& grid = field.grid;
  parallel_for(static_cast<std::size_t>(grid.blocks()), kBlocks, [&](std::size_t begin, std::size_t end) {
    PacketList list;
    for (int block = static_cast<int>(begin); block < static_cast<int>(end); ++block) {
      const BandGrid::Kind* kinds = grid.kinds(block);
      for (int cell = 0; cell < BandGrid::kCells; ++cell) {
        if (kinds[cell] != BandGrid::open) continue;
        // Packets are of this cell and the next one in its row.
        BandGrid::Run run = grid.run(block, cell);
        if (run.begin == run.end) continue;
        if (cell % BandGrid::kSide + 1 < BandGrid::kSide && kinds[cell + 1] == BandGrid::open)
          run.end = grid.run(block, ++cell).end;
        for (std::size_t i = run.begin; i < run.end; i += kPacket)
          find_packet(field, rule, i, std::min(i + kPacket, run.end), list);
      }
    }
  });
}

}  // namespace meniscus
