#include "surface/masses.h"

#include "surface/packet.h"

namespace meniscus {

void find_masses(RaycastField& field) {
  constexpr std::size_t kGrain = 4096;
  const MassRule rule = mass_rule(field.options);
  const ParticleGrid& grid = field.grid;
  const float per_cell = 1.0f / grid.cell_size();
  const auto cell_of = [&](std::size_t i) {
    const vec3 at = (grid.position(i) - grid.bounds().low) * per_cell;
    return grid.cell_index(std::min(static_cast<int>(at.x), grid.cells_x() - 1),
                           std::min(static_cast<int>(at.y), grid.cells_y() - 1),
                           std::min(static_cast<int>(at.z), grid.cells_z() - 1));
  };
  parallel_for(grid.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    PacketList list;
    PacketPoints points;
    alignas(64) float density[kPacket];
    for (std::size_t i = begin; i < end;) {
      const std::size_t cell = cell_of(i);
      if (field.is_hidden(cell)) {
        ++i;
        continue;
      }
      // A packet is up to sixteen particles of this cell and the next one in its row.
      std::size_t last = i + 1;
      while (last < end && last - i < kPacket) {
        const std::size_t other = cell_of(last);
        if (other > cell + 1 || (other != cell && field.is_hidden(other))) break;
        ++last;
      }
      for (std::size_t l = 0; l < kPacket; ++l) {
        const std::size_t from = std::min(i + l, last - 1);
        points.x[l] = grid.x()[from];
        points.y[l] = grid.y()[from];
        points.z[l] = grid.z()[from];
      }
      const auto mask = static_cast<PacketMask>((1u << (last - i)) - 1u);
      density_packet(field, points, mask, true, list, density);
      for (std::size_t l = 0; i < last; ++i, ++l) {
        field.mass[i] = mass_at(rule, density[l]);
        field.entry_radius[i] = entry_radius_at(field.options, density[l]);
      }
    }
  });
}

}  // namespace meniscus
