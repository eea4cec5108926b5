/// Particles sorted by cell, for neighbour searches by runs of cells.
#pragma once

#include <algorithm>
#include <cmath>

#include "meniscus/base.h"

namespace meniscus {

/// Particles sorted by cubic cell, x fastest, then y, then z, then in their given order: cells adjacent in x
/// are one contiguous run, so a box of cells is read in few runs.
///
/// The cells are addressed by a dense table while that takes no more than some tens of bytes a particle, else
/// by binary search over the cells that hold particles (a cloud of spray much wider than its particles).
class ParticleGrid {
 public:
  /// Particles that may be read (not used) past the end of the sorted arrays: those are far away.
  static constexpr std::size_t kPadding = 16;

  /// Sorts the particles.
  /// @param cell_size  edge of a cell, m, > 0
  /// @throws Error     invalid_argument: cell_size <= 0; limit_exceeded: more than 2^20 cells along an axis
  ParticleGrid(const Particles& particles, float cell_size);

  std::size_t size() const { return count_; }
  float cell_size() const { return cell_size_; }
  const Bounds& bounds() const { return bounds_; }

  /// Sorted positions, m; size() + kPadding values.
  const float* x() const { return x_.data(); }
  const float* y() const { return y_.data(); }
  const float* z() const { return z_.data(); }
  vec3 position(std::size_t sorted) const { return {x_[sorted], y_[sorted], z_[sorted]}; }
  /// Index in the given order of the particle at a place of the sorted order.
  std::uint32_t given_index(std::size_t sorted) const { return index_[sorted]; }

  struct Run {
    std::size_t begin, end;
  };
  /// Cells along each axis; zero when there are no particles.
  int cells_x() const { return nx_; }
  int cells_y() const { return ny_; }
  int cells_z() const { return nz_; }
  bool dense() const { return sparse_keys_.empty(); }
  /// Whether a table over all cells may be made by others, too.
  std::size_t cell_count() const {
    return static_cast<std::size_t>(nx_) * static_cast<std::size_t>(ny_) * static_cast<std::size_t>(nz_);
  }
  std::size_t cell_index(int cx, int cy, int cz) const {
    return (static_cast<std::size_t>(cz) * static_cast<std::size_t>(ny_) + static_cast<std::size_t>(cy)) *
               static_cast<std::size_t>(nx_) +
           static_cast<std::size_t>(cx);
  }
  /// Particles of the cells x0 .. x1 (both included) of row (y, z); all within the grid, x0 <= x1.
  Run run(int x0, int x1, int cy, int cz) const {
    if (dense()) return {start_[cell_index(x0, cy, cz)], start_[cell_index(x1, cy, cz) + 1]};
    return sparse_run(cell_index(x0, cy, cz), cell_index(x1, cy, cz));
  }

  /// Cells from .. to (both included) along each axis that a box touches; empty() when it misses the grid.
  struct CellBox {
    int x0, y0, z0, x1, y1, z1;
    bool empty() const { return x0 > x1 || y0 > y1 || z0 > z1; }
  };
  CellBox cells(vec3 low, vec3 high) const {
    const auto first = [&](float value, float origin) { return std::floor((value - origin) * per_cell_); };
    const auto at_least = [](float cell) { return static_cast<int>(std::max(cell, 0.0f)); };
    const auto at_most = [](float cell, int n) {
      return cell < 0.0f ? -1 : static_cast<int>(std::min(cell, static_cast<float>(n - 1)));
    };
    return {at_least(std::min(first(low.x, bounds_.low.x), 2e9f)),
            at_least(std::min(first(low.y, bounds_.low.y), 2e9f)),
            at_least(std::min(first(low.z, bounds_.low.z), 2e9f)),
            at_most(first(high.x, bounds_.low.x), nx_),
            at_most(first(high.y, bounds_.low.y), ny_),
            at_most(first(high.z, bounds_.low.z), nz_)};
  }

  /// Calls visit(begin, end) for the runs of sorted particles whose cells touch the box.
  template <class Visit>
  void for_each_run(vec3 low, vec3 high, Visit visit) const {
    if (count_ == 0) return;
    const CellBox box = cells(low, high);
    if (box.x0 > box.x1) return;
    for (int cz = box.z0; cz <= box.z1; ++cz)
      for (int cy = box.y0; cy <= box.y1; ++cy) {
        const Run found = run(box.x0, box.x1, cy, cz);
        if (found.begin < found.end) visit(found.begin, found.end);
      }
  }

 private:
  Run sparse_run(std::size_t first_key, std::size_t last_key) const;
  void sort_dense(const Particles& particles);
  void sort_sparse(const Particles& particles);
  std::size_t key_of(const Particles& particles, std::size_t i) const;
  void gather(const Particles& particles);

  std::size_t count_ = 0;
  float cell_size_ = 0;
  float per_cell_ = 0;  ///< 1 / cell_size_
  int nx_ = 0, ny_ = 0, nz_ = 0;
  Bounds bounds_;
  std::vector<float> x_, y_, z_;
  std::vector<std::uint32_t> index_;
  std::vector<std::uint32_t> start_;         ///< dense: first particle of each cell, and one more
  std::vector<std::uint64_t> sparse_keys_;   ///< sparse: cells that hold particles, ascending
  std::vector<std::uint32_t> sparse_start_;  ///< first particle of each, and one more
};

}  // namespace meniscus
