#include "sim/rain_tiles.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "base/random.h"

namespace meniscus {
namespace {

constexpr double kLongestSweep = 2;       ///< s before the arrival up to which the eye's image is followed
constexpr double kSmallestTile = 1;       ///< m
constexpr double kMostInTile = 64;        ///< drops, in the mean
constexpr double kMostTiles = 1 << 22;    ///< at once
constexpr int kMostHalvings = 24;         ///< of a slot
constexpr std::size_t kMostCount = 1023;  ///< drops in a tile and slot

/// m from a place to the line from `from` along `way`.
double distance_to(glm::dvec2 place, glm::dvec2 from, glm::dvec2 way) {
  const glm::dvec2 off = place - from;
  const double length2 = glm::dot(way, way);
  const double t = length2 > 0 ? std::clamp(glm::dot(off, way) / length2, 0.0, 1.0) : 0.0;
  return glm::length(off - t * way);
}

}  // namespace

std::vector<double> poisson_below(double mean) {
  std::vector<double> below;
  double each = std::exp(-mean), sum = 0;
  for (std::size_t i = 0; i < kMostCount; ++i) {
    sum += each;
    below.push_back(sum);
    each *= mean / static_cast<double>(i + 1);
    if (static_cast<double>(i) > mean && each < 1e-18) break;
  }
  below.push_back(2);
  return below;
}

glm::dvec2 RainEye::swept(double slowest) const {
  return sweep * std::min(height / std::max(slowest, 1e-6), kLongestSweep);
}

double RainEye::distance(glm::dvec2 at, double fall) const { return distance_to(at, place, swept(fall)); }

RainTiles::RainTiles(const RainSpectrum& spectrum, const RainThinning& thinning, int layers, double per_area,
                     glm::dvec2 sides, double whole)
    : slowest_(fall_speed(static_cast<float>(spectrum.first()))) {
  // Powers of two, so that drops stay the same where little is changed; not much wider than the region is.
  const auto power = [](double length) { return std::exp2(std::floor(std::log2(length))); };
  const double widest = power(0.5 * std::min(sides.x, sides.y));
  const double smallest = std::min(widest, std::max(kSmallestTile, power(std::max(whole, 1e-3) / 2)));
  for (int k = 0; k < layers; ++k) {
    const double tile = std::min(widest, smallest * std::exp2(k / 2));
    const RainLayer drops(spectrum, thinning, std::exp2(-(k + 1)), std::exp2(-k));
    double mean = per_area * drops.share() * tile * tile * kSlot;
    int halvings = 0;
    for (; mean > kMostInTile && halvings < kMostHalvings; ++halvings) mean /= 2;
    layers_.push_back({drops, tile, halvings, whole * std::exp2(0.5 * (k + 1)), poisson_below(mean)});
  }
}

void RainTiles::add(const RainOptions& options, const RainThinning& thinning, double low, double high,
                    FunctionRef<RainEye(std::int64_t)> eye, std::vector<RainDrop>& drops) const {
  if (layers_.empty() || !(low < high)) return;
  const glm::dvec2 region_low(options.low), region_high(options.high);
  const FieldAxes axes(options.up);

  // Tiles near the eye.
  std::vector<Tile> tiles;
  const auto too_many = [&] {
    if (static_cast<double>(tiles.size()) <= kMostTiles && (high - low) / kSlot <= kMostTiles) return;
    throw Error(ErrorCode::limit_exceeded, {"too many drops of rain are asked for at once",
                                            "less rain, or a smaller region around the eye",
                                            fmt::format("{:.3g} s", high - low),
                                            {},
                                            {},
                                            {},
                                            "ask for shorter times"});
  };
  too_many();
  const auto first = static_cast<std::int64_t>(std::floor(std::max(low, 0.0) / kSlot)),
             last = static_cast<std::int64_t>(std::floor(high / kSlot));
  for (std::int64_t slot = first; slot <= last; ++slot) {
    const RainEye at = eye(slot);
    if (!at.there) continue;
    const glm::dvec2 way = at.swept(slowest_);
    for (std::size_t k = 0; k < layers_.size(); ++k) {
      const Layer& layer = layers_[k];
      const double tile = layer.tile;
      const glm::dvec2 least = glm::max(glm::min(at.place, at.place + way) - layer.radius, region_low),
                       most = glm::min(glm::max(at.place, at.place + way) + layer.radius, region_high);
      if (!(least.x <= most.x && least.y <= most.y)) continue;
      const auto number = [&](double place) { return static_cast<std::int64_t>(std::floor(place / tile)); };
      // The layer's own, shorter slots within that of the eye.
      const double length = std::ldexp(kSlot, -layer.halvings);
      const std::uint64_t own = std::uint64_t{1} << layer.halvings, from = static_cast<std::uint64_t>(slot) * own;
      const auto begins = std::max(from, static_cast<std::uint64_t>(std::max(low, 0.0) / length)),
                 ends = std::min(from + own, static_cast<std::uint64_t>(high / length) + 1);
      for (std::int64_t b = number(least.y); b <= number(most.y); ++b)
        for (std::int64_t a = number(least.x); a <= number(most.x); ++a) {
          const glm::dvec2 middle = tile * (glm::dvec2(static_cast<double>(a), static_cast<double>(b)) + 0.5);
          if (distance_to(middle, at.place, way) > layer.radius + 0.7072 * tile) continue;
          for (std::uint64_t i = begins; i < ends; ++i) tiles.push_back({k, a, b, i});
          too_many();
        }
    }
  }

  // How many drops each holds: its first number.
  const auto draws_of = [&](const Tile& tile) {
    const std::uint64_t place =
        static_cast<std::uint64_t>(tile.a) << 32 ^ (static_cast<std::uint64_t>(tile.b) & 0xffffffff);
    return Draws(mixed(mixed(options.seed) ^ (tile.layer + 1)) ^ mixed(place), tile.slot);
  };
  std::vector<std::size_t> starts(tiles.size() + 1, drops.size());
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    const std::vector<double>& below = layers_[tiles[i].layer].below;
    const double u = draws_of(tiles[i]).uniform();
    starts[i + 1] =
        starts[i] + static_cast<std::size_t>(std::upper_bound(below.begin(), below.end(), u) - below.begin());
  }
  drops.resize(starts.back());
  parallel_for(tiles.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Tile& tile = tiles[i];
      const Layer& layer = layers_[tile.layer];
      Draws draws = draws_of(tile);
      draws.bits();
      const double slot = std::ldexp(kSlot, -layer.halvings);
      for (std::size_t d = starts[i]; d < starts[i + 1]; ++d) {
        RainDrop& drop = drops[d];
        drop.id = draws.bits();
        drop.time = options.start + slot * (static_cast<double>(tile.slot) + draws.uniform());
        const double part = draws.uniform(), within = draws.uniform();
        const RainLayer::Drop kind = layer.drops.drop(part, within, thinning);
        drop.diameter = kind.diameter;
        drop.weight = kind.u;
        const double along_a = draws.uniform(), along_b = draws.uniform();
        drop.place =
            axes.place(static_cast<float>(layer.tile * (static_cast<double>(tile.a) + along_a)),
                       static_cast<float>(layer.tile * (static_cast<double>(tile.b) + along_b)), options.level);
      }
    }
  });
}

}  // namespace meniscus
