/// The hollows of a terrain, and those within them.                                              [Barnes2020]
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace meniscus {

inline constexpr std::uint32_t kNone = 0xffffffffu;

/// How water runs over a terrain.
struct RunsDown {
  std::vector<std::uint32_t> order;  ///< cells by height, the lowest first; equal ones by index
  std::vector<std::uint32_t> rank;   ///< place of each cell in `order`
  std::vector<std::uint32_t> to;     ///< the lower neighbour; itself: a deepest point; kNone: over the border
};
RunsDown runs_down(int width, int height, std::span<const double> ground);

/// Two hollows that meet at a saddle make a new one, with both within; hollows that meet the border's land are roots.
struct HollowTree {
  /// Sums over cells, from which the volume under a level follows.
  struct Filled {
    double cells = 0, ground = 0, room = 0;
    void add(double height, double swallows) {
      cells += 1;
      ground += height;
      room += swallows;
    }
    void add(const Filled& other) {
      cells += other.cells;
      ground += other.ground;
      room += other.room;
    }
    /// m on one cell, under `level` >= all heights.
    double volume(double level) const { return cells * level - ground + room; }
    double level(double volume) const { return (volume + ground - room) / cells; }
  };
  struct Node {
    std::array<std::uint32_t, 2> within{kNone, kNone};  ///< none: a leaf, around one deepest point
    std::uint32_t parent = kNone;
    double spill_level = 0;
    std::uint32_t spill_leaf = kNone;            ///< where what spills comes to; kNone: over the border
    std::uint32_t first_leaf = 0, end_leaf = 0;  ///< its leaves, in an order in which they stand together
    std::size_t own_begin = 0, own_end = 0;      ///< in own_ranks: its cells that are in no hollow within
    Filled filled;                               ///< of all cells under its spill level
    double volume() const { return filled.volume(spill_level); }
  };
  std::vector<Node> nodes;               ///< hollows come after those within them
  std::vector<std::uint32_t> roots;      ///< in the order in which they have met the border's land
  std::vector<std::uint32_t> node_of;    ///< of each cell; kNone: the border's land
  std::vector<std::uint32_t> own_ranks;  ///< places in `order`, rising
  std::span<const std::uint32_t> order;
  std::uint32_t leaves = 0;
};

/// @param room  m that a cell swallows before water stands on it
HollowTree hollow_tree(int width, int height, std::span<const double> ground, std::span<const double> room,
                       const RunsDown& down);

}  // namespace meniscus
