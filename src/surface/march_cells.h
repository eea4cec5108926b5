/// Where a march along a ray need not look: cells without water, and cells in the midst of it.
#pragma once

#include "surface/raycast_field.h"

namespace meniscus {

/// Cells, one spacing wide, in a tree whose nodes have 4 x 4 x 4 children each: nodes that are all of one kind have
/// none. So memory follows the surface of the water, and a cloud of spray a thousand times as wide as the tank takes
/// some hundred bytes a particle; and rays go through the air, and through deep water, by the largest such cube.
///
/// Outside: no particle's entry sphere reaches into the cell, so that the surface is not there, as see() takes it.
/// Inside: the density at all corners is well above the iso-value; it cannot fall below it in between, as it changes
/// over a smoothing length. What is left is unknown.
class MarchCells {
 public:
  enum Kind : std::uint8_t { outside = 0, unknown = 1, inside = 2 };
  enum class Find { all_kinds, outside_only };

  /// @param find  outside_only: no densities are summed, what is not outside is unknown
  explicit MarchCells(const RaycastField& field, Find find = Find::all_kinds);

  /// m along the ray, `t` or more, to the first cell that is not of this kind; what lies beyond the cells is outside.
  /// More than `limit`, up to infinity, where there is none.
  float leave(const Ray& ray, float t, float limit, Kind kind) const;
  Kind at(vec3 point) const;

  /// m: a spacing, or more where positions that far apart could not tell cells of a spacing apart.
  float cell_size() const { return size_; }
  std::uint64_t memory_bytes() const;

 private:
  class Build;
  class Way;

  /// 4 x 4 x 4 cells, bit (z * 4 + y) * 4 + x; neither bit set: outside.
  struct Leaf {
    std::uint64_t unknown = 0, inside = 0;
  };
  /// Children by the bits of their coordinates: z1 y1 x1 z0 y0 x0; neither bit set: outside.
  struct Node {
    std::uint64_t some = 0;       ///< of several kinds: nodes, or leaves, of the level below
    std::uint64_t inside = 0;     ///< all inside
    std::uint32_t first = 0;      ///< of those nodes
    std::uint8_t before[8] = {};  ///< of them, those whose bits lie in bytes before
    void count();
    std::uint32_t at(int child) const;
  };

  vec3 low_{0.0f};
  float size_ = 0;  ///< m
  int n_[3] = {0, 0, 0};
  std::vector<Leaf> leaves_;
  std::vector<std::vector<Node>> levels_;  ///< nodes of 16, 64 ... cells a side, in Morton order; the last is one
  /// By place, x fastest: nodes of 16 cells a side, kOutside or kInside; empty where the box is too large for its
  /// water.
  std::vector<std::int32_t> table_;
  int nodes_[3] = {0, 0, 0};  ///< of the table
  static constexpr std::int32_t kOutside = -1, kInside = -2;
};

}  // namespace meniscus
