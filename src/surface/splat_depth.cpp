// Entry and exit distances: clusters of spheres sorted into tiles, nearest first, what is hidden left out.
#include <algorithm>
#include <bit>

#include "surface/depth_tile.h"
#include "surface/splat.h"

namespace meniscus {
namespace {

constexpr std::size_t kGrain = 1 << 9;  ///< clusters

using Cluster = SphereGroups::Cluster;

/// One cluster of one of the sets.
struct ListedCluster {
  const Cluster* cluster;
  const Spheres* spheres;
};

std::vector<ListedCluster> listed(std::span<const GroupedSpheres> sets) {
  std::size_t count = 0;
  for (const GroupedSpheres& set : sets) count += set.groups->clusters();
  std::vector<ListedCluster> list;
  list.reserve(count);
  for (const GroupedSpheres& set : sets)
    for (const auto& piece : set.groups->pieces())
      for (const Cluster& cluster : piece) list.push_back({&cluster, &set.spheres});
  return list;
}

/// Where the picture shows a cluster's box, and between which distances along the rays, m.
struct SeenCluster {
  SampleRect rect;
  float near, far;
};

SeenCluster seen(const SplatCamera& camera, const Cluster& cluster) {
  const SplatBox box{0.5f * (cluster.low + cluster.high), 0.5f * (cluster.high - cluster.low)};
  SeenCluster result{samples_of(camera, box), 0, 0};
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

/// Clusters by the tile that they touch, in their given order within each tile.
struct Bins {
  int tiles_x = 0, tiles_y = 0;
  std::vector<SeenCluster> seen;     ///< by cluster, of all sets one after another
  std::vector<std::uint32_t> start;  ///< by tile, and one more
  std::vector<std::uint32_t> clusters;
};

template <class Visit>
void for_each_tile(const Bins& bins, const SampleRect& rect, Visit visit) {
  if (rect.empty()) return;
  for (int ty = rect.y0 / DepthTile::kSide; ty <= rect.y1 / DepthTile::kSide; ++ty)
    for (int tx = rect.x0 / DepthTile::kSide; tx <= rect.x1 / DepthTile::kSide; ++tx)
      visit(static_cast<std::size_t>(ty * bins.tiles_x + tx));
}

Bins sort_into_tiles(const SplatCamera& camera, std::span<const ListedCluster> list) {
  Bins bins;
  const std::size_t count = list.size();
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
      bins.seen[i] = seen(camera, *list[i].cluster);
      for_each_tile(bins, bins.seen[i].rect, [&](std::size_t tile) { ++counters[piece][tile]; });
    }
  });
  bins.start = tile_starts(counters, tiles);
  bins.clusters.resize(bins.start[tiles]);
  parallel_for(pieces, 1, [&](std::size_t piece, std::size_t) {
    for (std::size_t i = piece * per_piece; i < end_of(piece); ++i)
      for_each_tile(bins, bins.seen[i].rect,
                    [&](std::size_t tile) { bins.clusters[counters[piece][tile]++] = static_cast<std::uint32_t>(i); });
  });
  return bins;
}

/// Draws the runs of a tile's clusters from the nearest on, until what remains begins behind all that it shows.
void draw_tile(const SplatCamera& camera, std::span<const ListedCluster> list, const Bins& bins, std::size_t index,
               DepthTile& tile) {
  std::vector<std::uint64_t> order;  // distances are not negative: their bits sort as they do
  order.reserve(bins.start[index + 1] - bins.start[index]);
  for (std::uint32_t at = bins.start[index]; at < bins.start[index + 1]; ++at) {
    const std::uint32_t cluster = bins.clusters[at];
    order.push_back(static_cast<std::uint64_t>(std::bit_cast<std::uint32_t>(bins.seen[cluster].near)) << 32 | cluster);
  }
  std::sort(order.begin(), order.end());
  const auto seen = [&](std::uint64_t key) -> const SeenCluster& { return bins.seen[static_cast<std::uint32_t>(key)]; };
  // A few clusters at a time; of their runs those are drawn that begin before the next cluster.
  constexpr std::size_t kAtOnce = 8;
  std::vector<TileRun> waiting, ready;
  for (std::size_t begin = 0; begin < order.size();) {
    if (seen(order[begin]).near > tile.farthest) {
      float far = 0;
      for (; begin < order.size(); ++begin) far = std::max(far, seen(order[begin]).far);
      for (float& exit : tile.exit) exit = std::max(exit, far);
      break;
    }
    const std::size_t end = std::min(begin + kAtOnce, order.size());
    for (; begin < end; ++begin) {
      const ListedCluster& cluster = list[static_cast<std::uint32_t>(order[begin])];
      list_runs(camera, *cluster.spheres, *cluster.cluster, tile, waiting);
    }
    const auto rest =
        end == order.size() ? waiting.end() : std::partition(waiting.begin(), waiting.end(), [&](const TileRun& run) {
          return run.near <= seen(order[end]).near;
        });
    ready.assign(waiting.begin(), rest);
    waiting.erase(waiting.begin(), rest);
    std::sort(ready.begin(), ready.end(), [](const TileRun& a, const TileRun& b) {
      return a.near != b.near ? a.near < b.near : a.begin < b.begin;
    });
    draw_runs(camera, ready, tile);
  }
  if (!waiting.empty()) draw_runs(camera, waiting, tile);  // behind all that is seen: for their exits
}

/// Nothing in the tile whose first pixel is (x, y).
void clear_tile(int x, int y, Image<float>& entry, Image<float>& exit) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const int width = std::min(DepthTile::kSide, entry.width() - x);
  for (int row = y; row < std::min(y + DepthTile::kSide, entry.height()); ++row) {
    std::fill_n(entry.row(row) + x, width, kInfinity);
    std::fill_n(exit.row(row) + x, width, -kInfinity);
  }
}

}  // namespace

void splat_entries(const View& view, std::span<const GroupedSpheres> sets, Image<float>& entry, Image<float>& exit) {
  const SplatCamera camera(view, 1);
  const std::vector<ListedCluster> list = listed(sets);
  const Bins bins = sort_into_tiles(camera, list);
  for (Image<float>* picture : {&entry, &exit})
    if (picture->width() != camera.width || picture->height() != camera.height)
      *picture = Image<float>(camera.width, camera.height);
  parallel_for(bins.start.size() - 1, 1, [&](std::size_t index, std::size_t) {
    const int x = static_cast<int>(index) % bins.tiles_x * DepthTile::kSide,
              y = static_cast<int>(index) / bins.tiles_x * DepthTile::kSide;
    if (bins.start[index] == bins.start[index + 1]) {
      clear_tile(x, y, entry, exit);
      return;
    }
    DepthTile tile;
    start_depth_tile(camera, x, y, tile);
    draw_tile(camera, list, bins, index, tile);
    copy_depth_tile(tile, x, y, entry, exit);
  });
}

}  // namespace meniscus
