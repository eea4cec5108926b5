/// How the hollows of a terrain are found: cells in the order of height join the hollows that they touch.
#include "sim/hollow_tree.h"

#include <utility>

#include "meniscus/base.h"

namespace meniscus {
namespace {

/// Up to four neighbours of a cell.
struct Neighbours {
  std::array<std::uint32_t, 4> cells;
  int count = 0;
  bool at_border = false;
};
Neighbours neighbours_of(std::uint32_t c, std::uint32_t width, std::uint32_t height) {
  Neighbours n;
  const std::uint32_t i = c % width, j = c / width;
  const auto take = [&](bool there, std::uint32_t cell) {
    if (there)
      n.cells[static_cast<std::size_t>(n.count++)] = cell;
    else
      n.at_border = true;
  };
  take(j > 0, c - width);
  take(i > 0, c - 1);
  take(i + 1 < width, c + 1);
  take(j + 1 < height, c + width);
  return n;
}

/// Builds the tree while the water's level rises from cell to cell.
class Rising {
 public:
  Rising(int width, int height, std::span<const double> ground, std::span<const double> room, const RunsDown& down)
      : width_(static_cast<std::uint32_t>(width)),
        height_(static_cast<std::uint32_t>(height)),
        ground_(ground),
        room_(room),
        down_(down),
        leaf_of_(ground.size(), kNone) {
    tree_.node_of.assign(ground.size(), kNone);
    tree_.order = down.order;
  }

  HollowTree build() {
    for (const std::uint32_t c : down_.order) join(c);
    list_own_cells();
    number_leaves();
    return std::move(tree_);
  }

 private:
  /// A hollow that the cell touches, and the lowest of its cells beside it.
  struct Touched {
    std::uint32_t node, lowest;
  };

  /// The hollow that `node` is part of by now; kNone: the border's land.
  std::uint32_t top_of(std::uint32_t node) {
    std::uint32_t top = node;
    while (top != kNone && top_[top] != top) top = top_[top];
    while (node != top) node = std::exchange(top_[node], top);
    return top;
  }

  std::uint32_t new_node() {
    const auto node = static_cast<std::uint32_t>(tree_.nodes.size());
    tree_.nodes.emplace_back();
    top_.push_back(node);
    return node;
  }

  void join(std::uint32_t c) {
    const double level = ground_[c];
    const std::uint32_t rank = down_.rank[c];
    const Neighbours near = neighbours_of(c, width_, height_);
    std::array<Touched, 4> touched;
    std::size_t count = 0;
    bool land = near.at_border;
    std::uint32_t land_lowest = kNone;
    const auto lower = [&](std::uint32_t a, std::uint32_t b) { return b == kNone || down_.rank[a] < down_.rank[b]; };
    for (int k = 0; k < near.count; ++k) {
      const std::uint32_t n = near.cells[static_cast<std::size_t>(k)];
      if (down_.rank[n] > rank) continue;  // not yet under water
      const std::uint32_t top = tree_.node_of[n] == kNone ? kNone : top_of(tree_.node_of[n]);
      if (top == kNone) {
        land = true;
        if (lower(n, land_lowest)) land_lowest = n;
        continue;
      }
      std::size_t t = 0;
      while (t < count && touched[t].node != top) ++t;
      if (t == count)
        touched[count++] = {top, n};
      else if (lower(n, touched[t].lowest))
        touched[t].lowest = n;
    }

    // Where water from this cell comes to.
    const std::uint32_t to = down_.to[c];
    if (to != kNone && to != c) leaf_of_[c] = leaf_of_[to];

    // What spills here goes to the lowest neighbour first: hollows meet in the order of their depths beside the cell.
    for (std::size_t t = 1; t < count; ++t)
      for (std::size_t k = t; k > 0 && lower(touched[k].lowest, touched[k - 1].lowest); --k)
        std::swap(touched[k], touched[k - 1]);

    if (land) {
      if (near.at_border && land_lowest != kNone && !(ground_[land_lowest] < level)) land_lowest = kNone;
      std::size_t first = 1;  // those before the land meet as one hollow
      for (; first < count && lower(touched[first].lowest, land_lowest); ++first)
        touched[0] = merge(touched[0], touched[first], level);
      const bool before_land = count > 0 && lower(touched[0].lowest, land_lowest);
      for (std::size_t t = 0; t < count; t = t == 0 ? first : t + 1) {
        const std::uint32_t to_cell = t > 0 && before_land ? touched[0].lowest : land_lowest;
        close(touched[t].node, level, to_cell == kNone ? kNone : leaf_of_[to_cell]);
        top_[touched[t].node] = kNone;
        tree_.roots.push_back(touched[t].node);
      }
      return;
    }
    if (count == 0) {
      touched[0] = {new_node(), c};
      leaf_of_[c] = touched[0].node;
    }
    for (std::size_t t = 1; t < count; ++t) touched[0] = merge(touched[0], touched[t], level);
    tree_.node_of[c] = touched[0].node;
    tree_.nodes[touched[0].node].filled.add(level, room_[c]);
  }

  void close(std::uint32_t node, double level, std::uint32_t spill_leaf) {
    tree_.nodes[node].spill_level = level;
    tree_.nodes[node].spill_leaf = spill_leaf;
  }

  Touched merge(const Touched& a, const Touched& b, double level) {
    close(a.node, level, leaf_of_[b.lowest]);
    close(b.node, level, leaf_of_[a.lowest]);
    const std::uint32_t whole = new_node();
    HollowTree::Node& node = tree_.nodes[whole];
    node.within = {a.node, b.node};
    for (const std::uint32_t part : node.within) {
      tree_.nodes[part].parent = whole;
      top_[part] = whole;
      node.filled.add(tree_.nodes[part].filled);
    }
    return {whole, down_.rank[a.lowest] < down_.rank[b.lowest] ? a.lowest : b.lowest};
  }

  void list_own_cells() {
    std::vector<HollowTree::Node>& nodes = tree_.nodes;
    for (const std::uint32_t node : tree_.node_of)
      if (node != kNone) ++nodes[node].own_end;
    std::size_t begin = 0;
    for (HollowTree::Node& node : nodes) {
      node.own_begin = begin;
      begin += node.own_end;
      node.own_end = node.own_begin;
    }
    tree_.own_ranks.resize(begin);
    for (std::uint32_t rank = 0; rank < down_.order.size(); ++rank) {
      const std::uint32_t node = tree_.node_of[down_.order[rank]];
      if (node != kNone) tree_.own_ranks[nodes[node].own_end++] = rank;
    }
  }

  /// Leaves in the order of a walk through the trees, so that those of a hollow stand together.
  void number_leaves() {
    std::vector<HollowTree::Node>& nodes = tree_.nodes;
    for (HollowTree::Node& node : nodes)  // how many: within comes before
      node.end_leaf = node.within[0] == kNone ? 1 : nodes[node.within[0]].end_leaf + nodes[node.within[1]].end_leaf;
    for (std::size_t n = nodes.size(); n-- > 0;) {
      HollowTree::Node& node = nodes[n];
      if (node.parent == kNone) {
        node.first_leaf = tree_.leaves;
        tree_.leaves += node.end_leaf;
        node.end_leaf = tree_.leaves;
      }
      if (node.within[0] == kNone) continue;
      HollowTree::Node &a = nodes[node.within[0]], &b = nodes[node.within[1]];
      a.first_leaf = node.first_leaf;
      b.first_leaf = a.end_leaf += a.first_leaf;
      b.end_leaf += b.first_leaf;
    }
  }

  std::uint32_t width_, height_;
  std::span<const double> ground_, room_;
  const RunsDown& down_;
  std::vector<std::uint32_t> leaf_of_;  ///< of each cell: the deepest point that its water comes to
  std::vector<std::uint32_t> top_;      ///< of each hollow: itself, or one that it is part of
  HollowTree tree_;
};

}  // namespace

RunsDown runs_down(int width, int height, std::span<const double> ground) {
  const auto w = static_cast<std::uint32_t>(width), h = static_cast<std::uint32_t>(height);
  struct Cell {
    double height;
    std::uint32_t index;
  };
  std::vector<Cell> cells(ground.size());
  for (std::uint32_t c = 0; c < cells.size(); ++c) cells[c] = {ground[c], c};
  std::sort(cells.begin(), cells.end(), [](const Cell& a, const Cell& b) {
    return a.height < b.height || (a.height == b.height && a.index < b.index);
  });
  RunsDown down;
  down.order.resize(cells.size());
  down.rank.resize(cells.size());
  down.to.resize(cells.size());
  for (std::uint32_t k = 0; k < cells.size(); ++k) {
    down.order[k] = cells[k].index;
    down.rank[cells[k].index] = k;
  }
  parallel_for(cells.size(), 1 << 14, [&](std::size_t begin, std::size_t end) {
    for (auto c = static_cast<std::uint32_t>(begin); c < end; ++c) {
      const Neighbours near = neighbours_of(c, w, h);
      std::uint32_t lowest = c;
      for (int k = 0; k < near.count; ++k) {
        const std::uint32_t n = near.cells[static_cast<std::size_t>(k)];
        if (down.rank[n] < down.rank[lowest]) lowest = n;
      }
      // Over the border rather than along it on level ground.
      if (near.at_border && !(ground[lowest] < ground[c])) lowest = kNone;
      down.to[c] = lowest;
    }
  });
  return down;
}

HollowTree hollow_tree(int width, int height, std::span<const double> ground, std::span<const double> room,
                       const RunsDown& down) {
  return Rising(width, height, ground, room, down).build();
}

}  // namespace meniscus
