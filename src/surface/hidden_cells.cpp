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

void forget_amidst(RaycastField& field) {
  constexpr std::size_t kBlocks = 64;
  const BandGrid& grid = field.grid;
  if (!grid.has_hidden()) return;
  parallel_for(static_cast<std::size_t>(grid.blocks()), kBlocks, [&](std::size_t begin, std::size_t end) {
    for (int block = static_cast<int>(begin); block < static_cast<int>(end); ++block) {
      const std::uint64_t* amidst = grid.amidst(block);
      for (int z = 0; z < BandGrid::kSide; ++z)
        for (std::uint64_t word = amidst[z]; word != 0; word &= word - 1) {
          const BandGrid::Run run = grid.run(block, 64 * z + __builtin_ctzll(word));
          for (std::size_t i = run.begin; i < run.end; ++i) field.entry_radius[i] = 0.0f;
        }
    }
  });
}

SphereSet hidden_cell_spheres(const RaycastField& field) {
  const BandGrid& grid = field.grid;
  SphereSet spheres;
  if (!grid.has_hidden()) return spheres;
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
      if (grid.all_open(block)) continue;
      const BandGrid::Kind* kinds = grid.kinds(block);
      const std::uint64_t* amidst = grid.amidst(block);
      for (int z = 0; z < BandGrid::kSide; ++z)
        for (std::uint64_t word = ~amidst[z]; word != 0; word &= word - 1) {
          const int cell = 64 * z + __builtin_ctzll(word);
          if (kinds[cell] != BandGrid::open)
            mine.add(grid.low(block) + cell_size * (vec3(cell % 8, cell / 8 % 8, cell / 64) + 0.5f), around_cell);
        }
    }
  });
  for (const SphereSet& piece : pieces) spheres.add(piece);
  return spheres;
}

}  // namespace meniscus
