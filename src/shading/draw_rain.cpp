// Splashes and streaks over a picture: haze, splats, tiles.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>

#include "shading/draw_rain_tile.h"

namespace meniscus {
namespace {

void check(const View& view, const RainLook& look, const Image<float>& depth, const Image<vec3>& radiance) {
  if (view.projection == Projection::cube) throw Error(ErrorCode::unsupported, "rain is not drawn into cube views");
  if (depth.width() != view.width || depth.height() != view.height || radiance.width() != view.width ||
      radiance.height() != view.height)
    throw Error(
        ErrorCode::invalid_argument,
        fmt::format("a picture of {} x {} with {} x {} depths does not belong to a view of {} x {} pixels",
                    radiance.width(), radiance.height(), depth.width(), depth.height(), view.width, view.height));
  if (!(look.ior >= 1 && look.ior <= 4))
    throw Error(ErrorCode::invalid_argument, fmt::format("an index of refraction of {} is not from 1 to 4", look.ior));
  if (!(look.pile_opacity >= 0 && look.pile_opacity <= 1))
    throw Error(ErrorCode::invalid_argument, fmt::format("an opacity of {} is not from 0 to 1", look.pile_opacity));
  if (!(look.streak_strength >= 0) || !std::isfinite(look.streak_strength))
    throw Error(ErrorCode::invalid_argument,
                fmt::format("a strength of streaks of {} is negative or not finite", look.streak_strength));
  if (!(look.haze >= 0) || !std::isfinite(look.haze) ||
      !std::isfinite(look.haze_radiance.x + look.haze_radiance.y + look.haze_radiance.z))
    throw Error(ErrorCode::invalid_argument, "the rain's haze is negative or not finite");
}

/// What is solid fades into the haze; the sky's light has come through all of it already.
void add_haze(const RainLook& look, const Image<float>& depth, Image<vec3>& radiance) {
  if (!(look.haze > 0)) return;
  parallel_for(radiance.size(), 1 << 14, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (depth[i] < std::numeric_limits<float>::infinity())
        blend(radiance[i], look.haze_radiance, 1.0f - std::exp(-look.haze * std::max(depth[i], 0.0f)));
  });
}

/// Splats by the tiles that they touch. A key orders splats from far to near, then by index.
struct Bins {
  std::vector<std::size_t> starts;  ///< of each tile, and the end
  std::vector<std::uint64_t> keys;
};

std::uint64_t key_of(const Splat& splat, std::size_t index) {
  // Positive floats are in the order of their bits.
  const auto near = std::bit_cast<std::uint32_t>(std::max(0.5f * (splat.t0 + splat.t1), 0.0f));
  return static_cast<std::uint64_t>(~near) << 32 | index;
}

template <class Visit>
void for_each_tile(const Splats& splats, int across, Visit visit) {
  for (std::size_t run = 0; run < splats.counts.size(); ++run)
    for (std::size_t k = 0; k < splats.counts[run]; ++k) {
      const std::size_t i = run * Splats::kRun + k;
      const TileRange range = splats.ranges[i];
      for (int y = range.y0; y <= range.y1; ++y)
        for (int x = range.x0; x <= range.x1; ++x) visit(i, static_cast<std::size_t>(y * across + x));
    }
}

Bins binned(const Splats& splats, int across, int down) {
  Bins bins;
  bins.starts.assign(static_cast<std::size_t>(across * down) + 1, 0);
  for_each_tile(splats, across, [&](std::size_t, std::size_t tile) { ++bins.starts[tile + 1]; });
  for (std::size_t tile = 1; tile < bins.starts.size(); ++tile) bins.starts[tile] += bins.starts[tile - 1];
  bins.keys.resize(bins.starts.back());
  std::vector<std::size_t> next(bins.starts.begin(), bins.starts.end() - 1);
  for_each_tile(splats, across,
                [&](std::size_t i, std::size_t tile) { bins.keys[next[tile]++] = key_of(splats.splats[i], i); });
  return bins;
}

}  // namespace

void draw_rain(const View& view, std::span<const WaterPiece> pieces, const Surroundings& surroundings,
               const RainLook& look, const Image<float>& depth, Image<vec3>& radiance, StageTimes* times) {
  check(view, look, depth, radiance);
  const StageTimer timer(times, "rain");
  add_haze(look, depth, radiance);
  if (pieces.empty()) return;
  const RainLight light(view, surroundings, look.ior);
  const Splats splats = make_splats(view, pieces, light, look);
  const int across = (view.width + kRainTile - 1) / kRainTile, down = (view.height + kRainTile - 1) / kRainTile;
  Bins bins = binned(splats, across, down);
  if (bins.keys.empty()) return;
  std::vector<std::size_t> touched;
  for (std::size_t i = 0; i + 1 < bins.starts.size(); ++i)
    if (bins.starts[i] < bins.starts[i + 1]) touched.push_back(i);
  const auto tile_of = [&](std::size_t i) {
    const int x = static_cast<int>(i) % across * kRainTile, y = static_cast<int>(i) / across * kRainTile;
    return Tile{
        x, y, std::min(x + kRainTile, view.width), std::min(y + kRainTile, view.height), &radiance(x, y), view.width};
  };
  // While something looks at the picture behind it, tiles are drawn beside the picture.
  constexpr std::size_t kTileSize = std::size_t{kRainTile} * kRainTile;
  const std::unique_ptr<vec3[]> beside =
      splats.looks_behind ? std::make_unique_for_overwrite<vec3[]>(touched.size() * kTileSize) : nullptr;
  const auto copy = [](const Tile& from, const Tile& to) {
    for (int y = from.y0; y < from.y1; ++y) std::copy(from.row(y) + from.x0, from.row(y) + from.x1, to.row(y) + to.x0);
  };
  const auto tile_beside = [&](const Tile& tile, std::size_t k) {
    return Tile{tile.x0, tile.y0, tile.x1, tile.y1, beside.get() + k * kTileSize, kRainTile};
  };
  const RainPicture picture{view, pieces, light, look, depth, radiance};
  parallel_for(touched.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const std::size_t i = touched[k];
      const auto first = bins.keys.begin() + static_cast<std::ptrdiff_t>(bins.starts[i]);
      const auto last = bins.keys.begin() + static_cast<std::ptrdiff_t>(bins.starts[i + 1]);
      std::sort(first, last);
      Tile tile = tile_of(i);
      if (beside) {
        const Tile other = tile_beside(tile, k);
        copy(tile, other);
        tile = other;
      }
      for (auto key = first; key != last; ++key) draw_splat(picture, tile, splats.splats[*key & 0xffffffffu]);
    }
  });
  if (!beside) return;
  parallel_for(touched.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) copy(tile_beside(tile_of(touched[k]), k), tile_of(touched[k]));
  });
}

}  // namespace meniscus
