#include "surface/thickness_cells.h"

#include <cstring>
#include <numeric>

namespace meniscus {
namespace {

/// Of water of so many particles all that are kept are looked at: only cells whose particles were left out are not.
constexpr std::size_t kAllParticles = std::size_t{1} << 21;
/// Cells beside a plane that tell as much of where its water ends as knowing nothing of it does.
constexpr float kFewCells = 4;

/// The cells that are deep, or hidden or deep, from their kinds: those of a row of eight at once.
BandBits bits_of_kinds(const BandGrid::Kind* kinds, bool deep_only) {
  static_assert(BandGrid::hidden == 1 && BandGrid::deep == 2 && sizeof(BandGrid::Kind) == 1);
  constexpr std::uint64_t kOnes = 0x0101010101010101u;
  BandBits bits{};
  for (std::size_t row = 0; row < 64; ++row) {
    std::uint64_t eight;
    std::memcpy(&eight, kinds + 8 * row, 8);
    const std::uint64_t set = (deep_only ? eight >> 1 : eight >> 1 | eight) & kOnes;
    // Byte i of zero or one goes to bit 56 + i.
    bits[row / 8] |= set * 0x0102040810204080u >> 56 << 8 * (row % 8);
  }
  return bits;
}

/// What some cells of a layer across an axis hold.
struct Layer {
  float cells = 0, particles = 0;
  float offset = 0;  ///< sum over the particles, cells from the middles of theirs

  Layer& operator+=(const Layer& more) {
    cells += more.cells;
    particles += more.particles;
    offset += more.offset;
    return *this;
  }
};

/// Of a block, by axis and place along it.
struct Layers {
  Layer at[3][BandGrid::kSide];
};

/// Adds a cell whose particles are all kept.
void add_cell(const BandGrid& grid, int block, int cell, const BandGrid::Run& run, Layers& layers) {
  const glm::ivec3 place{cell % 8, cell / 8 % 8, cell / 64};
  const vec3 low = grid.low(block);
  const auto count = static_cast<float>(run.end - run.begin);
  vec3 sum{0};  // three at once: each waits for itself alone
  for (std::size_t i = run.begin; i < run.end; ++i) sum += vec3{grid.x()[i], grid.y()[i], grid.z()[i]} - low;
  for (int axis = 0; axis < 3; ++axis) {
    const float middle = static_cast<float>(place[axis]) + 0.5f;
    layers.at[axis][place[axis]] += {1, count, sum[axis] / grid.cell_size() - count * middle};
  }
}

/// Well filled cells near the surface, whose particles are known one by one, by layer.
Layers known_layers(const BandGrid& grid, int block, const BandBits& counted) {
  Layers layers;
  const bool by_kinds = grid.has_hidden();
  if (by_kinds && grid.all_open(block)) return layers;
  BandBits some = counted;
  if (by_kinds) {  // none of the particles of deep cells are there
    const BandBits deep = bits_of_kinds(grid.kinds(block), true);
    some = bits_of_kinds(grid.kinds(block), false);
    for (std::size_t slice = 0; slice < some.size(); ++slice) some[slice] &= ~deep[slice];
  }
  const std::uint32_t* counts = grid.counts(block);
  for (int slice = 0; slice < BandGrid::kSide; ++slice)
    for (std::uint64_t word = some[static_cast<std::size_t>(slice)]; word != 0; word &= word - 1) {
      const int cell = 64 * slice + __builtin_ctzll(word);
      const BandGrid::Run run = grid.run(block, cell);
      if (run.begin < run.end && run.end - run.begin == counts[cell]) add_cell(grid, block, cell, run, layers);
    }
  return layers;
}

/// Where the water ends between two layers, cells from the plane between them.
///
/// A layer of k rows of particles in n cells has its water k / 2 rows to both sides of their mean place.
/// @param in_cell  particles in a cell of the water
/// @param most     cells
float end_between(const Layer& before, const Layer& after, float in_cell, float most) {
  const float cells = before.cells + after.cells;
  if (!(cells > 0) || !(in_cell > 0)) return 0;
  // By layer and cell: mean offset of the particles, and half of what the water is thicker than the cell.
  float sum = 0;
  if (before.particles > 0)
    sum += before.cells * before.offset / before.particles + 0.5f * (before.particles / in_cell - before.cells);
  if (after.particles > 0)
    sum += after.cells * after.offset / after.particles - 0.5f * (after.particles / in_cell - after.cells);
  return std::clamp(sum / (cells + kFewCells), -most, most);
}

/// Of cells of a block whose planes have been moved, in cells.
double volume(const BandBits& cells, const float (&moved)[3][BandGrid::kSide + 1]) {
  float width[3][BandGrid::kSide], whole[3];
  for (int axis = 0; axis < 3; ++axis) {
    for (int i = 0; i < BandGrid::kSide; ++i) width[axis][i] = 1.0f + moved[axis][i + 1] - moved[axis][i];
    whole[axis] = BandGrid::kSide + moved[axis][BandGrid::kSide] - moved[axis][0];
  }
  double sum = 0;
  for (std::size_t slice = 0; slice < cells.size(); ++slice) {
    float area = 0;
    if (cells[slice] == ~std::uint64_t{0})
      area = whole[0] * whole[1];
    else
      for (std::uint64_t word = cells[slice]; word != 0; word &= word - 1)
        area += width[0][__builtin_ctzll(word) % 8] * width[1][__builtin_ctzll(word) / 8];
    sum += static_cast<double>(area * width[2][slice]);
  }
  return sum;
}

}  // namespace

CountedCells::CountedCells(const BandGrid& grid, float spacing, std::size_t all)
    : grid_(grid), blocks_(static_cast<std::size_t>(grid.blocks())) {
  choose(spacing, all);
  count();
  move_planes(spacing);
  const std::vector<float> means = mean_counts();
  const float in_full = std::pow(spacing / grid.cell_size(), 3.0f);
  for (std::size_t b = 0; b < means.size(); ++b) blocks_[b].density = means[b] * in_full;
}

/// Cells amidst well filled ones: their particles need not be known one by one.
void CountedCells::choose(float spacing, std::size_t all) {
  const float cell = grid_.cell_size() / spacing;
  const std::uint32_t well_filled = BandGrid::well_filled(cell * cell * cell);
  const bool known = grid_.has_hidden(), few = all <= kAllParticles;
  if (few && !grid_.has_deep()) return;
  std::vector<BandBits> bits(known ? 0 : blocks_.size());
  std::vector<BandSides> sides(bits.size());
  parallel_for(blocks_.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      const int block = static_cast<int>(b);
      if (known) {
        if (!grid_.all_open(block)) blocks_[b].cells = bits_of_kinds(grid_.kinds(block), few);
        continue;
      }
      bits[b] = {};
      const std::uint32_t* counts = grid_.counts(block);
      for (std::size_t c = 0; c < BandGrid::kCells; ++c)
        bits[b][c / 64] |= static_cast<std::uint64_t>(counts[c] >= well_filled) << c % 64;
      const glm::ivec3 at = grid_.corner(block) / BandGrid::kSide;
      sides[b] = {grid_.find(at.x - 1, at.y, at.z), grid_.find(at.x + 1, at.y, at.z), grid_.find(at.x, at.y - 1, at.z),
                  grid_.find(at.x, at.y + 1, at.z), grid_.find(at.x, at.y, at.z - 1), grid_.find(at.x, at.y, at.z + 1)};
    }
  });
  if (known) return;
  erode(bits, sides, 1, false);
  for (std::size_t b = 0; b < bits.size(); ++b) blocks_[b].cells = bits[b];
}

void CountedCells::move_planes(float spacing) {
  const std::vector<float> in_cell = mean_counts();
  std::vector<Layers> layers(blocks_.size());
  parallel_for(blocks_.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) layers[b] = known_layers(grid_, static_cast<int>(b), blocks_[b].cells);
  });
  const float most = 0.5f * spacing / grid_.cell_size();
  parallel_for(blocks_.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      if (!(in_cell[b] > 0.0f)) continue;
      const glm::ivec3 at = grid_.corner(static_cast<int>(b)) / BandGrid::kSide;
      int around[3][3][3];  // blocks by x, y, z
      for (int x = 0; x < 3; ++x)
        for (int y = 0; y < 3; ++y)
          for (int z = 0; z < 3; ++z) around[x][y][z] = grid_.find(at.x + x - 1, at.y + y - 1, at.z + z - 1);
      for (int axis = 0; axis < 3; ++axis) {
        // Layers -1 to 8 of the block, of it and the eight around it in that layer.
        Layer row[BandGrid::kSide + 2];
        for (int j = -1; j <= 1; ++j)
          for (int i = -1; i <= 1; ++i)
            for (int along = -1; along <= 1; ++along) {
              glm::ivec3 place{1};
              place[axis] += along;
              place[(axis + 1) % 3] += i;
              place[(axis + 2) % 3] += j;
              const int other = around[place.x][place.y][place.z];
              if (other < 0) continue;
              const Layer(&from)[BandGrid::kSide] = layers[static_cast<std::size_t>(other)].at[axis];
              if (along < 0) row[0] += from[BandGrid::kSide - 1];
              if (along > 0) row[BandGrid::kSide + 1] += from[0];
              for (int k = 0; along == 0 && k < BandGrid::kSide; ++k) row[k + 1] += from[k];
            }
        for (int plane = 0; plane <= BandGrid::kSide; ++plane)
          blocks_[b].moved[axis][plane] = end_between(row[plane], row[plane + 1], in_cell[b], most);
      }
    }
  });
  join_planes(in_cell);
}

/// Planes between blocks that both have cells: rays would meet a gap between two of them, or water twice.
void CountedCells::join_planes(const std::vector<float>& in_cell) {
  parallel_for(blocks_.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      if (!(in_cell[b] > 0.0f)) continue;
      for (int axis = 0; axis < 3; ++axis) {
        glm::ivec3 at = grid_.corner(static_cast<int>(b)) / BandGrid::kSide;
        ++at[axis];
        const int next = grid_.find(at.x, at.y, at.z);
        if (next < 0 || !(in_cell[static_cast<std::size_t>(next)] > 0.0f)) continue;
        float &here = blocks_[b].moved[axis][BandGrid::kSide],
              &there = blocks_[static_cast<std::size_t>(next)].moved[axis][0];
        here = there = 0.5f * (here + there);
      }
    }
  });
}

void CountedCells::count() {
  parallel_for(blocks_.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b)
      for (std::size_t slice = 0; slice < BandGrid::kSide; ++slice) {
        const std::uint64_t cells = blocks_[b].cells[slice];
        if (cells == 0) continue;
        const std::uint32_t* counts = grid_.counts(static_cast<int>(b)) + slice * 64;
        std::uint64_t sum = 0;
        if (cells == ~std::uint64_t{0})
          sum = std::accumulate(counts, counts + 64, std::uint64_t{0});
        else
          for (std::uint64_t word = cells; word != 0; word &= word - 1) sum += counts[__builtin_ctzll(word)];
        blocks_[b].particles += static_cast<double>(sum);
      }
  });
}

/// The numbers of single cells would show: where rows of particles lie along the cells' sides, rounding puts two, four
/// or six into one.
std::vector<float> CountedCells::mean_counts() const {
  std::vector<double> volumes(blocks_.size());
  std::vector<float> means(blocks_.size(), 0.0f);
  parallel_for(blocks_.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) volumes[b] = volume(blocks_[b].cells, blocks_[b].moved);
  });
  parallel_for(blocks_.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      if (!(volumes[b] > 0.0)) continue;
      const glm::ivec3 at = grid_.corner(static_cast<int>(b)) / BandGrid::kSide;
      double particles = 0, volume = 0;
      for (int z = -1; z <= 1; ++z)
        for (int y = -1; y <= 1; ++y)
          for (int x = -1; x <= 1; ++x) {
            const int other = grid_.find(at.x + x, at.y + y, at.z + z);
            if (other < 0) continue;
            particles += blocks_[static_cast<std::size_t>(other)].particles;
            volume += volumes[static_cast<std::size_t>(other)];
          }
      means[b] = static_cast<float>(particles / volume);
    }
  });
  return means;
}

}  // namespace meniscus
