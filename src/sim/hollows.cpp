/// Water at rest: the tree of hollows, and how it is filled.                                      [Barnes2021]
#include "sim/hollows.h"

#include "sim/hollow_tree.h"

namespace meniscus {
namespace {

/// Sums over ranges of a list whose entries grow: a binary indexed tree.                          [Fenwick1994]
class RangeSums {
 public:
  explicit RangeSums(std::size_t size) : sums_(size + 1, 0.0) {}
  void add(std::size_t place, double value) {
    for (std::size_t k = place + 1; k < sums_.size(); k += k & (~k + 1)) sums_[k] += value;
  }
  double between(std::size_t begin, std::size_t end) const { return up_to(end) - up_to(begin); }

 private:
  double up_to(std::size_t end) const {
    double sum = 0;
    for (std::size_t k = end; k > 0; k &= k - 1) sum += sums_[k];
    return sum;
  }
  std::vector<double> sums_;
};

/// A lake on a hollow: all cells of the hollow before `end` in the order of height are under its level.
struct Lake {
  double level = 0;
  std::uint32_t end = 0;  ///< 0: no lake
};

/// Fills the hollows of a tree with the water that has come to their deepest points.
class Filling {
 public:
  Filling(const HollowTree& tree, std::span<const double> ground, std::span<const double> room)
      : tree_(tree), ground_(ground), room_(room), sums_(tree.leaves), lakes_(tree.nodes.size()) {}

  void pour(std::uint32_t leaf, double depth) { sums_.add(tree_.nodes[leaf].first_leaf, depth); }

  /// @return  m that ran over the border
  double fill(std::span<double> water) {
    // What spills from a hollow beside the border's land comes to hollows that have joined that land before.
    for (auto root = tree_.roots.rbegin(); root != tree_.roots.rend(); ++root) {
      const HollowTree::Node& node = tree_.nodes[*root];
      const double here = depth_in(*root);
      if (here > node.volume()) {
        fill_to_the_brim(*root);
        spill(node, here - node.volume());
      } else {
        fill_within(*root, water);
      }
    }
    // A lake covers the hollows within its own.
    for (std::size_t n = tree_.nodes.size(); n-- > 0;) {
      const std::uint32_t parent = tree_.nodes[n].parent;
      if (parent != kNone && lakes_[parent].end > 0) lakes_[n] = lakes_[parent];
    }
    for (std::uint32_t k = 0; k < tree_.order.size(); ++k) {
      const std::uint32_t c = tree_.order[k], node = tree_.node_of[c];
      if (node == kNone || k >= lakes_[node].end) continue;
      water[c] += room_[c] + (lakes_[node].level - ground_[c]);
    }
    return drained_;
  }

 private:
  double depth_in(std::uint32_t node) const {
    return sums_.between(tree_.nodes[node].first_leaf, tree_.nodes[node].end_leaf);
  }

  void spill(const HollowTree::Node& node, double depth) {
    if (node.spill_leaf == kNone)
      drained_ += depth;
    else
      pour(node.spill_leaf, depth);
  }

  void fill_to_the_brim(std::uint32_t node) {
    lakes_[node] = {tree_.nodes[node].spill_level, static_cast<std::uint32_t>(tree_.order.size())};
  }

  /// Where the water of a hollow that it does not fill comes to lie: in both of the hollows within, or in all of it.
  void fill_within(std::uint32_t top, std::span<double> water) {
    pending_.assign(1, top);
    while (!pending_.empty()) {
      const std::uint32_t n = pending_.back();
      pending_.pop_back();
      const HollowTree::Node& node = tree_.nodes[n];
      const auto [a, b] = node.within;
      if (a == kNone) {
        raise(n, depth_in(n), water);
        continue;
      }
      const HollowTree::Node &first = tree_.nodes[a], &second = tree_.nodes[b];
      const double in_first = depth_in(a), in_second = depth_in(b);
      if (in_first + in_second >= first.volume() + second.volume()) {
        raise(n, in_first + in_second, water);
      } else if (in_first > first.volume()) {
        fill_to_the_brim(a);
        spill(first, in_first - first.volume());
        pending_.push_back(b);
      } else if (in_second > second.volume()) {
        fill_to_the_brim(b);
        spill(second, in_second - second.volume());
        pending_.push_back(a);
      } else {
        pending_.push_back(a);
        pending_.push_back(b);
      }
    }
  }

  /// One level over the hollow, cell by cell in the order of height from where the hollows within are full.
  void raise(std::uint32_t n, double depth, std::span<double> water) {
    if (!(depth > 0)) return;
    const HollowTree::Node& node = tree_.nodes[n];
    if (node.own_begin == node.own_end) return fill_to_the_brim(n);  // three that meet in one saddle
    HollowTree::Filled filled;
    if (node.within[0] != kNone) {
      filled = tree_.nodes[node.within[0]].filled;
      filled.add(tree_.nodes[node.within[1]].filled);
    }
    std::uint32_t end = filled.cells > 0 ? tree_.own_ranks[node.own_begin] : 0;
    for (std::size_t k = node.own_begin; k < node.own_end; ++k) {
      const std::uint32_t c = tree_.order[tree_.own_ranks[k]];
      const double before = filled.volume(ground_[c]);
      if (before >= depth) break;
      if (before + room_[c] >= depth) {  // the level stays at the cell's height while it swallows
        water[c] += depth - before;
        lakes_[n] = {ground_[c], tree_.own_ranks[k]};
        return;
      }
      filled.add(ground_[c], room_[c]);
      end = tree_.own_ranks[k] + 1;
    }
    lakes_[n] = {filled.level(depth), end};
  }

  const HollowTree& tree_;
  std::span<const double> ground_, room_;
  RangeSums sums_;
  std::vector<Lake> lakes_;
  std::vector<std::uint32_t> pending_;
  double drained_ = 0;
};

}  // namespace

double settle_in_hollows(int width, int height, std::span<const double> ground, std::span<const double> room,
                         std::span<double> water) {
  const RunsDown down = runs_down(width, height, ground);

  // Down to the deepest points, from the highest cell on; cells on the way swallow first.
  std::vector<double> room_left(room.begin(), room.end()), arrived(water.size(), 0.0);
  double drained = 0;
  std::vector<double> running(water.begin(), water.end());
  for (std::size_t k = down.order.size(); k-- > 0;) {
    const std::uint32_t c = down.order[k];
    water[c] = std::min(running[c], room_left[c]);
    room_left[c] -= water[c];
    const double on = running[c] - water[c];
    if (on <= 0) continue;
    if (down.to[c] == kNone)
      drained += on;
    else if (down.to[c] == c)
      arrived[c] = on;
    else
      running[down.to[c]] += on;
  }

  const HollowTree tree = hollow_tree(width, height, ground, room_left, down);
  Filling filling(tree, ground, room_left);
  for (std::uint32_t leaf = 0; leaf < tree.nodes.size(); ++leaf)
    if (tree.nodes[leaf].within[0] == kNone) {
      const double depth = arrived[tree.order[tree.own_ranks[tree.nodes[leaf].own_begin]]];
      if (depth > 0) filling.pour(leaf, depth);
    }
  return drained + filling.fill(water);
}

}  // namespace meniscus
