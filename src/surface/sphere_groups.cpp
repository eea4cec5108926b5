#include <fmt/format.h>

#include <algorithm>
#include <glm/common.hpp>

#include "surface/splat.h"

namespace meniscus {
namespace {

/// Spheres in a group: more cost less to sort by tiles, fewer are rejected more sharply.
constexpr std::size_t kPart = 16, kGroup = 64, kFewest = 2;
/// Groups longer than this along an axis, in radii of the largest of their spheres, are cut in two: consecutive spheres
/// of sorted particles are far from each other where a row of cells ends.
constexpr float kLongest = 12.0f;

float radius_of(const Spheres& spheres, std::size_t i) {
  return spheres.radius.size() == 1 ? spheres.radius[0] : spheres.radius[i];
}

struct Part {
  vec3 low{std::numeric_limits<float>::infinity()}, high{-std::numeric_limits<float>::infinity()};
  float largest = 0;  ///< radius

  bool is_long() const {
    const vec3 extent = high - low;
    return std::max(std::max(extent.x, extent.y), extent.z) > kLongest * largest;
  }
};

Part part_of(const Spheres& spheres, std::size_t begin, std::size_t end) {
  Part part;
  for (std::size_t i = begin; i < end; ++i) {
    const float r = radius_of(spheres, i);
    if (!(r > 0.0f)) continue;
    const vec3 centre{spheres.x[i], spheres.y[i], spheres.z[i]};
    part.low = glm::min(part.low, centre - r);
    part.high = glm::max(part.high, centre + r);
    part.largest = std::max(part.largest, r);
  }
  return part;
}

/// The groups of one piece of the spheres.
class Grouping {
 public:
  Grouping(const Spheres& spheres, std::vector<SphereGroups::Group>& groups) : spheres_(spheres), groups_(groups) {}

  void add(std::size_t begin, std::size_t end) {
    const Part part = part_of(spheres_, begin, end);
    if (!(part.largest > 0.0f)) return;
    if (part.is_long() && end - begin > kFewest) {
      add(begin, (begin + end) / 2);
      add((begin + end) / 2, end);
      return;
    }
    const auto first = static_cast<std::uint32_t>(begin), last = static_cast<std::uint32_t>(end);
    if (!groups_.empty() && groups_.back().end == first && last - groups_.back().begin <= kGroup) {
      const Part both{glm::min(groups_.back().low, part.low), glm::max(groups_.back().high, part.high),
                      std::max(largest_, part.largest)};
      if (!both.is_long()) {
        groups_.back() = {both.low, both.high, groups_.back().begin, last};
        largest_ = both.largest;
        return;
      }
    }
    groups_.push_back({part.low, part.high, first, last});
    largest_ = part.largest;
  }

 private:
  const Spheres& spheres_;
  std::vector<SphereGroups::Group>& groups_;
  float largest_ = 0;  ///< radius in the last group
};

}  // namespace

SphereGroups::SphereGroups(const Spheres& spheres) {
  constexpr std::size_t kPiece = 1 << 15;
  const std::size_t count = spheres.x.size();
  if (count > std::numeric_limits<std::uint32_t>::max())
    throw Error(ErrorCode::limit_exceeded, fmt::format("{} spheres are more than 2^32", count));
  std::vector<std::vector<Group>> pieces((count + kPiece - 1) / kPiece);
  parallel_for(pieces.size(), 1, [&](std::size_t piece, std::size_t) {
    Grouping grouping(spheres, pieces[piece]);
    const std::size_t end = std::min(count, (piece + 1) * kPiece);
    for (std::size_t at = piece * kPiece; at < end; at += kPart) grouping.add(at, std::min(at + kPart, end));
  });
  std::size_t total = 0;
  for (const auto& piece : pieces) total += piece.size();
  groups_.reserve(total);
  for (const auto& piece : pieces) groups_.insert(groups_.end(), piece.begin(), piece.end());
}

}  // namespace meniscus
