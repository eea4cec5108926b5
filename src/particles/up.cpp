#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "meniscus/particles.h"
#include "particles/core.h"

namespace meniscus {
namespace {

constexpr int kColumns = 16;              // along each of the two other axes
constexpr int kFewest = 3;                // particles in a column that counts
constexpr float kSharp = 0.06f;           // part of the extent within which a column reaches the end
constexpr std::size_t kSample = 1 << 18;  // particles looked at
constexpr float kFloor = 0.5f;            // part of the columns that must stand on the floor ...
constexpr float kFlat = 0.5f;             // ... unless the extent is this part of the next smallest or less
constexpr float kClear = 0.25f;           // lead over the next axis that decides
constexpr float kPlane = 1e-5f;           // part of the longest extent that is no extent at all

constexpr std::size_t kEnough = 64;  // particles that have a shape
constexpr const char* kNothing = "y: nothing in the particles says otherwise";

/// What speaks for an axis.
struct Evidence {
  float extent = 0;  ///< m
  float low = 0;     ///< part of the columns along the axis that begin at the common lower end
  float high = 0;    ///< part that end at the common upper end
};

Evidence evidence_of(const std::array<const std::vector<float>*, 3>& positions, const Bounds& bounds, int axis) {
  const int b = (axis + 1) % 3, c = (axis + 2) % 3;
  const vec3 extent = bounds.high - bounds.low;
  const auto column = [&](int a, float value) {
    const float t = extent[a] > 0 ? (value - bounds.low[a]) / extent[a] : 0.0f;
    return static_cast<std::size_t>(std::clamp(t * kColumns, 0.0f, kColumns - 1.0f));
  };
  struct Column {
    int count = 0;
    float low = std::numeric_limits<float>::infinity(), high = -std::numeric_limits<float>::infinity();
  };
  const auto& along = *positions[static_cast<std::size_t>(axis)];
  const auto& first = *positions[static_cast<std::size_t>(b)];
  const auto& second = *positions[static_cast<std::size_t>(c)];
  std::array<Column, kColumns * kColumns> columns;
  const std::size_t step = (along.size() + kSample - 1) / kSample;
  for (std::size_t i = 0; i < along.size(); i += step) {
    Column& into = columns[column(b, first[i]) * kColumns + column(c, second[i])];
    ++into.count;
    into.low = std::min(into.low, along[i]);
    into.high = std::max(into.high, along[i]);
  }
  int counted = 0, low = 0, high = 0;
  for (const Column& it : columns) {
    if (it.count < kFewest) continue;
    ++counted;
    low += it.low <= bounds.low[axis] + kSharp * extent[axis];
    high += it.high >= bounds.high[axis] - kSharp * extent[axis];
  }
  const float part = 1.0f / static_cast<float>(std::max(counted, 1));
  return {extent[axis], part * static_cast<float>(low), part * static_cast<float>(high)};
}

/// Particles of a plane: a simulation in two dimensions, whose plane holds the up axis.
UpEstimate up_in_plane(int normal) {
  const Axis axis = normal == 1 ? Axis::z : Axis::y;
  return {axis, fmt::format("{}: the particles lie in a plane that holds it", name_of(axis))};
}

}  // namespace

UpEstimate estimate_up(const Particles& particles) {
  if (particles.up) return {*particles.up, fmt::format("{}: the file says so", name_of(*particles.up))};
  const Bounds bounds = core_bounds(particles);
  const vec3 extents = bounds.extent();
  const float longest = std::max({extents.x, extents.y, extents.z});
  if (particles.size() < kEnough || !(longest > 0)) return {Axis::y, kNothing};
  for (int a = 0; a < 3; ++a) {
    if (!(extents[a] > kPlane * longest)) return up_in_plane(a);
  }

  // Water lies: it stands on a floor, has no ceiling, and is wider than high.
  const std::array<const std::vector<float>*, 3> positions{&particles.x, &particles.y, &particles.z};
  std::array<float, 3> scores{};
  std::array<Evidence, 3> evidence;
  for (int a = 0; a < 3; ++a) evidence[static_cast<std::size_t>(a)] = evidence_of(positions, bounds, a);
  for (std::size_t a = 0; a < 3; ++a) {
    const float others = std::min(evidence[(a + 1) % 3].extent, evidence[(a + 2) % 3].extent);
    const bool lies = evidence[a].low >= kFloor || evidence[a].extent <= kFlat * others;
    scores[a] =
        lies ? std::max(evidence[a].low - evidence[a].high, 0.0f) + std::log(others / evidence[a].extent) : 0.0f;
  }
  const auto best = static_cast<std::size_t>(std::max_element(scores.begin(), scores.end()) - scores.begin());
  const float next = std::max(scores[(best + 1) % 3], scores[(best + 2) % 3]);
  const Axis axis = static_cast<Axis>(best);
  if (scores[best] < kClear || scores[best] - next < kClear) return {Axis::y, kNothing};
  return {axis, fmt::format("{}: the water lies that way ({:.3g} m high, {:.0f} % of it stands on one floor)",
                            name_of(axis), evidence[best].extent, 100 * evidence[best].low)};
}

}  // namespace meniscus
