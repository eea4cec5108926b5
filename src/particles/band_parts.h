/// How many particles each cell holds, counted by parts of the input.
#pragma once

#include <algorithm>
#include <bit>

#include "particles/band_cells.h"
#include "particles/band_memory.h"

namespace meniscus {

/// Counters by cell of the particles begin .. end of the given order. Blocks get counters when their first particle
/// comes: a page of 512, found by a dense table of blocks; or, where blocks are found by hashing, room for a few cells
/// first, and a page when that is full, so that lone particles take little.
///
/// The counters serve twice: for the numbers of particles and the patches that they lie in, and when all have been
/// counted, for where the particles of this part go.
class BandPart {
 public:
  using Counter = std::uint32_t;
  static constexpr std::size_t kMost = kBandCount / kBandPiece * kBandPiece;  ///< particles that one may have
  static constexpr std::size_t kCells = 512;

  /// @param dense_blocks  places in the dense table; 0: by hashing
  BandPart(const BandCells& cells, std::size_t dense_blocks, std::size_t begin, std::size_t end)
      : cells_(cells), begin_(begin), end_(end), dense_(dense_blocks > 0), table_(dense_blocks, nullptr) {}

  std::size_t begin() const { return begin_; }
  std::size_t end() const { return end_; }

  void count(const Particles& particles);

  /// Appends the keys of the blocks that have counters: place in the dense table, or hash key; in no order.
  void add_blocks(std::vector<std::uint64_t>& keys) const;
  bool holds(std::size_t dense_block) const { return table_[dense_block] != nullptr; }

  /// Calls visit(cell, counter) for the cells of a block that may hold particles.
  template <class Visit>
  void for_each(std::uint64_t block, Visit visit) {
    Counter* page = nullptr;
    if (dense_) {
      page = table_[block];
    } else {
      const std::int32_t found = find(block);
      if (found < 0) return;
      Entry& entry = entries_[static_cast<std::size_t>(found)];
      page = entry.page;
      if (!page)
        for (std::size_t i = 0; i < entry.cells; ++i) visit(entry.cell[i], entry.counter[i]);
    }
    if (page)
      for (std::size_t cell = 0; cell < kCells; ++cell) visit(cell, page[cell]);
  }

  /// Calls visit(i, counter) for the particles from .. to of this part, at most 256.
  template <class Visit>
  void for_each_particle(const Particles& particles, std::size_t from, std::size_t to, Visit visit) {
    if (dense_) {
      std::uint32_t keys[kBandPiece];
      find_dense_keys(cells_, &particles.x[from], &particles.y[from], &particles.z[from], to - from, keys);
      for (std::size_t i = from; i < to; ++i) visit(i, table_[keys[i - from] >> 9][keys[i - from] & 511u]);
    } else {
      for_each_hashed(particles, from, to, [&](std::size_t i, Entry& entry, std::uint32_t cell, std::uint32_t) {
        visit(i, counter_of(entry, cell));
      });
    }
  }

  /// The same for those that do not lie in cells that are left out, by a dense table only.
  /// @param left_out  bits by key, as find_kept_keys() takes them
  template <class Visit>
  void for_each_kept(const Particles& particles, std::size_t from, std::size_t to, const std::uint32_t* left_out,
                     Visit visit) {
    std::uint32_t keys[kBandPiece + kBandLanes], places[kBandPiece + kBandLanes];
    const std::size_t kept = find_kept_keys(cells_, &particles.x[from], &particles.y[from], &particles.z[from],
                                            to - from, left_out, keys, places);
    for (std::size_t k = 0; k < kept; ++k) visit(from + places[k], table_[keys[k] >> 9][keys[k] & 511u]);
  }

  /// Key of the block at block coordinates below 2^21, for parts with hashing: rises by z, then y, then x.
  static std::uint64_t key_of(std::uint64_t bx, std::uint64_t by, std::uint64_t bz) { return bz << 42 | by << 21 | bx; }
  static std::size_t hash_of(std::uint64_t key) {
    key *= 0x9e3779b97f4a7c15u;
    return static_cast<std::size_t>(key ^ key >> 32);
  }

 private:
  static constexpr std::size_t kFew = 6;
  static constexpr std::size_t kFewestAtOnce = 32, kMostAtOnce = 2048;  ///< pages
  struct Entry {
    std::uint64_t key = 0;
    Counter* page = nullptr;
    std::uint16_t cells = 0;
    std::uint16_t cell[kFew] = {};
    Counter counter[kFew] = {};
  };

  Counter* new_page() {
    if (pages_left_ == 0) {
      pages_left_ = std::clamp(pages_made_, kFewestAtOnce, kMostAtOnce);
      pages_made_ += pages_left_;
      pages_.emplace_back().resize(pages_left_ * kCells);
    }
    Counter* page = &pages_.back()[--pages_left_ * kCells];
    std::fill_n(page, kCells, Counter{0});
    return page;
  }
  std::int32_t find(std::uint64_t key) const;
  std::int32_t find_or_add(std::uint64_t key);
  Counter& counter_of(Entry& entry, std::uint32_t cell);
  template <class Visit>
  void for_each_hashed(const Particles& particles, std::size_t from, std::size_t to, Visit visit) {
    std::int32_t qx[kBandPiece], qy[kBandPiece], qz[kBandPiece];
    find_quarters(cells_.low.x, cells_.per_cell, &particles.x[from], to - from, qx);
    find_quarters(cells_.low.y, cells_.per_cell, &particles.y[from], to - from, qy);
    find_quarters(cells_.low.z, cells_.per_cell, &particles.z[from], to - from, qz);
    std::uint64_t last_key = ~std::uint64_t{0};
    std::size_t last = 0;
    for (std::size_t i = from; i < to; ++i) {
      const auto x = static_cast<std::uint32_t>(qx[i - from]), y = static_cast<std::uint32_t>(qy[i - from]),
                 z = static_cast<std::uint32_t>(qz[i - from]);
      const std::uint64_t key = key_of(x >> 5, y >> 5, z >> 5);
      if (key != last_key) {
        last = static_cast<std::size_t>(find_or_add(key));
        last_key = key;
      }
      visit(i, entries_[last], (z >> 2 & 7) << 6 | (y >> 2 & 7) << 3 | (x >> 2 & 7), band_patch(x, y, z));
    }
  }

  BandCells cells_;
  std::size_t begin_, end_;
  bool dense_;
  std::vector<Counter*> table_;              ///< by place in the dense table
  std::vector<PagedVector<Counter>> pages_;  ///< several at once
  std::size_t pages_made_ = 0, pages_left_ = 0;
  std::vector<std::int32_t> hashed_;  ///< entry or -1, by hash; a power of two, at most half full
  std::vector<Entry> entries_;
};

}  // namespace meniscus
