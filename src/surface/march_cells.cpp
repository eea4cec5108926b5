#include "surface/march_cells.h"

#include <array>
#include <bit>
#include <cmath>

#include "surface/march_cells_build.h"

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// A child by the lowest two bits of its coordinates.
int child_of(int x, int y, int z) {
  const auto spread = [](int v) { return (v & 1) | (v & 2) << 2; };
  return spread(x) | spread(y) << 1 | spread(z) << 2;
}

/// Bits that are set, by byte: faster than what machines do that may have no instruction for it.
constexpr std::array<std::uint8_t, 256> kBitsSet = [] {
  std::array<std::uint8_t, 256> table{};
  for (unsigned v = 0; v < 256; ++v) table[v] = static_cast<std::uint8_t>(std::popcount(v));
  return table;
}();

}  // namespace

void MarchCells::Node::count() {
  int sum = 0;
  for (int byte = 0; byte < 8; ++byte) {
    before[byte] = static_cast<std::uint8_t>(sum);
    sum += kBitsSet[some >> (8 * byte) & 0xff];
  }
}

std::uint32_t MarchCells::Node::at(int child) const {
  const std::uint64_t byte = some >> (child & ~7) & 0xff;
  return first + before[child >> 3] + kBitsSet[byte & ((std::uint64_t{1} << (child & 7)) - 1)];
}

/// From cell to cell: keeps the last leaf, in which the next one mostly lies as well.
class MarchCells::Way {
 public:
  explicit Way(const MarchCells& cells) : cells_(cells) {}

  struct Cube {
    Kind kind;
    int side;  ///< cells, a power of four
  };
  /// The largest cube of one kind around a cell that is known as such.
  Cube around(const int (&c)[3]) {
    const int x = c[0] >> 2, y = c[1] >> 2, z = c[2] >> 2;
    if (leaf_ == nullptr || x != at_[0] || y != at_[1] || z != at_[2]) {
      Cube cube{unknown, 0};
      const Node* node = nullptr;
      if (cells_.table_.empty())
        node = from_root(c, cube);
      else
        node = from_table(c, cube);
      if (node == nullptr) return cube;
      const int child = child_of(x, y, z);
      if (node->inside >> child & 1) return {inside, 4};
      if (!(node->some >> child & 1)) return {outside, 4};
      leaf_ = &cells_.leaves_[node->at(child)];
      at_[0] = x;
      at_[1] = y;
      at_[2] = z;
    }
    const int bit = ((c[2] & 3) * 4 + (c[1] & 3)) * 4 + (c[0] & 3);
    return {leaf_->inside >> bit & 1 ? inside : leaf_->unknown >> bit & 1 ? unknown : outside, 1};
  }

 private:
  /// The node of 16 cells a side, or null and a cube of one kind.
  const Node* from_table(const int (&c)[3], Cube& cube) const {
    const std::int32_t found =
        cells_.table_[(static_cast<std::size_t>(c[2] >> 4) * static_cast<std::size_t>(cells_.nodes_[1]) +
                       static_cast<std::size_t>(c[1] >> 4)) *
                          static_cast<std::size_t>(cells_.nodes_[0]) +
                      static_cast<std::size_t>(c[0] >> 4)];
    if (found >= 0) return &cells_.levels_.front()[static_cast<std::size_t>(found)];
    cube = {found == kInside ? inside : outside, kMarchCube};
    return nullptr;
  }

  const Node* from_root(const int (&c)[3], Cube& cube) const {
    const Node* node = &cells_.levels_.back().front();
    for (std::size_t level = cells_.levels_.size() - 1; level > 0; --level) {
      const int shift = 2 * (static_cast<int>(level) + 1),
                child = child_of(c[0] >> shift, c[1] >> shift, c[2] >> shift);
      const bool in = node->inside >> child & 1;
      if (in || !(node->some >> child & 1)) {
        cube = {in ? inside : outside, 1 << shift};
        return nullptr;
      }
      node = &cells_.levels_[level - 1][node->at(child)];
    }
    return node;
  }

  const MarchCells& cells_;
  const Leaf* leaf_ = nullptr;
  int at_[3] = {0, 0, 0};  ///< of the leaf, in leaves
};

MarchCells::Kind MarchCells::at(vec3 point) const {
  if (levels_.empty()) return outside;
  int c[3];
  const double per_size = 1.0 / static_cast<double>(size_);
  for (int k = 0; k < 3; ++k) {
    const double at = (static_cast<double>(point[k]) - static_cast<double>(low_[k])) * per_size;
    if (!(at >= 0 && at < n_[k])) return outside;
    c[k] = static_cast<int>(at);
  }
  return Way(*this).around(c).kind;
}

float MarchCells::leave(const Ray& ray, float t, float limit, Kind kind) const {
  if (levels_.empty()) return kind == outside ? kInfinity : t;

  // Most rays are asked about where they are: on the surface.
  const double per_size = 1.0 / static_cast<double>(size_);
  Way way(*this);
  {
    int c[3];
    bool within = true;
    for (int k = 0; k < 3; ++k) {
      const double at = (static_cast<double>(ray.origin[k]) - static_cast<double>(low_[k]) +
                         static_cast<double>(t) * static_cast<double>(ray.direction[k])) *
                        per_size;
      within = within && at >= 0 && at < n_[k];
      if (within) c[k] = static_cast<int>(at);
    }
    if (within && way.around(c).kind != kind) return t;
  }

  // The part of the ray within the cells.
  const double size = static_cast<double>(size_);
  double origin[3], direction[3], inverse[3];
  double enter = static_cast<double>(t), exit = static_cast<double>(limit);
  for (int k = 0; k < 3; ++k) {
    const double o = static_cast<double>(ray.origin[k]) - static_cast<double>(low_[k]), high = n_[k] * size;
    origin[k] = o;
    direction[k] = static_cast<double>(ray.direction[k]);
    inverse[k] = std::abs(direction[k]) < 1e-12 ? 0.0 : 1.0 / direction[k];
    if (inverse[k] == 0.0) {
      if (!(o >= 0.0 && o <= high)) exit = -1.0;
      continue;
    }
    const double a = -o * inverse[k], b = (high - o) * inverse[k];
    enter = std::max(enter, std::min(a, b));
    exit = std::min(exit, std::max(a, b));
  }
  if (!(enter < exit)) return kind == outside ? kInfinity : t;
  if (enter > static_cast<double>(t) && kind != outside) return t;

  // From cube to cube.                                                                  [AmanatidesWoo1987]
  int c[3];
  const auto cell_of = [&](int k, double along, int least, int most) {
    const double at = (origin[k] + along * direction[k]) * per_size;
    return static_cast<int>(std::clamp(at, static_cast<double>(least), static_cast<double>(most)));
  };
  for (int k = 0; k < 3; ++k) c[k] = cell_of(k, enter, 0, n_[k] - 1);
  double here = enter;
  for (;;) {
    const Way::Cube cube = way.around(c);
    if (cube.kind != kind) return std::max(static_cast<float>(here), t);
    int low[3], axis = 0;
    double next = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; ++k) {
      low[k] = c[k] & ~(cube.side - 1);
      if (inverse[k] == 0.0) continue;
      const double end = ((low[k] + (direction[k] > 0 ? cube.side : 0)) * size - origin[k]) * inverse[k];
      if (end < next) {
        next = end;
        axis = k;
      }
    }
    here = std::max(here, next);
    if (!(here <= exit)) break;
    for (int k = 0; k < 3; ++k)
      c[k] = k == axis ? low[k] + (direction[k] > 0 ? cube.side : -1)
                       : cell_of(k, here, low[k], std::min(low[k] + cube.side, n_[k]) - 1);
    if (c[axis] < 0 || c[axis] >= n_[axis]) break;
  }
  return kind == outside || here > static_cast<double>(limit) ? kInfinity : std::max(static_cast<float>(here), t);
}

std::uint64_t MarchCells::memory_bytes() const {
  std::uint64_t bytes = leaves_.capacity() * sizeof(Leaf) + table_.capacity() * sizeof(std::int32_t);
  for (const std::vector<Node>& level : levels_) bytes += level.capacity() * sizeof(Node);
  return bytes;
}

}  // namespace meniscus
