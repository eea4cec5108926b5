#include "surface/thickness_water.h"

#include <cstring>
#include <glm/geometric.hpp>
#include <numeric>

#include "particles/band_kinds.h"
#include "surface/thickness_canvas.h"

namespace meniscus {
namespace {

/// A particle or eighth of a cell that is at most so many samples wide is a point.
constexpr float kWidestPoint = 3.0f;
/// Of the particles that a cell inside the water holds, the share that counts as well filled.
constexpr float kWellFilled = 0.4f;
/// Up to so many kept particles all of them are looked at: only cells whose particles were left out are not.
constexpr std::size_t kAllParticles = 1 << 20;
constexpr std::size_t kMostPieces = 16;
constexpr double kPieceCost = 20000, kBlockCost = 100;  ///< in particles

/// The cells that are deep, or hidden or deep, from their kinds: those of a row
/// of eight at once.
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

/// By block, the cells amidst well filled ones: their particles need not be
/// known one by one.
std::vector<BandBits> amidst_water(const BandGrid& grid, float spacing) {
  const auto blocks = static_cast<std::size_t>(grid.blocks());
  std::vector<BandBits> bits(blocks, BandBits{});
  const float cell = grid.cell_size() / spacing;
  const auto well_filled = static_cast<std::uint32_t>(std::max(1.0f, kWellFilled * cell * cell * cell));
  const bool known = grid.has_hidden(), few = grid.size() <= kAllParticles;
  if (few && !grid.has_deep()) return bits;
  std::vector<BandSides> sides(known ? 0 : blocks);
  parallel_for(blocks, 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      const int block = static_cast<int>(b);
      bits[b] = {};
      if (known && grid.all_open(block)) continue;
      const std::uint32_t* counts = grid.counts(block);
      if (known)
        bits[b] = bits_of_kinds(grid.kinds(block), few);
      else
        for (std::size_t c = 0; c < BandGrid::kCells; ++c)
          bits[b][c / 64] |= static_cast<std::uint64_t>(counts[c] >= well_filled) << c % 64;
      if (known) continue;
      const glm::ivec3 at = grid.corner(block) / BandGrid::kSide;
      sides[b] = {grid.find(at.x - 1, at.y, at.z), grid.find(at.x + 1, at.y, at.z), grid.find(at.x, at.y - 1, at.z),
                  grid.find(at.x, at.y + 1, at.z), grid.find(at.x, at.y, at.z - 1), grid.find(at.x, at.y, at.z + 1)};
    }
  });
  if (!known) erode(bits, sides, 1, false);
  return bits;
}

struct CellsAmidst {
  double particles = 0;
  double cells = 0;
};

/// Particles in a cell amidst water, by block: the mean over such cells of the block and those around it. The numbers
/// of single cells would show: where rows of particles lie along the cells' sides, rounding puts two, four or six into
/// one.
std::vector<float> mean_counts(const BandGrid& grid, const std::vector<BandBits>& amidst) {
  std::vector<CellsAmidst> own(amidst.size());
  std::vector<float> means(amidst.size(), 0.0f);
  parallel_for(own.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b)
      for (std::size_t slice = 0; slice < amidst[b].size(); ++slice) {
        const std::uint32_t* counts = grid.counts(static_cast<int>(b)) + slice * 64;
        std::uint64_t sum = 0;
        if (amidst[b][slice] == ~std::uint64_t{0})
          sum = std::accumulate(counts, counts + 64, std::uint64_t{0});
        else
          for (std::uint64_t word = amidst[b][slice]; word != 0; word &= word - 1) sum += counts[__builtin_ctzll(word)];
        own[b].particles += static_cast<double>(sum);
        own[b].cells += __builtin_popcountll(amidst[b][slice]);
      }
  });
  parallel_for(own.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      if (!(own[b].cells > 0.0)) continue;
      const glm::ivec3 at = grid.corner(static_cast<int>(b)) / BandGrid::kSide;
      CellsAmidst sum;
      for (int z = -1; z <= 1; ++z)
        for (int y = -1; y <= 1; ++y)
          for (int x = -1; x <= 1; ++x) {
            const int other = grid.find(at.x + x, at.y + y, at.z + z);
            if (other < 0) continue;
            sum.particles += own[static_cast<std::size_t>(other)].particles;
            sum.cells += own[static_cast<std::size_t>(other)].cells;
          }
      means[b] = static_cast<float>(sum.particles / sum.cells);
    }
  });
  return means;
}

/// Whether all rays through the box run nearly along an axis' plane: the sum of boxes then ends in steps that single
/// rays would place to half a sample (18 % of the water in lines along the walls). Told for the whole picture, so that
/// boxes beside each other stay without a seam; views that see a wall edge on in one column alone do not pay for it.
bool sees_sides(const Bounds& box, const SplatCamera& camera) {
  constexpr float kSteep = 0.2f;  // sine of the angle
  if (!camera.perspective)
    return glm::min(glm::min(std::abs(camera.forward.x), std::abs(camera.forward.y)), std::abs(camera.forward.z)) <
           kSteep;
  for (int axis = 0; axis < 3; ++axis) {
    float low = 1, high = -1;
    for (int corner = 0; corner < 8; ++corner) {
      const vec3 at{(corner & 1) != 0 ? box.high.x : box.low.x, (corner & 2) != 0 ? box.high.y : box.low.y,
                    (corner & 4) != 0 ? box.high.z : box.low.z};
      const vec3 offset = at - camera.eye;
      const float length = glm::length(offset), sine = length > 0.0f ? offset[axis] / length : 0.0f;
      low = std::min(low, sine);
      high = std::max(high, sine);
    }
    if (low > -kSteep && high < kSteep) return true;
  }
  return false;
}

/// Blocks that are added to one canvas after another.
class Water {
 public:
  Water(const BandGrid& grid, float spacing, const SplatCamera& camera)
      : grid_(grid),
        spacing_(spacing),
        camera_(camera),
        volume_(spacing * spacing * spacing),
        steep_(sees_sides(grid.bounds(), camera)),
        amidst_(amidst_water(grid, spacing)),
        mean_count_(mean_counts(grid, amidst_)) {}

  SplatBox box(int block) const {
    const float half = 0.5f * grid_.cell_size() * BandGrid::kSide;
    return {grid_.low(block) + half, vec3{half}};
  }

  /// Samples that the block's water may be added to.
  SampleRect samples(int block) const {
    SplatBox around = box(block);
    around.half += kThicknessRadius * spacing_;
    SampleRect rect = samples_of(camera_, around);
    if (rect.empty()) return rect;
    // Points touch the sample beside theirs.
    rect.x0 = static_cast<std::uint16_t>(std::max(rect.x0 - 1, 0));
    rect.y0 = static_cast<std::uint16_t>(std::max(rect.y0 - 1, 0));
    rect.x1 = static_cast<std::uint16_t>(std::min(rect.x1 + 1, camera_.width - 1));
    rect.y1 = static_cast<std::uint16_t>(std::min(rect.y1 + 1, camera_.height - 1));
    return rect;
  }

  void add(int block, ThicknessCanvas& canvas) const {
    if (samples(block).empty()) return;
    const SplatBox whole = box(block);
    const float depth = glm::dot(whole.middle - camera_.eye, camera_.forward);
    const float half = glm::dot(glm::abs(camera_.forward), whole.half) + kThicknessRadius * spacing_;
    // Samples that a spacing is wide where it is widest; what lies around the eye's plane has to be cut by it.
    const float near = depth - half;
    const float spacing_samples = !(near > 0.0f)        ? 2.0f * kWidestPoint
                                  : camera_.perspective ? spacing_ / (near * camera_.du)
                                                        : spacing_ / camera_.du;
    const bool all_spheres = grid_.size() <= kAllSpheres;
    const BandBits& amidst = amidst_[static_cast<std::size_t>(block)];
    std::uint64_t all = ~std::uint64_t{0}, any = 0;
    for (const std::uint64_t word : amidst) {
      all &= word;
      any |= word;
    }
    if (all == ~std::uint64_t{0}) {
      add_box(camera_, whole, density(block), steep_, canvas);
      return;
    }
    if (any != 0)
      add_cells(block, amidst, all_spheres || 0.5f * spacing_samples * grid_.cell_size() > kWidestPoint * spacing_,
                canvas);
    add_particles(block, amidst, all_spheres || spacing_samples > kWidestPoint, canvas);
  }

 private:
  /// Of the water in cells amidst water, as a share of their volume.
  float density(int block) const {
    const float cell = grid_.cell_size();
    return mean_count_[static_cast<std::size_t>(block)] * volume_ / (cell * cell * cell);
  }

  /// The cells that are set: cubes of 4 and of 2 cells a side as boxes, the others one by one.
  void add_cells(int block, const BandBits& cells, bool as_boxes, ThicknessCanvas& canvas) const {
    BandBits rest = cells;
    for (const int side : {4, 2}) add_cubes(block, side, rest, canvas);
    if (as_boxes)
      add_cubes(block, 1, rest, canvas);
    else
      add_cells_as_points(block, rest, canvas);
  }

  /// Cubes of `side` cells, at multiples of it, all of whose cells are set in `rest`; clears them there.
  void add_cubes(int block, int side, BandBits& rest, ThicknessCanvas& canvas) const {
    const float half = 0.5f * static_cast<float>(side) * grid_.cell_size();
    for (int z = 0; z < BandGrid::kSide; z += side) {
      std::uint64_t full = ~std::uint64_t{0};
      for (int k = z; k < z + side; ++k) full &= rest[static_cast<std::size_t>(k)];
      if (full == 0) continue;
      for (int y = 0; y < BandGrid::kSide; y += side)
        for (int x = 0; x < BandGrid::kSide; x += side) {
          std::uint64_t cube = 0;
          for (int j = y; j < y + side; ++j) cube |= ((std::uint64_t{1} << side) - 1) << (8 * j + x);
          if ((full & cube) != cube) continue;
          for (int k = z; k < z + side; ++k) rest[static_cast<std::size_t>(k)] &= ~cube;
          const vec3 low = grid_.low(block) + grid_.cell_size() * vec3(x, y, z);
          add_box(camera_, {low + half, vec3{half}}, density(block), steep_, canvas);
        }
    }
  }

  /// Eight points a cell: one would show the rows of cells in views along an axis.
  void add_cells_as_points(int block, const BandBits& cells, ThicknessCanvas& canvas) const {
    const vec3 low = grid_.low(block);
    const float size = grid_.cell_size();
    constexpr std::size_t kPoints = 8 * 64;
    float x[kPoints], y[kPoints], z[kPoints];
    for (int slice = 0; slice < BandGrid::kSide; ++slice) {
      std::size_t number = 0;
      for (std::uint64_t word = cells[static_cast<std::size_t>(slice)]; word != 0; word &= word - 1) {
        const int in_slice = __builtin_ctzll(word);
        const vec3 first = low + size * (vec3(in_slice % 8, in_slice / 8, slice) + 0.25f);
        for (int k = 0; k < 8; ++k) {
          x[number] = first.x + 0.5f * size * static_cast<float>(k & 1);
          y[number] = first.y + 0.5f * size * static_cast<float>(k >> 1 & 1);
          z[number++] = first.z + 0.5f * size * static_cast<float>(k >> 2);
        }
      }
      if (number > 0) add_points(camera_, x, y, z, number, density(block) * size * size * size / 8.0f, canvas);
    }
  }

  /// Those of the block's cells that are not set.
  void add_particles(int block, const BandBits& but, bool as_spheres, ThicknessCanvas& canvas) const {
    for (int slice = 0; slice < BandGrid::kSide; ++slice) {
      const std::uint64_t word = but[static_cast<std::size_t>(slice)];
      for (int cell = 0; cell < 64;) {
        const std::uint64_t rest = word >> cell;
        if ((rest & 1) != 0) {
          cell += rest == ~std::uint64_t{0} ? 64 : __builtin_ctzll(~rest);
          continue;
        }
        const int last = rest == 0 ? 63 : cell + __builtin_ctzll(rest) - 1;
        const BandGrid::Run run = grid_.run(block, slice * 64 + cell, slice * 64 + last);
        cell = last + 1;
        if (!as_spheres) {
          if (run.begin < run.end)
            add_points(camera_, grid_.x() + run.begin, grid_.y() + run.begin, grid_.z() + run.begin,
                       run.end - run.begin, volume_, canvas);
          continue;
        }
        const float radius = kThicknessRadius * spacing_;
        const float weight = volume_ / (4.0f / 3.0f * 3.14159265f * radius * radius * radius);
        for (std::size_t i = run.begin; i < run.end; ++i)
          add_sphere(camera_, grid_.position(i), radius, weight, canvas);
      }
    }
  }

  const BandGrid& grid_;
  float spacing_;
  const SplatCamera& camera_;
  float volume_;  ///< m^3, of a particle
  bool steep_;    ///< whether boxes are seen along their sides
  std::vector<BandBits> amidst_;
  std::vector<float> mean_count_;
};

/// Ends of pieces of the blocks that cost about the same, whatever the number of threads.
std::vector<int> pieces_of(const BandGrid& grid) {
  const int blocks = grid.blocks();
  const double cost = static_cast<double>(grid.size()) + kBlockCost * blocks;
  const auto pieces = std::clamp<std::size_t>(static_cast<std::size_t>(cost / kPieceCost), 1, kMostPieces);
  std::vector<int> ends;
  for (int block = 0; block < blocks; ++block) {
    const double done = static_cast<double>(grid.run(block).end) + kBlockCost * (block + 1);
    if (done * static_cast<double>(pieces) >= cost * static_cast<double>(ends.size() + 1)) ends.push_back(block + 1);
  }
  if (ends.empty() || ends.back() != blocks) ends.push_back(blocks);
  return ends;
}

}  // namespace

Image<float> summed_water(const BandGrid& grid, float spacing, const SplatCamera& camera) {
  Image<float> sums(camera.width, camera.height, 0.0f);
  if (grid.blocks() == 0) return sums;
  const Water water(grid, spacing, camera);
  const std::vector<int> ends = pieces_of(grid);
  std::vector<ThicknessCanvas> canvases(ends.size());
  parallel_for(ends.size(), 1, [&](std::size_t piece, std::size_t) {
    const int begin = piece == 0 ? 0 : ends[piece - 1], end = ends[piece];
    SampleRect all;
    for (int block = begin; block < end; ++block) {
      const SampleRect rect = water.samples(block);
      if (rect.empty()) continue;
      if (all.empty()) all = rect;
      all = {std::min(all.x0, rect.x0), std::max(all.x1, rect.x1), std::min(all.y0, rect.y0),
             std::max(all.y1, rect.y1)};
    }
    canvases[piece].start(all);
    if (all.empty()) return;
    for (int block = begin; block < end; ++block) water.add(block, canvases[piece]);
  });
  parallel_for(static_cast<std::size_t>(camera.height), 16, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
      for (const ThicknessCanvas& canvas : canvases) {
        const SampleRect& rect = canvas.rect;
        if (rect.empty() || y < rect.y0 || y > rect.y1) continue;
        const float* from = canvas.row(y - rect.y0);
        float* to = sums.row(y) + rect.x0;
        for (int x = 0; x < canvas.width(); ++x) to[x] += from[x];
      }
  });
  return sums;
}

}  // namespace meniscus
