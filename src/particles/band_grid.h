/// Particles near the surface sorted by cell; of those in the midst of the water only how many each cell holds.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>

#include <glm/common.hpp>

#include "meniscus/base.h"
#include "particles/band_memory.h"

namespace meniscus {

/// A sparse grid of blocks of 8 x 8 x 8 cubic cells. Blocks exist where there are particles, so that a cloud of spray a
/// thousand times as wide as the tank takes no more memory than its particles justify: they are found by a dense table
/// while that is small, else by hashing, and blocks that hold a single particle share their tables of cells.
///
/// A cell is well filled when it holds at least `well_filled` particles, in two patches of it (band_cells.h) if that
/// many; hidden when it and the 26 around it are; deep when all cells within `kept_layers` + 1 of it are. Particles of
/// deep cells are counted and left out: nothing that is asked near a surface lies within reach of them.
///
/// Sorted order: by block (z slowest, then y, then x), within a block by cell (the same), within a cell as given, so
/// that cells adjacent in x within one block are one contiguous run. It does not depend on the number of threads.
class BandGrid {
 public:
  /// Particles that may be read (not used) past the end of the sorted arrays: those are far away.
  static constexpr std::size_t kPadding = 16;
  static constexpr int kSide = 8;                       ///< cells along a block
  static constexpr int kCells = kSide * kSide * kSide;  ///< in a block
  enum Kind : std::uint8_t { open = 0, hidden = 1, deep = 2 };

  struct Options {
    float cell_size = 0;            ///< m, > 0
    std::uint32_t well_filled = 0;  ///< particles; 0: no cell is, all particles are kept
    int kept_layers = 2;            ///< of hidden cells whose particles are kept
    bool keep_index = true;         ///< whether given_index() will be asked for
  };

  /// Particles that a well filled cell holds where `inside` are in one inside the water.
  static std::uint32_t well_filled(float inside) {
    constexpr float kShare = 0.4f;
    return static_cast<std::uint32_t>(std::max(kShare * inside, 1.0f));
  }

  BandGrid() = default;
  /// @throws Error  invalid_argument: cell_size <= 0; limit_exceeded: cells beyond 2^21 blocks along an axis, 2^32
  ///                particles
  BandGrid(const Particles& particles, const Options& options);

  std::size_t size() const { return kept_; }        ///< particles kept
  std::size_t counted() const { return counted_; }  ///< all particles
  float cell_size() const { return cell_size_; }
  const Bounds& bounds() const { return bounds_; }  ///< of all particles
  /// Where cells are counted from, m, for particles in these bounds: a quarter of a cell below them. The planes of a
  /// lattice, half a cell apart, then lie amidst the cells, and rounding does not choose which cells they fill.
  static vec3 origin_of(const Bounds& bounds, float cell_size) { return bounds.low - 0.25f * cell_size; }
  const vec3& origin() const { return origin_; }

  /// Positions of the kept particles in sorted order, m; size() + kPadding values.
  const float* x() const { return x_.get(); }
  const float* y() const { return y_.get(); }
  const float* z() const { return z_.get(); }
  vec3 position(std::size_t sorted) const { return {x()[sorted], y()[sorted], z()[sorted]}; }
  /// Index in the given order of the particle at a place of the sorted order; not without Options::keep_index.
  std::uint32_t given_index(std::size_t sorted) const { return index_.get()[sorted]; }

  struct Run {
    std::size_t begin, end;
  };
  /// Blocks that hold particles, in sorted order.
  int blocks() const { return static_cast<int>(corner_.size()); }
  /// Cell coordinates of the block's first cell: multiples of kSide; cell c of an axis covers
  /// origin() + [c, c + 1) cell_size.
  glm::ivec3 corner(int block) const { return corner_[static_cast<std::size_t>(block)]; }
  vec3 low(int block) const { return origin_ + cell_size_ * vec3(corner(block)); }
  /// By cell of a block, (z * 8 + y) * 8 + x: kind, number of all particles, and the kept ones.
  const Kind* kinds(int block) const {
    return &kind_[std::size_t{kind_page_[static_cast<std::size_t>(block)]} * kCells];
  }
  const std::uint32_t* counts(int block) const {
    return &count_[std::size_t{page_[static_cast<std::size_t>(block)]} * kCells];
  }
  /// Which cells of a block are amidst hidden (or deep) ones, that is, do not touch an open one: eight words by z, bit
  /// 8 y + x.
  const std::uint64_t* amidst(int block) const {
    return &amidst_[std::size_t{kind_page_[static_cast<std::size_t>(block)]} * kSide];
  }
  /// Whether all of a block's cells are open (and all its particles kept) and touch no hidden one: the common case in
  /// spray.
  bool all_open(int block) const { return kind_page_[static_cast<std::size_t>(block)] == 0; }
  Run run(int block, int cell) const { return run(block, cell, cell); }
  /// Kept particles of the cells first .. last (both included) of a block.
  Run run(int block, int first, int last) const {
    const auto at = static_cast<std::size_t>(block);
    const std::uint32_t* start = &start_[std::size_t{start_page_[at]} * (kCells + 1)];
    return {std::size_t{first_[at]} + start[first], std::size_t{first_[at]} + start[last + 1]};
  }
  Run run(int block) const { return run(block, 0, kCells - 1); }  ///< all of a block's

  /// The block at these block coordinates (cell coordinates / 8), or -1.
  int find(int bx, int by, int bz) const {
    if (bx < 0 || by < 0 || bz < 0 || bx >= blocks_x_ || by >= blocks_y_ || bz >= blocks_z_) return -1;
    if (table_.empty()) return find_hashed(bx, by, bz);
    return table_[(static_cast<std::size_t>(bz) * static_cast<std::size_t>(blocks_y_) + static_cast<std::size_t>(by)) *
                      static_cast<std::size_t>(blocks_x_) +
                  static_cast<std::size_t>(bx)];
  }
  int blocks_x() const { return blocks_x_; }  ///< that the bounds take; zero when there are no particles
  int blocks_y() const { return blocks_y_; }
  int blocks_z() const { return blocks_z_; }

  /// Kind of the cell that holds a point; open beyond the blocks.
  Kind kind_at(vec3 point) const;

  bool has_hidden() const { return kind_.size() > kCells; }  ///< whether any cell is hidden or deep
  /// Whether any cell is deep.
  bool has_deep() const { return deep_; }
  /// Whether the cell that holds a point is deep or touches one that is: too few of the particles around such a point
  /// are kept to sum over, and it is full of water, as are all cells within `kept_layers` of it.
  bool full_at(vec3 point) const;
  /// Whether full_at() may hold for a point of the box.
  bool touches_full(vec3 low, vec3 high) const;

  /// Calls visit(begin, end) for the runs of kept particles whose cells touch the box, in sorted order within a block.
  template <class Visit>
  void for_each_run(vec3 low, vec3 high, Visit visit) const;

  std::uint64_t memory_bytes() const;

 private:
  class Build;
  int find_hashed(int bx, int by, int bz) const;
  /// The cell that holds a point: block (or -1) and cell of it.
  std::pair<int, int> place_of(vec3 point) const;

  std::size_t kept_ = 0, counted_ = 0;
  float cell_size_ = 0, per_cell_ = 0;
  int blocks_x_ = 0, blocks_y_ = 0, blocks_z_ = 0;
  bool deep_ = false;
  Bounds bounds_;
  vec3 origin_{0.0f};
  std::shared_ptr<float[]> x_, y_, z_;      ///< not changed after they have been made: copies share them
  std::shared_ptr<std::uint32_t[]> index_;  ///< none without keep_index
  std::vector<glm::ivec3> corner_;
  std::vector<std::int32_t> table_;        ///< block by block coordinates, or empty: hashed
  std::vector<std::int32_t> hashed_;       ///< block or -1, by hash
  std::vector<std::uint32_t> first_;       ///< kept particle by block, and one more at the end
  std::vector<std::uint32_t> page_;        ///< of count_, by block; shared by those of a single particle
  std::vector<std::uint32_t> start_page_;  ///< of start_, by block; shared, too, by those whose particles are left out
  std::vector<std::uint32_t> kind_page_;   ///< of kind_, amidst_ and full_, by block; 0: all are open; 1: all are deep
  PagedVector<std::uint32_t> start_;       ///< by page and cell, one more a page: from the block's first particle on
  PagedVector<std::uint32_t> count_;       ///< by page and cell
  PagedVector<Kind> kind_;                 ///< by page and cell
  std::vector<std::uint64_t> amidst_;      ///< by page, z; bit 8 y + x
  std::vector<std::uint64_t> full_;        ///< by page, z; bit 8 y + x
};

template <class Visit>
void BandGrid::for_each_run(vec3 low, vec3 high, Visit visit) const {
  if (corner_.empty()) return;
  const auto cell = [&](float value, float origin, int blocks, bool first) {
    const float at = std::floor((value - origin) * per_cell_), last = static_cast<float>(blocks * kSide - 1);
    if (first) return at > last ? blocks * kSide : static_cast<int>(std::max(at, 0.0f));
    return at < 0.0f ? -1 : static_cast<int>(std::min(at, last));
  };
  const vec3 o = origin_;
  const int x0 = cell(low.x, o.x, blocks_x_, true), x1 = cell(high.x, o.x, blocks_x_, false);
  const int y0 = cell(low.y, o.y, blocks_y_, true), y1 = cell(high.y, o.y, blocks_y_, false);
  const int z0 = cell(low.z, o.z, blocks_z_, true), z1 = cell(high.z, o.z, blocks_z_, false);
  if (x0 > x1 || y0 > y1 || z0 > z1) return;
  const auto visit_block = [&](int block, int bx, int by, int bz) {
    const int first_x = std::max(x0 - bx * kSide, 0), last_x = std::min(x1 - bx * kSide, kSide - 1);
    const int last_y = std::min(y1 - by * kSide, kSide - 1), last_z = std::min(z1 - bz * kSide, kSide - 1);
    for (int z = std::max(z0 - bz * kSide, 0); z <= last_z; ++z)
      for (int y = std::max(y0 - by * kSide, 0); y <= last_y; ++y) {
        const int row = (z * kSide + y) * kSide;
        const Run found = run(block, row + first_x, row + last_x);
        if (found.begin < found.end) visit(found.begin, found.end);
      }
  };
  const int bx0 = x0 / kSide, bx1 = x1 / kSide, by0 = y0 / kSide, by1 = y1 / kSide, bz0 = z0 / kSide, bz1 = z1 / kSide;
  if (table_.empty() && (bx1 - bx0 + 1.0) * (by1 - by0 + 1.0) * (bz1 - bz0 + 1.0) > static_cast<double>(blocks())) {
    for (int block = 0; block < blocks(); ++block) {  // fewer than there are places in the box
      const glm::ivec3 at = corner(block) / kSide;
      if (at.x >= bx0 && at.x <= bx1 && at.y >= by0 && at.y <= by1 && at.z >= bz0 && at.z <= bz1)
        visit_block(block, at.x, at.y, at.z);
    }
    return;
  }
  for (int bz = bz0; bz <= bz1; ++bz)
    for (int by = by0; by <= by1; ++by)
      for (int bx = bx0; bx <= bx1; ++bx) {
        const int block = find(bx, by, bz);
        if (block >= 0) visit_block(block, bx, by, bz);
      }
}

}  // namespace meniscus
