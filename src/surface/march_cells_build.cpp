#include "surface/march_cells_build.h"

#include <cmath>

#include "particles/morton.h"
#include "surface/march_cells.h"
#include "surface/sized_field.h"

namespace meniscus {
namespace {

constexpr std::size_t kParticles = 1 << 15, kBlocks = 64, kCubes = 16;  ///< of a piece of work
constexpr double kMostCells = 1 << 25;  ///< along an axis: Morton keys of cubes have 21 bits each
constexpr std::uint64_t kAll = ~std::uint64_t{0};

void keep_once(std::vector<std::uint64_t>& keys) {
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
}

glm::ivec3 cube_of_key(std::uint64_t key) {
  glm::ivec3 at(0);
  for (int bit = 0; bit < kMortonLevels; ++bit)
    for (int k = 0; k < 3; ++k) at[k] |= static_cast<int>(key >> (3 * bit + k) & 1) << bit;
  return at;
}

}  // namespace

class MarchCells::Build {
 public:
  Build(MarchCells& cells, const RaycastField& field, Find find) : cells_(cells), field_(field), find_(find) {}

  void run() {
    place_cells();
    find_cubes();
    fill_cubes();
    tabulate();
    put_together();
  }

 private:
  void place_cells() {
    Bounds box;
    for_each_level(field_, [&](const RaycastField& level) {
      if (level.grid.size() > 0)
        box.add(level.grid.bounds().grown(level.options.smoothing_length + 0.01f * level.options.spacing));
    });
    cells_.low_ = box.low;
    cells_.size_ = field_.least_spacing;
    const vec3 extent = box.extent();
    while (static_cast<double>(std::max({extent.x, extent.y, extent.z})) >=
           (kMostCells - 1) * static_cast<double>(cells_.size_))
      cells_.size_ *= 2.0f;
    for (int k = 0; k < 3; ++k) cells_.n_[k] = static_cast<int>(march_cell(box.high[k], box.low[k], cells_.size_)) + 1;
  }

  /// Keys of the cubes that entry spheres reach into or that hold cells of the grid that are not open.
  void find_cubes() {
    const auto collect = [&](std::size_t count, std::size_t grain, auto add_keys) {
      std::vector<std::vector<std::uint64_t>> pieces((count + grain - 1) / grain);
      parallel_for(count, grain, [&](std::size_t begin, std::size_t end) {
        std::vector<std::uint64_t>& keys = pieces[begin / grain];
        add_keys(begin, end, keys);
        keep_once(keys);
      });
      for (const std::vector<std::uint64_t>& keys : pieces) keys_.insert(keys_.end(), keys.begin(), keys.end());
    };
    for_each_level(field_, [&](const RaycastField& level) {
      const BandGrid& grid = level.grid;
      collect(grid.size(), kParticles, [&](std::size_t begin, std::size_t end, std::vector<std::uint64_t>& keys) {
        for (std::size_t i = begin; i < end; ++i)
          if (const float r = level.entry_radius[i]; r > 0.0f) add(grid.position(i) - r, grid.position(i) + r, keys);
      });
      collect(static_cast<std::size_t>(grid.blocks()), kBlocks,
              [&](std::size_t begin, std::size_t end, std::vector<std::uint64_t>& keys) {
                for (int block = static_cast<int>(begin); block < static_cast<int>(end); ++block) {
                  if (grid.all_open(block)) continue;
                  for (int i = 0; i < BandGrid::kCells; ++i) {
                    if (grid.kinds(block)[i] == BandGrid::open) continue;
                    const vec3 low = grid.low(block) + grid.cell_size() * vec3(i % 8, i / 8 % 8, i / 64);
                    add(low, low + grid.cell_size(), keys);
                  }
                }
              });
    });
    keep_once(keys_);
  }

  void add(vec3 low, vec3 high, std::vector<std::uint64_t>& keys) const {
    int from[3], to[3];
    for (int k = 0; k < 3; ++k) {
      const auto cube = [&](float at) {
        const double cell = march_cell(at, cells_.low_[k], cells_.size_);
        return static_cast<int>(std::clamp(cell, 0.0, cells_.n_[k] - 1.0)) / kMarchCube;
      };
      from[k] = cube(low[k]);
      to[k] = cube(high[k]);
    }
    for (int z = from[2]; z <= to[2]; ++z)
      for (int y = from[1]; y <= to[1]; ++y)
        for (int x = from[0]; x <= to[0]; ++x) {
          const std::uint64_t key =
              morton_key(static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y), static_cast<std::uint64_t>(z));
          if (keys.empty() || keys.back() != key) keys.push_back(key);
        }
  }

  /// Leaves, and the nodes above them: each cube on its own.
  void fill_cubes() {
    cubes_.resize(keys_.size());
    const std::size_t pieces = (keys_.size() + kCubes - 1) / kCubes;
    std::vector<std::vector<Leaf>> leaves(pieces);
    const bool sums = find_ == Find::all_kinds && cells_.size_ == field_.least_spacing;
    parallel_for(keys_.size(), kCubes, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        cubes_[i] =
            filled({cells_.low_, cells_.size_, kMarchCube * cube_of_key(keys_[i])}, sums, leaves[begin / kCubes]);
    });
    std::size_t count = 0;
    for (const std::vector<Leaf>& piece : leaves) count += piece.size();
    cells_.leaves_.reserve(count);
    for (std::size_t piece = 0; piece < pieces; ++piece) {
      for (std::size_t i = piece * kCubes; i < std::min((piece + 1) * kCubes, keys_.size()); ++i)
        cubes_[i].first += static_cast<std::uint32_t>(cells_.leaves_.size());
      cells_.leaves_.insert(cells_.leaves_.end(), leaves[piece].begin(), leaves[piece].end());
      leaves[piece] = {};
    }
  }

  /// The node of a cube; adds its children to `leaves` and counts them from there on.
  Node filled(const MarchCubePlace& place, bool sums, std::vector<Leaf>& leaves) const {
    Node node;
    node.inside = kAll;
    if (sums && all_full(field_, place)) return node;
    node = {};
    node.first = static_cast<std::uint32_t>(leaves.size());
    const MarchRows reached = reached_cells(field_, place);
    const MarchRows inside = sums ? inside_cells(field_, place, reached) : MarchRows{};
    for (std::uint64_t child = 0; child < 64; ++child) {
      const glm::ivec3 at = 4 * cube_of_key(child);
      const Leaf leaf{bits_of(reached, at) & ~bits_of(inside, at), bits_of(inside, at)};
      if (leaf.inside == kAll) {
        node.inside |= std::uint64_t{1} << child;
      } else if (leaf.unknown != 0 || leaf.inside != 0) {
        node.some |= std::uint64_t{1} << child;
        leaves.push_back(leaf);
      }
    }
    node.count();
    return node;
  }

  /// Four rows of four cells in each of four layers.
  static std::uint64_t bits_of(const MarchRows& rows, glm::ivec3 at) {
    std::uint64_t bits = 0;
    for (int k = 0; k < 16; ++k) {
      const auto row = static_cast<std::size_t>((at.z + k / 4) * kMarchCube + at.y + k % 4);
      bits |= static_cast<std::uint64_t>(rows[row] >> at.x & 0xf) << (4 * k);
    }
    return bits;
  }

  /// A table of the cubes, where the box has not many more places than there are of them.
  void tabulate() {
    double places = 1;
    for (int k = 0; k < 3; ++k) {
      cells_.nodes_[k] = (cells_.n_[k] + kMarchCube - 1) / kMarchCube;
      places *= cells_.nodes_[k];
    }
    if (places > 8.0 * static_cast<double>(keys_.size()) + 4096) return;
    cells_.table_.assign(static_cast<std::size_t>(places), kOutside);
    std::int32_t stored = 0;  // as put_together() will place them
    for (std::size_t i = 0; i < keys_.size(); ++i) {
      const glm::ivec3 at = cube_of_key(keys_[i]);
      const auto place = static_cast<std::size_t>((at.z * cells_.nodes_[1] + at.y) * cells_.nodes_[0] + at.x);
      if (cubes_[i].inside == kAll)
        cells_.table_[place] = kInside;
      else if (cubes_[i].some != 0 || cubes_[i].inside != 0)
        cells_.table_[place] = stored++;
    }
  }

  /// The levels above, until one node holds all.
  void put_together() {
    const int most = std::max({cells_.n_[0], cells_.n_[1], cells_.n_[2]});
    std::vector<Node> nodes = std::move(cubes_);
    for (int side = kMarchCube; side < most; side *= 4) {
      std::vector<Node> stored, parents;
      std::vector<std::uint64_t> parent_keys;
      for (std::size_t i = 0; i < nodes.size(); ++i) {
        if (parent_keys.empty() || parent_keys.back() != keys_[i] >> 6) {
          parent_keys.push_back(keys_[i] >> 6);
          parents.emplace_back().first = static_cast<std::uint32_t>(stored.size());
        }
        const std::uint64_t bit = std::uint64_t{1} << (keys_[i] & 63);
        if (nodes[i].inside == kAll) {
          parents.back().inside |= bit;
          continue;
        }
        if (nodes[i].some == 0 && nodes[i].inside == 0) continue;
        parents.back().some |= bit;
        stored.push_back(nodes[i]);
      }
      for (Node& parent : parents) parent.count();
      stored.shrink_to_fit();
      cells_.levels_.push_back(std::move(stored));
      nodes = std::move(parents);
      keys_ = std::move(parent_keys);
    }
    if (nodes.empty()) nodes.emplace_back();  // nothing is reached
    cells_.levels_.push_back(std::move(nodes));
  }

  MarchCells& cells_;
  const RaycastField& field_;
  Find find_;
  std::vector<std::uint64_t> keys_;  ///< of the cubes with children that are not outside, in Morton order
  std::vector<Node> cubes_;          ///< theirs
};

MarchCells::MarchCells(const RaycastField& field, Find find) {
  bool any = false;
  for_each_level(field, [&](const RaycastField& level) { any |= level.grid.size() > 0; });
  if (any) Build(*this, field, find).run();
}

}  // namespace meniscus
