#include "surface/sized_masses.h"

#include "surface/packet.h"
#include "surface/particle_sizes.h"
#include "surface/sized_field.h"

namespace meniscus {
namespace {

/// Sets the masses and entry radii of one level's particles.
void find_level(const RaycastField& all, const RaycastField& level, PagedVector<float>& mass,
                PagedVector<float>& entry_radius) {
  constexpr std::size_t kBlocks = 4;
  const auto& grid = level.grid;
  const auto find_packet = [&](std::size_t first, std::size_t last, SizedMassRules& rules, PacketList& list) {
    PacketPoints points;
    alignas(64) float density[kPacket];
    for (std::size_t l = 0; l < kPacket; ++l) {
      const std::size_t from = std::min(first + l, last - 1);
      points.x[l] = grid.x()[from];
      points.y[l] = grid.y()[from];
      points.z[l] = grid.z()[from];
    }
    density_packet(all, points, static_cast<PacketMask>((1u << (last - first)) - 1u), false, list, density);
    for (std::size_t i = first; i < last; ++i) {
      const float s = level.options.spacing / level.per_spacing[i];
      const float h = level.options.smoothing_length / level.per_smoothing[i];
      mass[i] = mass_at(rules.rule(s, h), density[i - first]);
      entry_radius[i] = entry_radius_at(options_of_size(level.options, s, h), density[i - first]);
    }
  };
  parallel_for(static_cast<std::size_t>(grid.blocks()), kBlocks, [&](std::size_t begin, std::size_t end) {
    SizedMassRules rules(level.options);
    PacketList list;
    for (int block = static_cast<int>(begin); block < static_cast<int>(end); ++block)
      for (int cell = 0; cell < BandGrid::kCells; ++cell) {
        if (grid.kinds(block)[cell] != BandGrid::open) continue;
        const BandGrid::Run run = grid.run(block, cell);
        for (std::size_t i = run.begin; i < run.end; i += kPacket)
          find_packet(i, std::min(i + kPacket, run.end), rules, list);
      }
  });
}

}  // namespace

void find_sized_masses(RaycastField& field) {
  std::vector<PagedVector<float>> masses;
  for_each_level(field, [&](RaycastField& level) {
    masses.push_back(level.mass);
    find_level(field, level, masses.back(), level.entry_radius);
  });
  std::size_t k = 0;
  for_each_level(field, [&](RaycastField& level) { level.mass = std::move(masses[k++]); });
}

}  // namespace meniscus
