#include "particles/band_grid.h"

#include <fmt/format.h>

#include "particles/band_kinds.h"
#include "particles/band_parts.h"

namespace meniscus {
namespace {

constexpr float kFarAway = 1e18f;  ///< its square is finite, its distance to any particle beyond any support
constexpr float kMostBlocksAlongAxis = 1 << 21;
constexpr std::size_t kMostDenseBlocks = std::size_t{1} << 22;
constexpr std::size_t kLeastPart = 1 << 16;  ///< particles
constexpr std::size_t kBlocks = 64;          ///< in one piece of work
/// Of a cell, that the particles of a well filled one lie in. Of water without order one cell in 150 has all of its
/// particles in two patches, and each that is left open keeps those of 343 cells.
constexpr std::uint32_t kFewestPatches = 2;

Bounds bounds_of(const Particles& particles, std::vector<Bounds>& boxes) {
  constexpr std::size_t kPieces = 1024;
  const std::size_t count = particles.size();
  boxes = std::vector<Bounds>((count + kBandBox - 1) / kBandBox);
  std::vector<Bounds> partial((boxes.size() + kPieces - 1) / kPieces);
  parallel_for(boxes.size(), kPieces, [&](std::size_t begin, std::size_t end) {
    const std::size_t from = begin * kBandBox;
    find_piece_boxes(&particles.x[from], &particles.y[from], &particles.z[from], std::min(end * kBandBox, count) - from,
                     &boxes[begin]);
    for (std::size_t i = begin; i < end; ++i) partial[begin / kPieces].add(boxes[i]);
  });
  Bounds all;
  for (const Bounds& box : partial) all.add(box);
  return all;
}

}  // namespace

/// The making of a grid.
class BandGrid::Build {
 public:
  Build(BandGrid& grid, const Particles& particles, const Options& options)
      : grid_(grid), particles_(particles), options_(options) {}

  void run() {
    set_size();
    count();
    find_blocks();
    set_counts();
    find_kinds();
    set_starts();
    scatter();
  }

 private:
  void set_size() {
    BandGrid& g = grid_;
    g.bounds_ = bounds_of(particles_, boxes_);
    g.origin_ = BandGrid::origin_of(g.bounds_, g.cell_size_);
    const vec3 extent = g.bounds_.high - g.origin_;
    const float longest = std::max({extent.x, extent.y, extent.z});
    if (!(longest * g.per_cell_ < kMostBlocksAlongAxis * kSide))
      throw Error(ErrorCode::limit_exceeded,
                  ErrorDetail{fmt::format("the particles spread over {:.3g} m, too wide for cells of {:.3g} m", longest,
                                          g.cell_size_),
                              {},
                              {},
                              {},
                              {},
                              {},
                              "set a larger particle spacing, or leave out the particles that have flown away"});
    const auto along = [&](float size) { return static_cast<int>(size * g.per_cell_) / kSide + 1; };
    g.blocks_x_ = along(extent.x);
    g.blocks_y_ = along(extent.y);
    g.blocks_z_ = along(extent.z);
    const double all = static_cast<double>(g.blocks_x_) * g.blocks_y_ * g.blocks_z_;
    const auto most = static_cast<double>(std::min(kMostDenseBlocks - 1, 4096 + particles_.size() / 256));
    dense_blocks_ = all <= most ? static_cast<std::size_t>(all) : 0;
  }

  void count() {
    const std::size_t all = particles_.size();
    std::size_t parts = std::clamp<std::size_t>(
        std::min<std::size_t>(2 * static_cast<std::size_t>(thread_count()), all / kLeastPart), 1, 8);
    // An even number where there have to be more, so that two threads have as much to do.
    if (all / parts >= BandPart::kMost) parts = 2 * (all / (2 * BandPart::kMost) + 1);
    const std::size_t per_part = ((all + parts - 1) / parts + kBandPiece - 1) / kBandPiece * kBandPiece;
    const BandCells cells{grid_.origin_, grid_.per_cell_, grid_.blocks_x_, grid_.blocks_y_};
    for (std::size_t from = 0; from < all; from += per_part)
      parts_.emplace_back(cells, dense_blocks_, from, std::min(from + per_part, all));
    parallel_for(parts_.size(), 1, [&](std::size_t part, std::size_t) { parts_[part].count(particles_); });
  }

  void find_blocks() {
    BandGrid& g = grid_;
    if (dense_blocks_ > 0) {
      g.table_.assign(dense_blocks_, -1);
      for (std::size_t place = 0; place < dense_blocks_; ++place)
        if (std::any_of(parts_.begin(), parts_.end(), [&](const BandPart& part) { return part.holds(place); })) {
          g.table_[place] = static_cast<std::int32_t>(keys_.size());
          keys_.push_back(place);
        }
    } else {
      for (const BandPart& part : parts_) part.add_blocks(keys_);
      std::sort(keys_.begin(), keys_.end());
      keys_.erase(std::unique(keys_.begin(), keys_.end()), keys_.end());
      g.hashed_.assign(std::bit_ceil(2 * keys_.size()), -1);
      for (std::size_t block = 0; block < keys_.size(); ++block) {
        std::size_t at = BandPart::hash_of(keys_[block]) & (g.hashed_.size() - 1);
        while (g.hashed_[at] >= 0) at = (at + 1) & (g.hashed_.size() - 1);
        g.hashed_[at] = static_cast<std::int32_t>(block);
      }
    }
    g.corner_.resize(keys_.size());
    const auto across = static_cast<std::uint64_t>(g.blocks_x_), down = static_cast<std::uint64_t>(g.blocks_y_);
    for (std::size_t block = 0; block < keys_.size(); ++block) {
      const std::uint64_t key = keys_[block], mask = (1u << 21) - 1;
      const glm::ivec3 at = dense_blocks_ > 0 ? glm::ivec3(key % across, key / across % down, key / across / down)
                                              : glm::ivec3(key & mask, key >> 21 & mask, key >> 42);
      g.corner_[block] = kSide * at;
    }
  }

  /// Counts of all parts, added up.
  void set_counts() {
    BandGrid& g = grid_;
    const std::size_t blocks = keys_.size();
    // Blocks with one particle share the tables of those whose particle lies in the same cell.
    std::vector<std::int32_t> lone(blocks, -1);
    if (dense_blocks_ == 0)
      parallel_for(blocks, kBlocks, [&](std::size_t begin, std::size_t end) {
        for (std::size_t block = begin; block < end; ++block) {
          std::uint32_t total = 0;
          for (BandPart& part : parts_)
            part.for_each(keys_[block], [&](std::size_t cell, std::uint32_t counter) {
              total = std::min(total + (counter & kBandCount), 2u);
              if (counter > 0) lone[block] = static_cast<std::int32_t>(cell);
            });
          if (total > 1) lone[block] = -1;
        }
      });
    std::vector<std::int32_t> shared(kCells, -1);
    g.page_.resize(blocks);
    std::uint32_t pages = 0;
    for (std::size_t block = 0; block < blocks; ++block) {
      std::uint32_t page = pages;
      if (lone[block] >= 0) {
        std::int32_t& known = shared[static_cast<std::size_t>(lone[block])];
        if (known < 0) {
          known = static_cast<std::int32_t>(pages);
          own_.push_back(static_cast<std::uint32_t>(block));
          ++pages;
        }
        page = static_cast<std::uint32_t>(known);
      } else {
        own_.push_back(static_cast<std::uint32_t>(block));
        ++pages;
      }
      g.page_[block] = page;
    }
    g.count_.resize(std::size_t{pages} * kCells);
    if (options_.well_filled > 0) filled_.resize(pages);
    parallel_for(pages, kBlocks, [&](std::size_t begin, std::size_t end) {
      std::uint32_t patches[kCells];
      for (std::size_t page = begin; page < end; ++page) {
        std::uint32_t* count = &g.count_[page * kCells];
        std::fill_n(count, kCells, 0u);
        std::fill_n(patches, kCells, 0u);
        for (BandPart& part : parts_)
          part.for_each(keys_[own_[page]], [&](std::size_t cell, std::uint32_t counter) {
            count[cell] += counter & kBandCount;
            patches[cell] |= counter >> kBandCountBits;
          });
        if (options_.well_filled > 0)
          find_well_filled(count, options_.well_filled, patches, std::min(options_.well_filled, kFewestPatches),
                           filled_[page].data());
      }
    });
  }

  void find_kinds() {
    BandGrid& g = grid_;
    const std::size_t blocks = keys_.size();
    g.kind_page_.assign(blocks, 0);
    g.kind_.assign(kCells, open);
    g.full_.assign(kSide, 0);
    g.amidst_.assign(kSide, 0);
    if (options_.well_filled == 0) return;
    std::vector<BandBits> hidden(blocks);
    std::vector<BandSides> sides(blocks);
    parallel_for(blocks, kBlocks, [&](std::size_t begin, std::size_t end) {
      for (std::size_t block = begin; block < end; ++block) {
        hidden[block] = filled_[g.page_[block]];
        const glm::ivec3 at = g.corner_[block] / kSide;
        sides[block] = {g.find(at.x - 1, at.y, at.z), g.find(at.x + 1, at.y, at.z), g.find(at.x, at.y - 1, at.z),
                        g.find(at.x, at.y + 1, at.z), g.find(at.x, at.y, at.z - 1), g.find(at.x, at.y, at.z + 1)};
      }
    });
    erode(hidden, sides, 1, false);
    std::vector<BandBits> amidst = hidden;
    erode(amidst, sides, 1, false);
    deep_ = hidden;
    erode(deep_, sides, std::max(options_.kept_layers, 0), false);
    // What is deep or touches it: all that is not amidst what is not deep.
    std::vector<BandBits> full = deep_;
    for (BandBits& block : full)
      for (std::uint64_t& word : block) word = ~word;
    erode(full, sides, 1, true);
    BandBits none, all;
    none.fill(0);
    all.fill(~std::uint64_t{0});
    std::uint32_t pages = 2;
    for (std::size_t block = 0; block < blocks; ++block) {
      g.deep_ = g.deep_ || deep_[block] != none;
      if (hidden[block] == none && full[block] == all) continue;
      g.kind_page_[block] = deep_[block] == all && amidst[block] == all ? 1 : pages++;
    }
    if (pages == 2 && !g.deep_) {
      deep_ = {};
      return;
    }
    g.kind_.resize(std::size_t{pages} * kCells);
    g.full_.resize(std::size_t{pages} * kSide, ~std::uint64_t{0});
    g.amidst_.resize(std::size_t{pages} * kSide, ~std::uint64_t{0});
    std::fill_n(&g.kind_[kCells], kCells, deep);
    parallel_for(blocks, kBlocks, [&](std::size_t begin, std::size_t end) {
      for (std::size_t block = begin; block < end; ++block) {
        const std::size_t page = g.kind_page_[block];
        if (page < 2) continue;
        for (std::size_t z = 0; z < kSide; ++z) {
          for (std::size_t k = 0; k < 64; ++k)  // deep ones are hidden, too
            g.kind_[page * kCells + 64 * z + k] =
                static_cast<Kind>((hidden[block][z] >> k & 1) + (deep_[block][z] >> k & 1));
          g.full_[page * kSide + z] = ~full[block][z];
          g.amidst_[page * kSide + z] = amidst[block][z];
        }
      }
    });
    if (!g.deep_) deep_ = {};
  }

  bool is_deep(std::size_t block, std::size_t cell) const {
    return !deep_.empty() && (deep_[block][cell / 64] >> cell % 64 & 1) != 0;
  }

  /// Whether all of a block's particles are left out.
  bool all_deep(std::size_t block) const {
    return !deep_.empty() && std::all_of(deep_[block].begin(), deep_[block].end(),
                                         [](std::uint64_t word) { return word == ~std::uint64_t{0}; });
  }

  /// Where the kept particles of each cell go, and in each cell those of each part.
  void set_starts() {
    BandGrid& g = grid_;
    const std::size_t blocks = keys_.size();
    std::vector<std::uint32_t> start_page(own_.size());
    std::uint32_t pages = 1;
    for (std::size_t page = 0; page < own_.size(); ++page) start_page[page] = all_deep(own_[page]) ? 0 : pages++;
    g.start_page_.resize(blocks);
    for (std::size_t block = 0; block < blocks; ++block) g.start_page_[block] = start_page[g.page_[block]];
    g.start_.resize(std::size_t{pages} * (kCells + 1));
    std::fill_n(g.start_.begin(), kCells + 1, 0u);
    parallel_for(own_.size(), kBlocks, [&](std::size_t begin, std::size_t end) {
      for (std::size_t page = begin; page < end; ++page) {
        if (start_page[page] == 0) continue;
        std::uint32_t* start = &g.start_[std::size_t{start_page[page]} * (kCells + 1)];
        std::uint32_t sum = 0;
        for (std::size_t cell = 0; cell < kCells; ++cell) {
          start[cell] = sum;
          if (!is_deep(own_[page], cell)) sum += g.count_[page * kCells + cell];
        }
        start[kCells] = sum;
      }
    });
    g.first_.resize(blocks + 1);
    std::uint32_t sum = 0;
    for (std::size_t block = 0; block < blocks; ++block) {
      g.first_[block] = sum;
      sum += g.start_[std::size_t{g.start_page_[block]} * (kCells + 1) + kCells];
    }
    g.first_[blocks] = sum;
    g.kept_ = sum;
    parallel_for(blocks, kBlocks, [&](std::size_t begin, std::size_t end) {
      std::uint32_t next[kCells];
      for (std::size_t block = begin; block < end; ++block) {
        // Of a dense table the particles of deep cells are told by their keys.
        if (dense_blocks_ > 0 && g.start_page_[block] == 0) continue;
        const std::uint32_t* start = &g.start_[std::size_t{g.start_page_[block]} * (kCells + 1)];
        for (std::size_t cell = 0; cell < kCells; ++cell)
          next[cell] = is_deep(block, cell) ? kLeftOut : g.first_[block] + start[cell];
        for (BandPart& part : parts_)
          part.for_each(keys_[block], [&](std::size_t cell, std::uint32_t& counter) {
            const std::uint32_t in_part = counter & kBandCount;
            counter = next[cell];
            if (next[cell] != kLeftOut) next[cell] += in_part;
          });
      }
    });
  }

  /// Whether a box lies in deep cells only.
  bool all_deep(const Bounds& box) const {
    constexpr int kMostBlocks = 64;
    const auto cell = [&](vec3 at) { return glm::ivec3((at - grid_.origin_) * grid_.per_cell_); };
    const glm::ivec3 low = cell(box.low), high = cell(box.high), first = low / kSide, last = high / kSide;
    const glm::ivec3 n = last - first + 1;
    if (n.x > kMostBlocks || n.y > kMostBlocks || n.z > kMostBlocks || n.x * n.y * n.z > kMostBlocks) return false;
    for (int bz = first.z; bz <= last.z; ++bz)
      for (int by = first.y; by <= last.y; ++by)
        for (int bx = first.x; bx <= last.x; ++bx) {
          const int block = grid_.find(bx, by, bz);
          if (block < 0) return false;
          const glm::ivec3 corner = kSide * glm::ivec3(bx, by, bz);
          const glm::ivec3 from = glm::max(low - corner, 0), to = glm::min(high - corner, kSide - 1);
          const std::uint64_t row = (0xffu >> (7 - to.x)) & (0xffu << from.x);
          std::uint64_t mask = 0;
          for (int y = from.y; y <= to.y; ++y) mask |= row << (8 * y);
          for (int z = from.z; z <= to.z; ++z)
            if (~deep_[static_cast<std::size_t>(block)][static_cast<std::size_t>(z)] & mask) return false;
        }
    return true;
  }

  void scatter() {
    BandGrid& g = grid_;
    const std::size_t padded = g.kept_ + kPadding;
    // No values yet: the threads that write them meet the memory first.
    for (auto axis : {&BandGrid::x_, &BandGrid::y_, &BandGrid::z_}) {
      g.*axis = paged_array<float>(padded);
      std::fill_n((g.*axis).get() + g.kept_, kPadding, kFarAway);
    }
    if (options_.keep_index) g.index_ = paged_array<std::uint32_t>(padded);
    float *x = g.x_.get(), *y = g.y_.get(), *z = g.z_.get();
    std::uint32_t* index = g.index_.get();
    const std::vector<std::uint32_t> left_out = deep_bits();
    parallel_for(parts_.size(), 1, [&](std::size_t p, std::size_t) {
      BandPart& part = parts_[p];
      const auto keep = [&](std::size_t i, std::uint32_t& next) {
        if (next == kLeftOut) return;
        const std::uint32_t to = next++;
        x[to] = particles_.x[i];
        y[to] = particles_.y[i];
        z[to] = particles_.z[i];
        if (index) index[to] = static_cast<std::uint32_t>(i);
      };
      for (std::size_t from = part.begin(); from < part.end(); from += kBandPiece) {
        const std::size_t end = std::min(from + kBandPiece, part.end());
        if (!deep_.empty() && all_deep(box_of(from, end))) continue;
        if (left_out.empty())
          part.for_each_particle(particles_, from, end, keep);
        else
          part.for_each_kept(particles_, from, end, left_out.data(), keep);
      }
    });
  }

  /// Of the particles from .. end - 1, of whole boxes.
  Bounds box_of(std::size_t from, std::size_t end) const {
    Bounds box = boxes_[from / kBandBox];
    for (std::size_t k = from / kBandBox + 1; k * kBandBox < end; ++k) {
      box.low = glm::min(box.low, boxes_[k].low);
      box.high = glm::max(box.high, boxes_[k].high);
    }
    return box;
  }

  /// Which cells are deep, a bit each, by key of the dense table; empty if none is, or if there is no such table.
  std::vector<std::uint32_t> deep_bits() const {
    if (deep_.empty() || dense_blocks_ == 0) return {};
    std::vector<std::uint32_t> bits(dense_blocks_ * kCells / 32);
    parallel_for(keys_.size(), kBlocks, [&](std::size_t begin, std::size_t end) {
      for (std::size_t block = begin; block < end; ++block)
        for (std::size_t k = 0; k < kCells / 32; ++k)
          bits[keys_[block] * (kCells / 32) + k] = static_cast<std::uint32_t>(deep_[block][k / 2] >> (k % 2 * 32));
    });
    return bits;
  }

  static constexpr std::uint32_t kLeftOut = 0xffffffffu;
  static constexpr Kind hidden_ = BandGrid::hidden;

  BandGrid& grid_;
  const Particles& particles_;
  const Options& options_;
  std::size_t dense_blocks_ = 0;
  std::vector<Bounds> boxes_;  ///< of pieces
  std::vector<BandPart> parts_;
  std::vector<std::uint64_t> keys_;  ///< of blocks, rising
  std::vector<std::uint32_t> own_;   ///< a block of each page
  std::vector<BandBits> filled_;     ///< by page: well filled cells
  std::vector<BandBits> deep_;       ///< empty where no cell is
};

BandGrid::BandGrid(const Particles& particles, const Options& options)
    : counted_(particles.size()), cell_size_(options.cell_size), per_cell_(1.0f / options.cell_size) {
  if (!(cell_size_ > 0.0f) || !std::isfinite(per_cell_))
    throw Error(ErrorCode::invalid_argument, fmt::format("cells of {} m cannot sort particles", cell_size_));
  if (counted_ >= 0xffffffffu)
    throw Error(ErrorCode::limit_exceeded,
                fmt::format("{} particles in one frame; at most 2^32 - 2 can be sorted", counted_));
  if (counted_ > 0) {
    Build(*this, particles, options).run();
    return;
  }
  for (auto axis : {&BandGrid::x_, &BandGrid::y_, &BandGrid::z_}) {
    this->*axis = paged_array<float>(kPadding);
    std::fill_n(&(this->*axis)[0], kPadding, kFarAway);
  }
}

int BandGrid::find_hashed(int bx, int by, int bz) const {
  if (hashed_.empty()) return -1;
  const std::size_t mask = hashed_.size() - 1;
  const std::uint64_t key =
      BandPart::key_of(static_cast<std::uint64_t>(bx), static_cast<std::uint64_t>(by), static_cast<std::uint64_t>(bz));
  const glm::ivec3 wanted = kSide * glm::ivec3(bx, by, bz);
  for (std::size_t at = BandPart::hash_of(key) & mask;; at = (at + 1) & mask) {
    const std::int32_t block = hashed_[at];
    if (block < 0 || corner_[static_cast<std::size_t>(block)] == wanted) return block;
  }
}

std::pair<int, int> BandGrid::place_of(vec3 point) const {
  const vec3 at = (point - origin_) * per_cell_;
  const vec3 beyond = static_cast<float>(kSide) * vec3(blocks_x_, blocks_y_, blocks_z_);
  if (!(at.x >= 0 && at.y >= 0 && at.z >= 0 && at.x < beyond.x && at.y < beyond.y && at.z < beyond.z)) return {-1, 0};
  const glm::ivec3 cell(at);
  return {find(cell.x / kSide, cell.y / kSide, cell.z / kSide),
          (cell.z % kSide * kSide + cell.y % kSide) * kSide + cell.x % kSide};
}

BandGrid::Kind BandGrid::kind_at(vec3 point) const {
  const auto [block, cell] = place_of(point);
  return block < 0 ? open : kinds(block)[cell];
}

bool BandGrid::full_at(vec3 point) const {
  if (!deep_) return false;
  const auto [block, cell] = place_of(point);
  if (block < 0) return false;
  const std::size_t page = kind_page_[static_cast<std::size_t>(block)];
  return (full_[page * kSide + static_cast<std::size_t>(cell / 64)] >> cell % 64 & 1) != 0;
}

bool BandGrid::touches_full(vec3 low, vec3 high) const {
  if (!deep_) return false;
  const vec3 last = static_cast<float>(kSide) * vec3(blocks_x_, blocks_y_, blocks_z_) - 1.0f;
  const vec3 from = glm::max((low - origin_) * per_cell_, vec3(0)), to = glm::min((high - origin_) * per_cell_, last);
  if (!(from.x <= to.x && from.y <= to.y && from.z <= to.z)) return false;
  const glm::ivec3 a(from), b(to);
  for (int bz = a.z / kSide; bz <= b.z / kSide; ++bz)
    for (int by = a.y / kSide; by <= b.y / kSide; ++by)
      for (int bx = a.x / kSide; bx <= b.x / kSide; ++bx) {
        const int block = find(bx, by, bz);
        if (block < 0 || all_open(block)) continue;
        const glm::ivec3 low_cell = glm::max(a - kSide * glm::ivec3(bx, by, bz), 0),
                         high_cell = glm::min(b - kSide * glm::ivec3(bx, by, bz), kSide - 1);
        const std::uint64_t row = (0xffu >> (7 - high_cell.x)) & (0xffu << low_cell.x);
        std::uint64_t mask = 0;
        for (int y = low_cell.y; y <= high_cell.y; ++y) mask |= row << (8 * y);
        const std::uint64_t* full = &full_[std::size_t{kind_page_[static_cast<std::size_t>(block)]} * kSide];
        for (int z = low_cell.z; z <= high_cell.z; ++z)
          if (full[z] & mask) return true;
      }
  return false;
}

std::uint64_t BandGrid::memory_bytes() const {
  const auto bytes = [](const auto& values) {
    return static_cast<std::uint64_t>(values.capacity()) * sizeof(values[0]);
  };
  return (index_ ? 4 : 3) * sizeof(float) * static_cast<std::uint64_t>(kept_ + kPadding) + bytes(corner_) +
         bytes(table_) + bytes(hashed_) + bytes(first_) + bytes(page_) + bytes(start_page_) + bytes(kind_page_) +
         bytes(start_) + bytes(count_) + bytes(kind_) + bytes(full_) + bytes(amidst_);
}

}  // namespace meniscus
