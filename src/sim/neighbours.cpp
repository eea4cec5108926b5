#include "sim/neighbours.h"

namespace meniscus {
namespace {

/// Cells are so much larger than h: the rounding of their borders must not hide a neighbour beyond the next cell.
constexpr float kCell_rel = 1.001f;
/// Particles that share their candidates: in a cell pressed full the lists must not take the memory of their product.
constexpr std::size_t kMostTogether = 16;

}  // namespace

void Neighbours::Lists::reserve(std::size_t wanted, std::size_t used) {
  if (wanted <= capacity) return;
  const std::size_t larger = wanted + wanted / 2;
  std::unique_ptr<std::int32_t[]> new_index(new std::int32_t[larger]);
  std::unique_ptr<float[]> new_r2(new float[larger]);
  std::copy_n(index.get(), used, new_index.get());
  std::copy_n(r2.get(), used, new_r2.get());
  index = std::move(new_index);
  r2 = std::move(new_r2);
  capacity = larger;
}

void Candidates::gather(const ParticleGrid& grid, const ParticleGrid::CellBox& cells, const Bounds& box, float h) {
  count = 0;
  for (int cz = cells.z0; cz <= cells.z1; ++cz)
    for (int cy = cells.y0; cy <= cells.y1; ++cy) {
      const ParticleGrid::Run run = grid.run(cells.x0, cells.x1, cy, cz);
      const std::size_t room = count + (run.end - run.begin) + 32;
      if (x.size() < room) {
        for (auto* values : {&x, &y, &z}) values->resize(2 * room);
        index.resize(2 * room);
      }
      gather_near(grid, run.begin, run.end, box, h * h, *this);
    }
}

struct NeighbourSearch {
  Neighbours& all;
  float h;

  void piece(std::size_t begin, std::size_t end) const {
    const ParticleGrid& grid = *all.grid_;
    Neighbours::Lists& lists = all.lists_[begin / Neighbours::kPiece];
    static thread_local Candidates candidates;
    std::size_t used = 0;
    lists.groups.clear();
    for (std::size_t group = begin; group < end;) {
      // Particles of one cell share their candidates: those near the box around them, half of what is in the cells.
      const vec3 p = grid.position(group);
      const ParticleGrid::CellBox own = grid.cells(p, p);
      const std::size_t cell_end = grid.run(own.x0, own.x0, own.y0, own.z0).end;
      const std::size_t group_end = std::max(group + 1, std::min({cell_end, end, group + kMostTogether}));
      Bounds box;
      for (std::size_t i = group; i < group_end; ++i) box.add(grid.position(i));
      lists.groups.push_back({group, group_end, box});
      candidates.gather(grid, around(own), box, h);
      lists.reserve(used + (group_end - group) * (candidates.count + 32) + 64, used);
      for (std::size_t i = group; i < group_end; ++i) {
        bool coincident = false;
        const std::size_t found =
            near_among(candidates, grid, i, h * h, lists.index.get() + used, lists.r2.get() + used, coincident);
        all.first_[i] = static_cast<std::uint32_t>(used);
        all.count_[i] = static_cast<std::uint32_t>(found);
        all.coincident_[i] = coincident;
        used += (found + 15) / 16 * 16;
      }
      group = group_end;
    }
  }

  /// The cell with its neighbours.
  ParticleGrid::CellBox around(const ParticleGrid::CellBox& cell) const {
    const ParticleGrid& grid = *all.grid_;
    return {std::max(cell.x0 - 1, 0),
            std::max(cell.y0 - 1, 0),
            std::max(cell.z0 - 1, 0),
            std::min(cell.x0 + 1, grid.cells_x() - 1),
            std::min(cell.y0 + 1, grid.cells_y() - 1),
            std::min(cell.z0 + 1, grid.cells_z() - 1)};
  }
};

void Neighbours::find(const std::vector<float>& x, const std::vector<float>& y, const std::vector<float>& z, float h) {
  positions_.x = x;
  positions_.y = y;
  positions_.z = z;
  grid_.emplace(positions_, kCell_rel * h);
  first_.resize(x.size());
  count_.resize(x.size());
  coincident_.resize(x.size());
  if (lists_.size() < pieces()) lists_.resize(pieces());
  const NeighbourSearch search{*this, h};
  parallel_for(size(), kPiece, [&](std::size_t begin, std::size_t end) { search.piece(begin, end); });
}

float Neighbours::mean() const {
  if (count_.empty()) return 0.0f;
  std::size_t sum = 0;
  for (const std::uint32_t count : count_) sum += count;
  return static_cast<float>(static_cast<double>(sum) / static_cast<double>(count_.size()));
}

}  // namespace meniscus
