// Runs of spheres and their boxes, by instruction set.
#include <fmt/format.h>

#include <algorithm>
#include <glm/common.hpp>
#include <limits>

#include "surface/splat.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surface/sphere_groups.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = HWY_CAPPED(float, 16);
using Vec = hn::Vec<Tag>;

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr int kRun = SphereGroups::kRun, kRuns = SphereGroups::kRuns;
/// A run ends where the next sphere is farther along x than this, in its radii: rows of cells of sorted particles do.
constexpr float kJump = 6.0f;
/// Runs of more than two spheres that are longer than this along an axis, in radii of their largest, are cut in two.
constexpr float kLongestRun = 9.0f;
/// A cluster of more than a few runs is no longer than this.
constexpr float kLongestCluster = 24.0f;
constexpr int kFewRuns = 4;

struct Box {
  vec3 low{kInf}, high{-kInf};
  float largest = 0;  ///< radius

  bool is_longer(float radii) const {
    const vec3 extent = high - low;
    return std::max(std::max(extent.x, extent.y), extent.z) > radii * largest;
  }
};

/// The clusters of one piece of the spheres.
class Clustering {
 public:
  Clustering(const Spheres& spheres, std::vector<SphereGroups::Cluster>& clusters)
      : spheres_(spheres), clusters_(clusters) {}

  void run(std::size_t begin, std::size_t end) {
    while (true) {
      begin = first_sphere(begin, end);
      if (begin == end) return;
      const int most = static_cast<int>(std::min<std::size_t>(kRun, end - begin));
      load(begin, most);
      const int count = until_gap(most);
      add(begin, 0, count);
      begin += static_cast<std::size_t>(count);
    }
  }

 private:
  /// Up to sixteen spheres, from the array or where they would end it from copies.
  void load(std::size_t begin, int count) {
    const auto values = [&](std::span<const float> from, float* copy) {
      if (begin + kRun <= from.size()) return from.data() + begin;
      std::copy_n(from.data() + begin, count, copy);
      return static_cast<const float*>(copy);
    };
    x_ = values(spheres_.x, copy_[0]);
    y_ = values(spheres_.y, copy_[1]);
    z_ = values(spheres_.z, copy_[2]);
    if (spheres_.radius.size() == 1) {
      std::fill_n(copy_[3], kRun, spheres_.radius[0]);
      radius_ = copy_[3];
    } else {
      radius_ = values(spheres_.radius, copy_[3]);
    }
  }

  /// The first place from `begin` on whose radius is not zero; those without are many in a row.
  HWY_INLINE std::size_t first_sphere(std::size_t begin, std::size_t end) const {
    const std::span<const float> radius = spheres_.radius;
    if (radius.size() == 1) return radius[0] > 0.0f ? begin : end;
    const Tag d;
    const std::size_t lanes = hn::Lanes(d);
    while (begin + lanes <= end && hn::AllFalse(d, hn::Gt(hn::LoadU(d, radius.data() + begin), hn::Zero(d))))
      begin += lanes;
    while (begin < end && !(radius[begin] > 0.0f)) ++begin;
    return begin;
  }

  int until_gap(int most) const {
    for (int i = 1; i < most; ++i)
      if (!(radius_[i] > 0.0f) || std::abs(x_[i] - x_[i - 1]) > kJump * radius_[i - 1]) return i;
    return most;
  }

  HWY_INLINE Box box_of(int first, int last) const {
    const Tag d;
    const int lanes = static_cast<int>(hn::Lanes(d));
    const Vec inf = hn::Set(d, kInf), minus_inf = hn::Set(d, -kInf);
    Vec low_x = inf, low_y = inf, low_z = inf, high_x = minus_inf, high_y = minus_inf, high_z = minus_inf;
    Vec largest = hn::Zero(d);
    for (int part = 0; part < kRun; part += lanes) {
      const Vec place = hn::Iota(d, static_cast<float>(part)), r = hn::LoadU(d, radius_ + part);
      const auto in = hn::And(hn::And(hn::Ge(place, hn::Set(d, static_cast<float>(first))),
                                      hn::Lt(place, hn::Set(d, static_cast<float>(last)))),
                              hn::Gt(r, hn::Zero(d)));
      const auto grow = [&](const float* from, Vec& low, Vec& high) {
        const Vec centre = hn::LoadU(d, from + part);
        low = hn::IfThenElse(in, hn::Min(low, hn::Sub(centre, r)), low);
        high = hn::IfThenElse(in, hn::Max(high, hn::Add(centre, r)), high);
      };
      grow(x_, low_x, high_x);
      grow(y_, low_y, high_y);
      grow(z_, low_z, high_z);
      largest = hn::Max(largest, hn::IfThenElseZero(in, r));
    }
    const auto least = [&](Vec v) { return hn::GetLane(hn::MinOfLanes(d, v)); };
    const auto most = [&](Vec v) { return hn::GetLane(hn::MaxOfLanes(d, v)); };
    return {{least(low_x), least(low_y), least(low_z)}, {most(high_x), most(high_y), most(high_z)}, most(largest)};
  }

  /// The loaded spheres first .. last (not included), which begin at sphere `begin` of the set.
  void add(std::size_t begin, int first, int last) {
    const Box box = box_of(first, last);
    if (!(box.largest > 0.0f)) return;
    if (last - first > 2 && box.is_longer(kLongestRun)) {
      const int middle = (first + last) / 2;
      add(begin, first, middle);
      add(begin, middle, last);
      return;
    }
    Box both = box;
    if (!clusters_.empty()) {
      SphereGroups::Cluster& cluster = clusters_.back();
      both = {glm::min(cluster.low, box.low), glm::max(cluster.high, box.high), std::max(largest_, box.largest)};
      if (cluster.runs == kRuns || (cluster.runs >= kFewRuns && both.is_longer(kLongestCluster))) {
        start();
        both = box;
      }
    } else {
      start();
    }
    SphereGroups::Cluster& cluster = clusters_.back();
    cluster.low = both.low;
    cluster.high = both.high;
    largest_ = both.largest;
    const vec3 middle = 0.5f * (box.low + box.high), half = 0.5f * (box.high - box.low);
    const int at = cluster.runs++;
    cluster.x[at] = middle.x;
    cluster.y[at] = middle.y;
    cluster.z[at] = middle.z;
    cluster.half_x[at] = half.x;
    cluster.half_y[at] = half.y;
    cluster.half_z[at] = half.z;
    cluster.begin[at] = static_cast<std::uint32_t>(begin + static_cast<std::size_t>(first));
    cluster.count[at] = static_cast<std::uint8_t>(last - first);
  }

  void start() {
    SphereGroups::Cluster& cluster = clusters_.emplace_back();
    for (float* values : {cluster.x, cluster.y, cluster.z}) std::fill_n(values, kRuns, 0.0f);
    for (float* values : {cluster.half_x, cluster.half_y, cluster.half_z}) std::fill_n(values, kRuns, -1.0f);
    std::fill_n(cluster.begin, kRuns, 0u);
    std::fill_n(cluster.count, kRuns, std::uint8_t{0});
    cluster.runs = 0;
  }

  const Spheres& spheres_;
  std::vector<SphereGroups::Cluster>& clusters_;
  float largest_ = 0;  ///< radius in the last cluster
  const float *x_ = nullptr, *y_ = nullptr, *z_ = nullptr, *radius_ = nullptr;
  float copy_[4][kRun] = {};
};

}  // namespace

void MakeClusters(const Spheres& spheres, std::size_t begin, std::size_t end,
                  std::vector<SphereGroups::Cluster>& clusters) {
  Clustering(spheres, clusters).run(begin, end);
}

}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace meniscus {

HWY_EXPORT(MakeClusters);

SphereGroups::SphereGroups(const Spheres& spheres) {
  constexpr std::size_t kPiece = 1 << 14;
  const std::size_t count = spheres.x.size();
  if (count > std::numeric_limits<std::uint32_t>::max())
    throw Error(ErrorCode::limit_exceeded, fmt::format("{} spheres are more than 2^32", count));
  pieces_.resize((count + kPiece - 1) / kPiece);
  parallel_for(pieces_.size(), 1, [&](std::size_t piece, std::size_t) {
    pieces_[piece].reserve(kPiece / kRun / kRuns * 3 / 2);
    HWY_DYNAMIC_DISPATCH(MakeClusters)
    (spheres, piece * kPiece, std::min(count, (piece + 1) * kPiece), pieces_[piece]);
  });
}

std::size_t SphereGroups::clusters() const {
  std::size_t count = 0;
  for (const auto& piece : pieces_) count += piece.size();
  return count;
}

std::uint64_t SphereGroups::memory_bytes() const {
  std::uint64_t bytes = pieces_.capacity() * sizeof(pieces_[0]);
  for (const auto& piece : pieces_) bytes += piece.capacity() * sizeof(Cluster);
  return bytes;
}

}  // namespace meniscus
#endif
