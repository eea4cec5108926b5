#include "sim/neighbours.h"

namespace meniscus {

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

void Candidates::gather(const ParticleGrid& grid, const ParticleGrid::CellBox& box) {
  count = 0;
  for (int cz = box.z0; cz <= box.z1; ++cz)
    for (int cy = box.y0; cy <= box.y1; ++cy) {
      const ParticleGrid::Run run = grid.run(box.x0, box.x1, cy, cz);
      const std::size_t more = run.end - run.begin;
      if (x.size() < count + more + 16) {
        const std::size_t larger = 2 * (count + more + 16);
        for (auto* values : {&x, &y, &z}) values->resize(larger);
        index.resize(larger);
      }
      std::copy(grid.x() + run.begin, grid.x() + run.end, x.data() + count);
      std::copy(grid.y() + run.begin, grid.y() + run.end, y.data() + count);
      std::copy(grid.z() + run.begin, grid.z() + run.end, z.data() + count);
      for (std::size_t k = 0; k < more; ++k) index[count + k] = static_cast<std::int32_t>(run.begin + k);
      count += more;
    }
  for (std::size_t k = 0; k < 16; ++k) x[count + k] = y[count + k] = z[count + k] = 1e18f;
}

struct NeighbourSearch {
  Neighbours& all;
  float h;

  void piece(std::size_t begin, std::size_t end) const {
    const ParticleGrid& grid = *all.grid_;
    Neighbours::Lists& lists = all.lists_[begin / Neighbours::kPiece];
    Candidates candidates;
    ParticleGrid::CellBox last{1, 1, 1, 0, 0, 0};
    std::size_t used = 0;
    for (std::size_t i = begin; i < end; ++i) {
      // A little more than h: the rounding of cell borders must not hide a neighbour from one of two.
      const vec3 p = grid.position(i);
      const ParticleGrid::CellBox box = grid.cells(p - 1.0001f * h, p + 1.0001f * h);
      if (box.x0 != last.x0 || box.x1 != last.x1 || box.y0 != last.y0 || box.y1 != last.y1 || box.z0 != last.z0 ||
          box.z1 != last.z1) {
        candidates.gather(grid, box);
        last = box;
      }
      lists.reserve(used + candidates.count + 64, used);
      float least;
      const std::size_t found =
          near_among(candidates, grid, i, h * h, lists.index.get() + used, lists.r2.get() + used, least);
      all.first_[i] = static_cast<std::uint32_t>(used);
      all.count_[i] = static_cast<std::uint32_t>(found);
      all.coincident_[i] = least < 1e-8f * h * h;
      used += (found + 15) / 16 * 16;
    }
  }
};

void Neighbours::find(const std::vector<float>& x, const std::vector<float>& y, const std::vector<float>& z, float h) {
  positions_.x = x;
  positions_.y = y;
  positions_.z = z;
  grid_.emplace(positions_, h);
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
