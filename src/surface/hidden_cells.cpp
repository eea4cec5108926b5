#include "surface/hidden_cells.h"

namespace meniscus {

void SphereSet::add(vec3 centre, float r) {
  x.push_back(centre.x);
  y.push_back(centre.y);
  z.push_back(centre.z);
  radius.push_back(r);
}

void SphereSet::add(const SphereSet& others) {
  for (auto member : {&SphereSet::x, &SphereSet::y, &SphereSet::z, &SphereSet::radius})
    (this->*member).insert((this->*member).end(), (others.*member).begin(), (others.*member).end());
}

SphereSet entry_spheres(const RaycastField& field) {
  const BandGrid& grid = field.grid;
  SphereSet spheres;
  if (grid.size() == 0) return spheres;
  if (!grid.has_hidden()) {
    spheres.x.assign(grid.x(), grid.x() + grid.size());
    spheres.y.assign(grid.y(), grid.y() + grid.size());
    spheres.z.assign(grid.z(), grid.z() + grid.size());
    spheres.radius = field.entry_radius;
    return spheres;
  }
  // A hidden cell's sphere holds the cell alone: the spheres of particles that are left out reach no farther than
  // into the hidden cells around theirs, because no radius is larger than a cell.
  constexpr std::size_t kBlocks = 64;
  const float cell_size = grid.cell_size();
  const float around_cell = 0.5f * std::sqrt(3.0f) * cell_size;
  const auto blocks = static_cast<std::size_t>(grid.blocks());
  std::vector<SphereSet> pieces((blocks + kBlocks - 1) / kBlocks);
  parallel_for(blocks, kBlocks, [&](std::size_t begin, std::size_t end) {
    SphereSet& mine = pieces[begin / kBlocks];
    for (int block = static_cast<int>(begin); block < static_cast<int>(end); ++block) {
      const BandGrid::Kind* kinds = grid.kinds(block);
      const std::uint64_t* amidst = grid.amidst(block);
      for (int cell = 0; cell < BandGrid::kCells; ++cell) {
        if ((amidst[cell / 64] >> cell % 64 & 1) != 0) continue;
        const BandGrid::Run run = grid.run(block, cell);
        for (std::size_t i = run.begin; i < run.end; ++i) mine.add(grid.position(i), field.entry_radius[i]);
        if (kinds[cell] != BandGrid::open)
          mine.add(grid.low(block) + cell_size * (vec3(cell % 8, cell / 8 % 8, cell / 64) + 0.5f), around_cell);
      }
    }
  });
  std::size_t total = 0;
  for (const SphereSet& piece : pieces) total += piece.size();
  for (auto member : {&SphereSet::x, &SphereSet::y, &SphereSet::z, &SphereSet::radius}) {
    (spheres.*member).reserve(total);
  }
  for (const SphereSet& piece : pieces) spheres.add(piece);
  return spheres;
}

}  // namespace meniscus
