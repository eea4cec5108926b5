// Entry and exit distances: groups of spheres sorted into tiles, nearest first, what is hidden left out.
#include <algorithm>
#include <bit>

#include "surface/depth_tile.h"
#include "surface/splat.h"

namespace meniscus {
namespace {

constexpr std::size_t kGrain = 1 << 11;  ///< groups

/// Where the picture shows a group's box, and between which distances along the rays, m.
struct SeenGroup {
  SampleRect rect;
  float near, far;
};

SeenGroup seen(const SplatCamera& camera, const SphereGroups::Group& group) {
  const SplatBox box{0.5f * (group.low + group.high), 0.5f * (group.high - group.low)};
  SeenGroup result{samples_of(camera, box), 0, 0};
  if (result.rect.empty()) return result;
  const vec3 offset = glm::abs(box.middle - camera.eye);
  // A little more than the box: the distances of the spheres are rounded, too.
  if (camera.perspective) {
    result.near = 0.99999f * glm::length(glm::max(offset - box.half, vec3{0.0f}));
    result.far = 1.00001f * glm::length(offset + box.half);
  } else {
    const float middle = glm::dot(box.middle - camera.eye, camera.forward),
                half = glm::dot(glm::abs(camera.forward), box.half), doubt = 1e-5f * (std::abs(middle) + half);
    result.near = std::max(middle - half - doubt, 0.0f);
    result.far = middle + half + doubt;
  }
  return result;
}

/// Groups by the tile that they touch, in their given order within each tile.
struct Bins {
  int tiles_x = 0, tiles_y = 0;
  std::vector<SeenGroup> seen;       ///< by group, of all sets one after another
  std::vector<std::uint32_t> start;  ///< by tile, and one more
  std::vector<std::uint32_t> groups;
};

template <class Visit>
void for_each_tile(const Bins& bins, const SampleRect& rect, Visit visit) {
  if (rect.empty()) return;
  for (int ty = rect.y0 / DepthTile::kSide; ty <= rect.y1 / DepthTile::kSide; ++ty)
    for (int tx = rect.x0 / DepthTile::kSide; tx <= rect.x1 / DepthTile::kSide; ++tx)
      visit(static_cast<std::size_t>(ty * bins.tiles_x + tx));
}

/// Several sets' groups as one list.
class GroupList {
 public:
  explicit GroupList(std::span<const GroupedSpheres> sets) : sets_(sets) {
    for (const GroupedSpheres& set : sets) {
      first_.push_back(size_);
      size_ += set.groups->groups().size();
    }
  }
  std::size_t size() const { return size_; }
  std::size_t set_of(std::size_t group) const {
    std::size_t set = sets_.size() - 1;
    while (first_[set] > group) --set;
    return set;
  }
  const Spheres& spheres(std::size_t group) const { return sets_[set_of(group)].spheres; }
  const SphereGroups::Group& operator[](std::size_t group) const {
    const std::size_t set = set_of(group);
    return sets_[set].groups->groups()[group - first_[set]];
  }

 private:
  std::span<const GroupedSpheres> sets_;
  std::vector<std::size_t> first_;
  std::size_t size_ = 0;
};

Bins sort_into_tiles(const SplatCamera& camera, const GroupList& groups) {
  Bins bins;
  const std::size_t count = groups.size();
  bins.tiles_x = (camera.width + DepthTile::kSide - 1) / DepthTile::kSide;
  bins.tiles_y = (camera.height + DepthTile::kSide - 1) / DepthTile::kSide;
  const auto tiles = static_cast<std::size_t>(bins.tiles_x) * static_cast<std::size_t>(bins.tiles_y);
  const std::size_t pieces = std::clamp<std::size_t>(count / kGrain, 1, 32);
  const std::size_t per_piece = (count + pieces - 1) / pieces;
  const auto end_of = [&](std::size_t piece) { return std::min(count, (piece + 1) * per_piece); };
  bins.seen.resize(count);
  std::vector<std::vector<std::uint32_t>> counters(pieces);
  parallel_for(pieces, 1, [&](std::size_t piece, std::size_t) {
    counters[piece].assign(tiles, 0);
    for (std::size_t i = piece * per_piece; i < end_of(piece); ++i) {
      bins.seen[i] = seen(camera, groups[i]);
      for_each_tile(bins, bins.seen[i].rect, [&](std::size_t tile) { ++counters[piece][tile]; });
    }
  });
  bins.start.resize(tiles + 1);
  std::uint32_t sum = 0;
  for (std::size_t tile = 0; tile < tiles; ++tile) {
    bins.start[tile] = sum;
    for (auto& mine : counters) {
      const std::uint32_t in_piece = mine[tile];
      mine[tile] = sum;
      sum += in_piece;
    }
  }
  bins.start[tiles] = sum;
  bins.groups.resize(sum);
  parallel_for(pieces, 1, [&](std::size_t piece, std::size_t) {
    for (std::size_t i = piece * per_piece; i < end_of(piece); ++i)
      for_each_tile(bins, bins.seen[i].rect,
                    [&](std::size_t tile) { bins.groups[counters[piece][tile]++] = static_cast<std::uint32_t>(i); });
  });
  return bins;
}

/// Quads of a tile whose first pixel is (x, y) that the rectangle touches.
template <class Visit>
void for_each_quad(const SampleRect& rect, int x, int y, Visit visit) {
  const auto quad = [](int pixel, int origin) {
    return std::clamp(pixel - origin, 0, DepthTile::kSide - 1) / DepthTile::kQuad;
  };
  for (int qy = quad(rect.y0, y); qy <= quad(rect.y1, y); ++qy)
    for (int qx = quad(rect.x0, x); qx <= quad(rect.x1, x); ++qx) visit(qy * DepthTile::kQuads + qx);
}

void draw_group(const SplatCamera& camera, const GroupList& groups, const Bins& bins, std::uint32_t group, int x, int y,
                DepthTile& tile) {
  const SeenGroup& shown = bins.seen[group];
  bool hidden = true;
  for_each_quad(shown.rect, x, y, [&](int quad) {
    hidden = hidden && shown.near > tile.full[quad] && (!tile.exact_exit || shown.far <= tile.least[quad]);
  });
  if (!hidden) {
    const SphereGroups::Group& spheres = groups[group];
    splat_into_depth_tile(camera, groups.spheres(group), spheres.begin, spheres.end, tile);
  } else if (!tile.exact_exit) {
    for_each_quad(shown.rect, x, y, [&](int quad) { tile.least[quad] = std::max(tile.least[quad], shown.far); });
  }
}

void draw_tile(const SplatCamera& camera, const GroupList& groups, const Bins& bins, std::size_t index, int x, int y,
               DepthTile& tile) {
  // Nearest groups first: they hide the others. The order does not matter for the entries.
  thread_local std::vector<std::uint64_t> order;
  order.clear();
  for (std::uint32_t at = bins.start[index]; at < bins.start[index + 1]; ++at) {
    const std::uint32_t group = bins.groups[at];
    order.push_back(static_cast<std::uint64_t>(std::bit_cast<std::uint32_t>(bins.seen[group].near)) << 32 | group);
  }
  // Sorted a few at a time, as the first ones often hide all others.
  for (std::size_t begin = 0, count = 24; begin < order.size(); begin += count, count *= 2) {
    const auto first = order.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto last = order.begin() + static_cast<std::ptrdiff_t>(std::min(begin + count, order.size()));
    if (last != order.end()) std::nth_element(first, last, order.end());
    std::sort(first, last);
    for (auto key = first; key != last; ++key) {
      if (!tile.exact_exit && bins.seen[static_cast<std::uint32_t>(*key)].near > tile.farthest) {
        float far = 0;
        for (; key != order.end(); ++key) far = std::max(far, bins.seen[static_cast<std::uint32_t>(*key)].far);
        for (float& least : tile.least) least = std::max(least, far);
        return;
      }
      draw_group(camera, groups, bins, static_cast<std::uint32_t>(*key), x, y, tile);
    }
  }
}

void copy_tile(const DepthTile& tile, int x, int y, Image<float>& entry, Image<float>& exit) {
  constexpr int kBlock = DepthTile::kBlock;
  for (int j = 0; j < tile.height; ++j) {
    float* to_entry = entry.row(y + j) + x;
    float* to_exit = exit.row(y + j) + x;
    for (int i = 0; i < tile.width; ++i) {
      const int at =
          (j / kBlock * DepthTile::kBlocks + i / kBlock) * kBlock * kBlock + j % kBlock * kBlock + i % kBlock;
      to_entry[i] = tile.entry[at];
      const float least = tile.least[j / DepthTile::kQuad * DepthTile::kQuads + i / DepthTile::kQuad];
      to_exit[i] = tile.exact_exit || !(tile.exit[at] > 0.0f) ? tile.exit[at] : std::max(tile.exit[at], least);
    }
  }
}

void draw(const View& view, std::span<const GroupedSpheres> sets, bool exact_exit, Image<float>& entry,
          Image<float>& exit) {
  const SplatCamera camera(view, 1);
  const GroupList groups(sets);
  const Bins bins = sort_into_tiles(camera, groups);
  entry = Image<float>(camera.width, camera.height);
  exit = Image<float>(camera.width, camera.height);
  parallel_for(bins.start.size() - 1, 1, [&](std::size_t index, std::size_t) {
    const int x = static_cast<int>(index) % bins.tiles_x * DepthTile::kSide,
              y = static_cast<int>(index) / bins.tiles_x * DepthTile::kSide;
    DepthTile tile;
    start_depth_tile(camera, x, y, exact_exit, tile);
    draw_tile(camera, groups, bins, index, x, y, tile);
    copy_tile(tile, x, y, entry, exit);
  });
}

}  // namespace

void splat_depth(const View& view, const Spheres& spheres, Image<float>& entry, Image<float>& exit) {
  const SphereGroups groups(spheres);
  const GroupedSpheres set{spheres, &groups};
  draw(view, {&set, 1}, true, entry, exit);
}

void splat_entries(const View& view, std::span<const GroupedSpheres> sets, Image<float>& entry, Image<float>& exit) {
  draw(view, sets, false, entry, exit);
}

}  // namespace meniscus
