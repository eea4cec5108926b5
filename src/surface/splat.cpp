#include "surface/splat.h"

#include "surface/splat_camera.h"
#include "surface/splat_tile.h"

namespace meniscus {
namespace {

constexpr std::size_t kGrain = 1 << 15;

struct Range {
  float low, high;
};

/// Ends of the sphere's silhouette along one axis of the plane at distance 1: the two planes through the eye
/// and the other axis that touch it.
Range tangents(float c, float z, float radius) {
  if (z + radius <= 0.0f) return {1.0f, -1.0f};
  const float denominator = z * z - radius * radius;
  if (z <= radius || denominator <= 1e-12f * z * z) return {-1e30f, 1e30f};  // the sphere reaches around the eye
  const float root = radius * std::sqrt(std::max(c * c + denominator, 0.0f));
  return {(c * z - root) / denominator, (c * z + root) / denominator};
}

SampleRect covered_pixels(const SplatCamera& camera, vec3 centre, float radius) {
  Range u, v;
  if (camera.perspective) {
    u = tangents(centre.x, centre.z, radius);
    v = tangents(centre.y, centre.z, radius);
    if (u.low > u.high) return {};
  } else {
    if (centre.z + radius <= 0.0f) return {};
    u = {centre.x - radius, centre.x + radius};
    v = {centre.y - radius, centre.y + radius};
  }
  return samples_within(camera, u.low, u.high, v.low, v.high);
}

/// Spheres by the tile that they touch, in their given order within each tile.
struct Bins {
  int tiles_x = 0, tiles_y = 0;
  std::vector<SampleRect> rects;     ///< by sphere
  std::vector<std::uint32_t> start;  ///< by tile, and one more
  std::vector<std::uint32_t> spheres;
};

float radius_of(const Spheres& spheres, std::size_t i) {
  return spheres.radius.size() == 1 ? spheres.radius[0] : spheres.radius[i];
}

template <class Visit>
void for_each_tile(const Bins& bins, const SampleRect& rect, Visit visit) {
  if (rect.empty()) return;
  for (int ty = rect.y0 / kTileHeight; ty <= rect.y1 / kTileHeight; ++ty)
    for (int tx = rect.x0 / kTileWidth; tx <= rect.x1 / kTileWidth; ++tx)
      visit(static_cast<std::size_t>(ty * bins.tiles_x + tx));
}

Bins sort_into_tiles(const SplatCamera& camera, const Spheres& spheres) {
  Bins bins;
  const std::size_t count = spheres.x.size();
  bins.tiles_x = (camera.width + kTileWidth - 1) / kTileWidth;
  bins.tiles_y = (camera.height + kTileHeight - 1) / kTileHeight;
  const auto tiles = static_cast<std::size_t>(bins.tiles_x * bins.tiles_y);
  const std::size_t blocks = std::clamp<std::size_t>(count / kGrain, 1, 64);
  const std::size_t per_block = (count + blocks - 1) / blocks;
  const auto block_end = [&](std::size_t block) { return std::min(count, (block + 1) * per_block); };
  bins.rects.resize(count);
  std::vector<std::vector<std::uint32_t>> counters(blocks, std::vector<std::uint32_t>(tiles, 0));
  parallel_for(blocks, 1, [&](std::size_t block, std::size_t) {
    for (std::size_t i = block * per_block; i < block_end(block); ++i) {
      bins.rects[i] =
          covered_pixels(camera, camera.to_camera({spheres.x[i], spheres.y[i], spheres.z[i]}), radius_of(spheres, i));
      for_each_tile(bins, bins.rects[i], [&](std::size_t tile) { ++counters[block][tile]; });
    }
  });
  bins.start = tile_starts(counters, tiles);
  bins.spheres.resize(bins.start[tiles]);
  parallel_for(blocks, 1, [&](std::size_t block, std::size_t) {
    for (std::size_t i = block * per_block; i < block_end(block); ++i)
      for_each_tile(bins, bins.rects[i],
                    [&](std::size_t tile) { bins.spheres[counters[block][tile]++] = static_cast<std::uint32_t>(i); });
  });
  return bins;
}

struct TileArea {
  int x, y, width, height;
};

/// Calls visit(rays, sphere) for every sphere of the tile, then is done with it.
template <class Visit>
void splat_tile(const SplatCamera& camera, const Spheres& spheres, const Bins& bins, std::size_t tile, TileArea& area,
                Visit visit) {
  const int tile_x = static_cast<int>(tile) % bins.tiles_x, tile_y = static_cast<int>(tile) / bins.tiles_x;
  area = {tile_x * kTileWidth, tile_y * kTileHeight, 0, 0};
  area.width = std::min(kTileWidth, camera.width - area.x);
  area.height = std::min(kTileHeight, camera.height - area.y);
  alignas(64) float inverse_length[kTileWidth * kTileHeight];
  TileRays rays{camera.perspective, camera.u0 + static_cast<float>(area.x) * camera.du,
                camera.du,          camera.v0 + static_cast<float>(area.y) * camera.dv,
                camera.dv,          inverse_length};
  if (camera.perspective && bins.start[tile] < bins.start[tile + 1])
    for (int y = 0; y < kTileHeight; ++y)
      for (int x = 0; x < kTileWidth; ++x) {
        const float u = rays.u0 + static_cast<float>(x) * rays.du, v = rays.v0 + static_cast<float>(y) * rays.dv;
        inverse_length[y * kTileWidth + x] = 1.0f / std::sqrt(u * u + v * v + 1.0f);
      }
  for (std::uint32_t at = bins.start[tile]; at < bins.start[tile + 1]; ++at) {
    const std::uint32_t i = bins.spheres[at];
    const SampleRect& rect = bins.rects[i];
    const vec3 centre = camera.to_camera({spheres.x[i], spheres.y[i], spheres.z[i]});
    visit(rays, TileSphere{centre.x, centre.y, centre.z, radius_of(spheres, i), std::max(rect.x0 - area.x, 0),
                           std::min(rect.x1 - area.x, kTileWidth - 1), std::max(rect.y0 - area.y, 0),
                           std::min(rect.y1 - area.y, kTileHeight - 1)});
  }
}

void copy_tile(const float* tile, const TileArea& area, Image<float>& picture) {
  for (int y = 0; y < area.height; ++y)
    std::copy_n(tile + y * kTileWidth, area.width, picture.row(area.y + y) + area.x);
}

}  // namespace

Image<float> splat_chords(const View& view, const Spheres& spheres, float weight, int stride) {
  const SplatCamera camera(view, stride);
  const Bins bins = sort_into_tiles(camera, spheres);
  Image<float> sums(camera.width, camera.height);
  parallel_for(static_cast<std::size_t>(bins.tiles_x * bins.tiles_y), 1, [&](std::size_t tile, std::size_t) {
    alignas(64) float tile_sum[kTileWidth * kTileHeight] = {};
    TileArea area{};
    splat_tile(camera, spheres, bins, tile, area,
               [&](const TileRays& rays, const TileSphere& sphere) { splat_chord_into_tile(rays, sphere, tile_sum); });
    for (float& sum : tile_sum) sum *= weight;
    copy_tile(tile_sum, area, sums);
  });
  return sums;
}

}  // namespace meniscus
