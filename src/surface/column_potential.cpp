#include "surface/column_potential.h"

#include <algorithm>
#include <cmath>

#include "surface/column_gather.h"
#include "surface/height_field_axes.h"

namespace meniscus {
namespace {

constexpr float kDry = -std::numeric_limits<float>::infinity();
constexpr std::size_t kLanes = 8;    ///< sums side by side, for the compiler to vectorise
constexpr float kStep = 0.25f;       ///< of the search from above, in reaches
constexpr float kThrough = 0.75f;    ///< of the search for the lower end of a body of water, in reaches
constexpr float kSlab = 2.0f;        ///< reaches of each column that are gathered at once
constexpr float kTolerance = 2e-4f;  ///< of a height, in reaches
constexpr int kRefinements = 12;

}  // namespace

ColumnPotential::ColumnPotential(const Particles& particles, Axis up, const Bounds& region,
                                 const ColumnOptions& options)
    : options_(options) {
  const FieldAxes axes(up);
  const std::array<const float*, 3> all{particles.x.data(), particles.y.data(), particles.z.data()};
  const float *as = all[static_cast<std::size_t>(axes.a)], *bs = all[static_cast<std::size_t>(axes.b)],
              *zs = all[static_cast<std::size_t>(axes.up)];
  const float reach = options.reach, slack = 0.5f * options.spacing;
  const vec2 low{region.low[axes.a], region.low[axes.b]}, high{region.high[axes.a], region.high[axes.b]};
  floor_ = region.low[axes.up];
  low_a_ = low.x - reach;
  low_b_ = low.y - reach;
  // Bins as wide as a spacing where the region is full of particles, wider where it is nearly empty.
  const double extent_a = static_cast<double>(high.x - low.x + 2 * reach),
               extent_b = static_cast<double>(high.y - low.y + 2 * reach);
  const double most = 4.0 * static_cast<double>(particles.size()) + 4096.0;
  const double bin = std::max(static_cast<double>(0.5f * reach), std::sqrt(extent_a * extent_b / most));
  bins_a_ = static_cast<int>(extent_a / bin) + 1;
  bins_b_ = static_cast<int>(extent_b / bin) + 1;
  per_bin_ = static_cast<float>(1.0 / bin);

  std::vector<Entry> unsorted;
  unsorted.reserve(particles.size() + particles.size() / 2);
  for (std::size_t i = 0; i < particles.size(); ++i) {
    if (!(as[i] >= low.x - slack && as[i] <= high.x + slack && bs[i] >= low.y - slack && bs[i] <= high.y + slack &&
          zs[i] >= floor_ - slack && zs[i] < std::numeric_limits<float>::infinity()))
      continue;
    const float a = std::clamp(as[i], low.x, high.x), b = std::clamp(bs[i], low.y, high.y), z = std::max(zs[i], floor_);
    const std::array<float, 3> a_images{a, 2 * low.x - a, 2 * high.x - a}, b_images{b, 2 * low.y - b, 2 * high.y - b};
    const std::array<bool, 3> a_near{true, a - low.x < reach, high.x - a < reach},
        b_near{true, b - low.y < reach, high.y - b < reach};
    for (std::size_t p = 0; p < 3; ++p)
      for (std::size_t q = 0; q < 3; ++q) {
        if (!a_near[p] || !b_near[q]) continue;
        unsorted.push_back({a_images[p], b_images[q], z, static_cast<std::uint32_t>(i)});
        if (z - floor_ < reach)
          unsorted.push_back({a_images[p], b_images[q], 2 * floor_ - z, static_cast<std::uint32_t>(i)});
      }
  }

  const auto bin_of = [&](const Entry& entry) {
    const int i = std::clamp(static_cast<int>((entry.a - low_a_) * per_bin_), 0, bins_a_ - 1);
    const int j = std::clamp(static_cast<int>((entry.b - low_b_) * per_bin_), 0, bins_b_ - 1);
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(bins_a_) + static_cast<std::size_t>(i);
  };
  const std::size_t bins = static_cast<std::size_t>(bins_a_) * static_cast<std::size_t>(bins_b_);
  start_.assign(bins + 1, 0);
  for (const Entry& entry : unsorted) ++start_[bin_of(entry) + 1];
  for (std::size_t i = 0; i < bins; ++i) start_[i + 1] += start_[i];
  entries_.resize(unsorted.size());
  std::vector<std::uint32_t> next(start_.begin(), start_.end() - 1);
  for (const Entry& entry : unsorted) entries_[next[bin_of(entry)]++] = entry;
  parallel_for(bins, 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      std::sort(entries_.begin() + start_[i], entries_.begin() + start_[i + 1], [](const Entry& x, const Entry& y) {
        // A full order, so that the sum does not depend on the sorting.
        if (x.z != y.z) return x.z > y.z;
        return x.a != y.a ? x.a < y.a : x.b < y.b;
      });
  });
  for (std::vector<float>* values : {&a_, &b_, &z_}) values->resize(entries_.size() + 2 * kLanes);
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    a_[i] = entries_[i].a;
    b_[i] = entries_[i].b;
    z_[i] = entries_[i].z;
  }
}

ColumnPotential::Bins ColumnPotential::bins_around(float a, float b) const {
  const auto bin = [&](float value, float low, int count) {
    return std::clamp(static_cast<int>(std::floor((value - low) * per_bin_)), 0, count - 1);
  };
  return {bin(a - options_.reach, low_a_, bins_a_), bin(a + options_.reach, low_a_, bins_a_),
          bin(b - options_.reach, low_b_, bins_b_), bin(b + options_.reach, low_b_, bins_b_)};
}

float ColumnPotential::highest(const Bins& bins, const Near& near) const {
  float top = kDry;
  std::size_t n = 0;
  for (int j = bins.j0; j <= bins.j1; ++j)
    for (int i = bins.i0; i <= bins.i1; ++i, ++n) {
      const std::size_t bin =
          static_cast<std::size_t>(j) * static_cast<std::size_t>(bins_a_) + static_cast<std::size_t>(i);
      if (near.next[n] < start_[bin + 1]) top = std::max(top, entries_[near.next[n]].z);
    }
  return top;
}

void ColumnPotential::gather(const Bins& bins, float a, float b, float down_to, Near& near) const {
  const float per_reach2 = 1.0f / (options_.reach * options_.reach);
  std::size_t left = 2 * kLanes, n = 0;
  for (int j = bins.j0; j <= bins.j1; ++j)
    for (int i = bins.i0; i <= bins.i1; ++i, ++n)
      left +=
          start_[static_cast<std::size_t>(j) * static_cast<std::size_t>(bins_a_) + static_cast<std::size_t>(i) + 1] -
          near.next[n];
  if (near.count + left > near.weight.size()) {
    near.weight.resize(2 * (near.count + left));
    near.z.resize(near.weight.size());
  }
  const ColumnSearch search{bins.i0, bins.i1, bins.j0, bins.j1, a, b, per_reach2, down_to, near.next.data()};
  near.count = gather_column({a_.data(), b_.data(), z_.data(), start_.data(), bins_a_}, search, near.weight.data(),
                             near.z.data(), near.count);
  for (std::size_t i = near.count; i % kLanes != 0; ++i) {
    near.weight[i] = -1;
    near.z[i] = 0;
  }
}

float ColumnPotential::potential(const Near& near, float z) const {
  const float per_reach = 1.0f / options_.reach;
  float sums[kLanes] = {};
  const float *weights = near.weight.data(), *places = near.z.data();
  for (std::size_t i = 0; i < near.count; i += kLanes)
    for (std::size_t l = 0; l < kLanes; ++l) {
      const float up = (z - places[i + l]) * per_reach;
      const float square = weights[i + l] - up * up;
      sums[l] += std::sqrt(square > 0 ? square : 0);
    }
  return ((sums[0] + sums[4]) + (sums[1] + sums[5])) + ((sums[2] + sums[6]) + (sums[3] + sums[7]));
}

/// The height between `low`, where the potential is not less than the iso-value, and `high`, where it is.
float ColumnPotential::refined(const Near& near, float low, float high) const {
  float at_low = potential(near, low) - options_.iso, at_high = potential(near, high) - options_.iso;
  int side = 0;
  for (int i = 0; i < kRefinements && high - low > kTolerance * options_.reach; ++i) {
    // False position, the value at an end that stays being halved (Illinois).
    const float z = low + (high - low) * std::clamp(at_low / (at_low - at_high), 0.02f, 0.98f);
    const float value = potential(near, z) - options_.iso;
    if (std::abs(value) < 1e-4f * options_.iso) return z;
    if (value >= 0) {
      low = z;
      at_low = value;
      if (side > 0) at_high *= 0.5f;
      side = 1;
    } else {
      high = z;
      at_high = value;
      if (side < 0) at_low *= 0.5f;
      side = -1;
    }
  }
  return low + (high - low) * std::clamp(at_low / (at_low - at_high), 0.0f, 1.0f);
}

float ColumnPotential::height(float a, float b, FunctionRef<bool(float)> in_solid, Near& near) const {
  const float reach = options_.reach, step = kStep * reach;
  const Bins bins = bins_around(a, b);
  near.count = 0;
  near.next.clear();
  for (int j = bins.j0; j <= bins.j1; ++j)
    for (int i = bins.i0; i <= bins.i1; ++i)
      near.next.push_back(
          start_[static_cast<std::size_t>(j) * static_cast<std::size_t>(bins_a_) + static_cast<std::size_t>(i)]);
  float gathered = std::numeric_limits<float>::infinity();  // all above is in the list
  const auto need = [&](float z) {
    if (z - reach >= gathered) return;
    gathered = z - kSlab * reach;
    gather(bins, a, b, gathered, near);
  };
  float drop = kDry;  // the lowest of the drops, should there be nothing else
  float z = highest(bins, near) + reach;
  while (z > floor_) {
    // Down through air: where nothing is near, to the next particle.
    need(z);
    if (near.count == 0) {
      const float next = highest(bins, near) + reach;
      if (!(next > floor_)) break;
      z = std::min(z - step, next);
      continue;
    }
    if (potential(near, z) < options_.iso) {
      z -= step;
      continue;
    }
    const float surface = refined(near, z, z + step);
    // Down through water, until it is known to be more than a drop.
    float below = z;
    bool air = false;
    while (!air && surface - below < options_.drop && below > floor_) {
      below -= kThrough * reach;
      need(below);
      air = below > floor_ && potential(near, below) < options_.iso;
    }
    if (!air || in_solid(below) || in_solid(below - 0.5f * options_.spacing)) return surface;
    drop = surface;
    z = below - step;
  }
  return drop;
}

vec3 ColumnPotential::colour(float a, float b, float z, std::span<const vec3> colours, Near& near) const {
  const float per_reach2 = 1.0f / (options_.reach * options_.reach);
  const Bins bins = bins_around(a, b);
  vec3 sum{0.0f};
  float weights = 0;
  static_cast<void>(near);
  for (int j = bins.j0; j <= bins.j1; ++j)
    for (int i = bins.i0; i <= bins.i1; ++i) {
      const std::size_t bin =
          static_cast<std::size_t>(j) * static_cast<std::size_t>(bins_a_) + static_cast<std::size_t>(i);
      for (std::size_t at = start_[bin]; at < start_[bin + 1] && entries_[at].z > z - options_.reach; ++at) {
        const Entry& entry = entries_[at];
        const float da = entry.a - a, db = entry.b - b, dz = entry.z - z;
        const float square = 1 - (da * da + db * db + dz * dz) * per_reach2;
        if (!(square > 0)) continue;
        sum += std::sqrt(square) * colours[entry.index];
        weights += std::sqrt(square);
      }
    }
  return weights > 0 ? sum / weights : sum;
}

double ColumnPotential::value(float a, float b, float z) const {
  double sum = 0;
  const double reach = static_cast<double>(options_.reach);
  for (const Entry& entry : entries_) {
    const double da = static_cast<double>(entry.a) - static_cast<double>(a),
                 db = static_cast<double>(entry.b) - static_cast<double>(b),
                 dz = static_cast<double>(entry.z) - static_cast<double>(z);
    const double square = 1 - (da * da + db * db + dz * dz) / (reach * reach);
    if (square > 0) sum += std::sqrt(square);
  }
  return sum;
}

}  // namespace meniscus
