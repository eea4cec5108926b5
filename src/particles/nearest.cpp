#include "particles/nearest.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>
#include <utility>

#include "particles/morton.h"

namespace meniscus {
namespace {

constexpr int kLevels = kMortonLevels;
constexpr double kCells = 1 << kLevels;         // finest cells along an edge
constexpr int kHistogramLevel = 7;              // finest level at which blocks are chosen
constexpr std::size_t kBlockParticles = 16384;  // particles that a block should have: 25 along its edge
constexpr std::size_t kMaxCandidates = 16384;   // distances worth computing for one query
constexpr std::size_t kFewest = 16;             // part of the neighbours that the first cubes looked at have
constexpr std::size_t kGrain = 65536;

struct Blocks {
  int level = 0;               ///< of the octree at which cubes hold enough particles
  std::vector<bool> kept;      ///< for each cube of that level, in Morton order
  std::vector<bool> complete;  ///< kept, or without particles
};

/// Blocks of `limit` particles in all, by a hash of where they are.
Blocks chosen_blocks(const std::vector<std::uint64_t>& keys, std::size_t limit) {
  int level = kHistogramLevel;
  std::vector<std::size_t> counts(std::size_t{1} << 3 * level);
  for (const std::uint64_t key : keys) ++counts[key >> 3 * (kLevels - level)];
  const auto occupied = [&] {
    return counts.size() - static_cast<std::size_t>(std::count(counts.begin(), counts.end(), std::size_t{0}));
  };
  while (level > 1 && keys.size() / occupied() < kBlockParticles) {
    // Eight cubes in Morton order are one cube of the level above.
    for (std::size_t i = 0; i < counts.size() / 8; ++i) {
      std::size_t sum = 0;
      for (std::size_t j = 0; j < 8; ++j) sum += counts[8 * i + j];
      counts[i] = sum;
    }
    counts.resize(counts.size() / 8);
    --level;
  }
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] > 0) order.push_back(i);
  }
  std::sort(order.begin(), order.end(), [](std::size_t a, std::size_t b) { return hash_of(a) < hash_of(b); });
  Blocks blocks{level, std::vector<bool>(counts.size()), std::vector<bool>(counts.size(), true)};
  for (const std::size_t block : order) blocks.complete[block] = false;
  std::size_t total = 0;
  for (const std::size_t block : order) {
    if (total > 0 && total + counts[block] > limit) continue;
    blocks.kept[block] = blocks.complete[block] = true;
    total += counts[block];
  }
  return blocks;
}

}  // namespace

NearestIndex::NearestIndex(const Particles& particles, const Bounds& frame, std::size_t limit) : corner_(frame.low) {
  // A little more than the frame, and off its middle: faces of blocks should not fall on the water's own planes.
  const glm::dvec3 extent = glm::dvec3(frame.high) - corner_;
  const double edge = std::max({extent.x, extent.y, extent.z});
  corner_ -= 0.031 * edge;
  units_per_metre_ = edge > 0 ? kCells / (1.05 * edge) : 1.0;

  const auto cell = [&](float value, double low) {
    return static_cast<std::uint64_t>(std::clamp((double{value} - low) * units_per_metre_, 0.0, kCells - 1));
  };
  std::vector<std::uint64_t> keys(particles.size());
  parallel_for(keys.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      keys[i] =
          morton_key(cell(particles.x[i], corner_.x), cell(particles.y[i], corner_.y), cell(particles.z[i], corner_.z));
    }
  });
  std::vector<Keyed> items;
  if (keys.size() <= limit) {
    items.reserve(keys.size());
    for (std::size_t i = 0; i < keys.size(); ++i) items.push_back({keys[i], static_cast<std::uint32_t>(i)});
  } else {
    Blocks blocks = chosen_blocks(keys, limit);
    block_level_ = blocks.level;
    complete_ = std::move(blocks.complete);
    for (std::size_t i = 0; i < keys.size(); ++i) {
      if (blocks.kept[keys[i] >> 3 * (kLevels - block_level_)])
        items.push_back({keys[i], static_cast<std::uint32_t>(i)});
    }
  }
  keys = {};
  if (items.empty()) return;
  sort_by_key(items);
  keys_.resize(items.size());
  points_.resize(items.size());
  parallel_for(items.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      keys_[i] = items[i].key;
      points_[i] = particles.position(items[i].index);
    }
  });
}

std::vector<std::uint32_t> NearestIndex::sample(std::size_t count) const {
  std::vector<std::uint32_t> chosen;
  if (size() <= count) {
    for (std::uint32_t i = 0; i < size(); ++i) chosen.push_back(i);
    return chosen;
  }
  const auto bound =
      static_cast<std::uint64_t>(std::ldexp(static_cast<double>(count) / static_cast<double>(size()), 64));
  for (std::uint32_t i = 0; i < size(); ++i) {
    if (hash_of(keys_[i]) < bound) chosen.push_back(i);
  }
  // Particles that share few places are chosen all or none: then every so many-th.
  if (chosen.size() < count / 2 || chosen.size() > 2 * count) {
    chosen.clear();
    const std::size_t step = size() / count;
    for (std::size_t i = 0; i < size(); i += step) chosen.push_back(static_cast<std::uint32_t>(i));
  }
  return chosen;
}

NearestIndex::Run NearestIndex::run_of(std::uint64_t first_key, int level) const {
  const std::uint64_t last_key = first_key + (std::uint64_t{1} << 3 * (kLevels - level));
  const auto begin = std::lower_bound(keys_.begin(), keys_.end(), first_key);
  auto reach = std::size_t{16};
  auto left = begin;
  while (static_cast<std::size_t>(keys_.end() - left) > reach && left[static_cast<std::ptrdiff_t>(reach)] < last_key) {
    left += static_cast<std::ptrdiff_t>(reach);
    reach *= 2;
  }
  const auto right =
      static_cast<std::size_t>(keys_.end() - left) > reach ? left + static_cast<std::ptrdiff_t>(reach) : keys_.end();
  const auto end = std::lower_bound(left, right, last_key);
  return {static_cast<std::size_t>(begin - keys_.begin()), static_cast<std::size_t>(end - keys_.begin())};
}

bool NearestIndex::complete_within(glm::dvec3 place, double radius) const {
  if (block_level_ == 0) return true;
  const double edge = std::ldexp(1.0, kLevels - block_level_);
  const glm::dvec3 last(std::ldexp(1.0, block_level_) - 1);
  const glm::dvec3 low = glm::clamp(glm::floor((place - radius) / edge), glm::dvec3(0.0), last);
  const glm::dvec3 high = glm::clamp(glm::floor((place + radius) / edge), glm::dvec3(0.0), last);
  if (glm::any(glm::greaterThan(high - low, glm::dvec3(1.0)))) return false;
  for (double z = low.z; z <= high.z; ++z) {
    for (double y = low.y; y <= high.y; ++y) {
      for (double x = low.x; x <= high.x; ++x) {
        const auto block = [](double v) { return static_cast<std::uint64_t>(v); };
        if (!complete_[morton_key(block(x), block(y), block(z))]) return false;
      }
    }
  }
  return true;
}

std::vector<Neighbour> NearestIndex::nearest(std::uint32_t query, std::size_t count) const {
  const glm::dvec3 point(points_[query]);
  const glm::dvec3 place = glm::clamp((point - corner_) * units_per_metre_, glm::dvec3(0.0), glm::dvec3(kCells - 1));

  // Begin with cubes that hold a sixteenth of the neighbours or more: look at how far the keys before agree, or those
  // behind, as either may lie across a face of large cubes.
  const std::size_t few = std::max<std::size_t>(count / kFewest, 1);
  const std::uint64_t before = keys_[query] ^ keys_[query < few ? 0 : query - few];
  const std::uint64_t behind = keys_[query] ^ keys_[std::min(query + few, keys_.size() - 1)];
  const std::uint64_t difference =
      std::min(query < few ? ~std::uint64_t{0} : before, query + few >= keys_.size() ? ~std::uint64_t{0} : behind);
  int level = kLevels;
  while (level > 0 && (difference >> 3 * (kLevels - level)) != 0) --level;

  const auto scale = static_cast<float>(units_per_metre_);
  std::vector<std::uint64_t> order;
  for (;; --level) {
    const double edge = std::ldexp(1.0, kLevels - level);  // of a cube of this level, in finest cells
    const std::int64_t last = (std::int64_t{1} << level) - 1;
    const glm::dvec3 cube = glm::floor(place / edge);

    // The 27 cubes around hold every particle nearer than their border, but for the border of the frame.
    std::array<Run, 27> runs;
    std::size_t run_count = 0, candidates = 0;
    double reach = std::numeric_limits<double>::infinity();
    std::int64_t first[3], end[3];
    for (int a = 0; a < 3; ++a) {
      const auto c = static_cast<std::int64_t>(cube[a]);
      first[a] = std::max<std::int64_t>(c - 1, 0);
      end[a] = std::min(c + 1, last) + 1;
      if (c > 1) reach = std::min(reach, place[a] - static_cast<double>(first[a]) * edge);
      if (c + 1 < last) reach = std::min(reach, static_cast<double>(end[a]) * edge - place[a]);
    }
    for (std::int64_t z = first[2]; z < end[2]; ++z) {
      for (std::int64_t y = first[1]; y < end[1]; ++y) {
        for (std::int64_t x = first[0]; x < end[0]; ++x) {
          const std::uint64_t key =
              morton_key(static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y), static_cast<std::uint64_t>(z))
              << 3 * (kLevels - level);
          const Run run = run_of(key, level);
          if (run.begin == run.end) continue;
          runs[run_count++] = run;
          candidates += run.end - run.begin;
        }
      }
    }
    if (candidates > kMaxCandidates) return {};
    const bool all = reach == std::numeric_limits<double>::infinity();
    if (candidates < count && !all) continue;

    // Distances as integers of the same order, each with the particle behind it.
    order.clear();
    for (std::size_t r = 0; r < run_count; ++r) {
      for (std::size_t i = runs[r].begin; i < runs[r].end; ++i) {
        const vec3 offset = (points_[i] - points_[query]) * scale;
        order.push_back(std::uint64_t{std::bit_cast<std::uint32_t>(glm::dot(offset, offset))} << 32 | i);
      }
    }
    if (order.size() > count) {
      std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count), order.end());
      order.resize(count);
    }
    std::sort(order.begin(), order.end());
    const auto distance2 = [](std::uint64_t item) {
      return std::bit_cast<float>(static_cast<std::uint32_t>(item >> 32));
    };
    const double radius = std::sqrt(static_cast<double>(distance2(order.back())));
    if (radius > reach && !all) continue;

    if (!complete_within(place, radius)) return {};
    std::vector<Neighbour> found;
    found.reserve(order.size());
    for (const std::uint64_t item : order) {
      const glm::dvec3 offset((points_[item & 0xffffffff] - points_[query]) * scale);
      found.push_back({offset, glm::dot(offset, offset)});
    }
    return found;
  }
}

}  // namespace meniscus
