#include "surface/march.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

#include "surface/march_simd.h"

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr std::size_t kPacketsAtOnce = 16;
/// Samples next to the start, in steps: the ray mostly starts on the surface, and may cross it again very soon.
constexpr float kStart[] = {0.0f, 0.125f, 0.25f, 0.5f, 1.0f};
constexpr int kStarts = static_cast<int>(std::size(kStart));
constexpr float kStretch = 1.0f;  ///< spacings of each ray that one list of neighbours serves
constexpr float kReach = 1.5f;    ///< spacings along each axis between rays that share a list

/// One ray on its way.
struct Lane {
  Ray ray;
  float from = 0, limit = 0;
  float sign = 1;  ///< of rho - iso where the ray has crossed
  MarchCells::Kind settled = MarchCells::outside;
  bool from_cell = false;                   ///< the samples start after settled cells: the side is known
  bool right = false;                       ///< the ray has been on the side where it should be
  float start = 0;                          ///< m: where the samples in a row begin
  int count = 0;                            ///< samples since start
  float at = 0;                             ///< of the next sample
  float end = 0;                            ///< of the stretch that the list serves
  float last = 0, before = 0, earlier = 0;  ///< place of the last sample; values of the last two
  float low_t = 0, low_value = 0, high_t = 0, high_value = 0;  ///< bracket of the crossing

  float place(int n, float step) const {
    if (from_cell) return start + static_cast<float>(n) * step;
    return start + (n < kStarts ? kStart[n] : static_cast<float>(n - kStarts + 2)) * step;
  }
  /// Whether the last three samples are a step apart.
  bool even() const { return count >= (from_cell ? 2 : kStarts + 1); }
  vec3 point(float t) const { return ray.origin + t * ray.direction; }
};

class MarchPacket {
 public:
  MarchPacket(const RaycastField& field, const MarchCells& cells, PacketList& list)
      : field_(field), cells_(cells), list_(list) {}

  /// Distances of the crossings of up to sixteen rays, infinity where there is none.
  void run(std::size_t count, const Ray* rays, const float* from, const float* limit, const std::uint8_t* inside,
           float* distance) {
    active_ = 0;
    distance_ = distance;
    for (std::size_t l = 0; l < count; ++l) {
      distance[l] = kInfinity;
      Lane& lane = lanes_[l];
      lane = Lane{};
      lane.ray = rays[l];
      lane.from = std::max(from[l], 0.0f);
      lane.limit = limit[l];
      lane.sign = inside[l] ? -1.0f : 1.0f;
      lane.settled = inside[l] ? MarchCells::inside : MarchCells::outside;
      if (skip(lane, lane.from)) active_ |= 1u << l;
    }
    while (active_ != 0) {
      const PacketMask group = near_first();
      gather(group);
      walk(group);
    }
  }

 private:
  template <class Visit>
  static void for_each_lane(PacketMask mask, Visit visit) {
    for (; mask != 0; mask &= mask - 1) visit(__builtin_ctz(mask));
  }

  /// Goes on to where the cells do not tell; false if the ray ends before.
  bool skip(Lane& lane, float t) const {
    if (!(t <= lane.limit)) return false;
    const float unsettled = cells_.leave(lane.ray, t, lane.limit, lane.settled);
    if (!(unsettled <= lane.limit && unsettled < kInfinity)) return false;
    lane.from_cell = unsettled > t;
    lane.right = lane.right || lane.from_cell;
    // One step back, so that the crossing is bracketed.
    lane.start = lane.at = lane.from_cell ? std::max(t, unsettled - field_.step) : t;
    lane.count = 0;
    return true;
  }

  /// The active lanes that are near the first of them.
  PacketMask near_first() const {
    const Lane& first = lanes_[__builtin_ctz(active_)];
    const vec3 centre = first.point(first.at);
    const float reach = kReach * field_.options.spacing;
    PacketMask group = 0;
    for_each_lane(active_, [&](int l) {
      const vec3 off = glm::abs(lanes_[l].point(lanes_[l].at) - centre);
      if (std::max({off.x, off.y, off.z}) <= reach) group |= 1u << l;
    });
    return group;
  }

  /// Fills the list for the next stretch of the group's lanes.
  void gather(PacketMask group) {
    Bounds box;
    for_each_lane(group, [&](int l) {
      Lane& lane = lanes_[l];
      lane.end = std::min(lane.at + kStretch * field_.options.spacing, lane.limit);
      box.add(lane.point(std::max(lane.at - 2.0f * field_.step, lane.start)));
      box.add(lane.point(lane.end));
    });
    gather_near(field_, box.low, box.high, list_);
  }

  /// Values are sign (rho - iso): a lane has crossed when its value is not negative.
  void values_at(PacketMask group, const float* t, float* values) {
    const int any = __builtin_ctz(group);
    for (int l = 0; l < kPacket; ++l) {
      const int lane = (group >> l) & 1u ? l : any;
      const vec3 p = lanes_[lane].point(t[lane]);
      points_.x[l] = p.x;
      points_.y[l] = p.y;
      points_.z[l] = p.z;
    }
    density_from(field_, list_, points_, values);
    for_each_lane(group, [&](int l) { values[l] = lanes_[l].sign * (values[l] - field_.options.iso); });
  }

  void walk(PacketMask group) {
    alignas(64) float t[kPacket], values[kPacket];
    PacketMask bracketed = 0;
    for (;;) {
      PacketMask walking = 0;
      for_each_lane(group & active_ & ~bracketed, [&](int l) {
        t[l] = lanes_[l].at;
        if (t[l] <= lanes_[l].end) walking |= 1u << l;
      });
      if (walking == 0) break;
      values_at(walking, t, values);
      PacketMask summits = 0;
      for_each_lane(walking, [&](int l) {
        Lane& lane = lanes_[l];
        if (values[l] >= 0.0f) {
          if (lane.count == 0 && lane.from_cell)
            finish(l, lane.at);
          else if (lane.right) {
            bracket(lane, lane.last, lane.before, lane.at, values[l]);
            bracketed |= 1u << l;
          } else if (lane.at - lane.from >= field_.options.spacing || lane.at >= lane.limit)
            finish(l, lane.from);
        } else if (lane.right && lane.even() && lane.before > lane.earlier && lane.before > values[l]) {
          const Summit found = summit_of(lane.earlier, lane.before, values[l]);
          if (found.value > -kSummitMargin * field_.options.iso) {
            t[l] = lane.last + found.place * field_.step;
            summits |= 1u << l;
          }
        }
      });
      const PacketMask going = walking & active_ & ~bracketed;
      alignas(64) float here[kPacket];
      std::copy_n(values, kPacket, here);
      if (summits != 0) bracketed |= climb(summits, t);
      for_each_lane(going & ~bracketed, [&](int l) { advance(l, here[l]); });
    }
    refine(bracketed);
    for_each_lane(group & active_, [&](int l) {
      Lane& lane = lanes_[l];
      if (lane.right && lane.count > 0 && cells_.at(lane.point(lane.last)) == lane.settled && !skip(lane, lane.last))
        active_ &= ~(1u << l);
    });
  }

  void advance(int l, float value) {
    Lane& lane = lanes_[l];
    lane.right = lane.right || value < 0.0f;
    lane.earlier = lane.before;
    lane.before = value;
    lane.last = lane.at;
    if (lane.at >= lane.limit) {
      active_ &= ~(1u << l);
      return;
    }
    lane.at = std::min(lane.place(++lane.count, field_.step), lane.limit);
  }

  static void bracket(Lane& lane, float low_t, float low_value, float high_t, float high_value) {
    lane.low_t = low_t;
    lane.low_value = low_value;
    lane.high_t = high_t;
    lane.high_value = high_value;
  }

  /// Looks at summits between the last samples; brackets the lanes that have crossed there, and tells which.
  PacketMask climb(PacketMask lanes, const float* summit) {
    alignas(64) float values[kPacket];
    values_at(lanes, summit, values);
    PacketMask crossed = 0;
    for_each_lane(lanes, [&](int l) {
      if (values[l] < 0.0f) return;
      Lane& lane = lanes_[l];
      if (summit[l] > lane.last)
        bracket(lane, lane.last, lane.before, summit[l], values[l]);
      else
        bracket(lane, lane.last - field_.step, lane.earlier, summit[l], values[l]);
      crossed |= 1u << l;
    });
    return crossed;
  }

  /// Where the line through the ends of the bracket is zero.
  static float secant(const Lane& lane) {
    const float rise = lane.high_value - lane.low_value;
    const float part = rise > 0.0f ? -lane.low_value / rise : 0.5f;
    return lane.low_t + std::clamp(part, 0.0f, 1.0f) * (lane.high_t - lane.low_t);
  }

  void refine(PacketMask bracketed) {
    if (bracketed == 0) return;
    alignas(64) float t[kPacket], values[kPacket];
    const bool by_secant = field_.options.refinement == Refinement::secant;
    for (int i = 0; i < field_.options.refinement_steps; ++i) {
      for_each_lane(bracketed, [&](int l) {
        const Lane& lane = lanes_[l];
        t[l] = by_secant ? secant(lane) : 0.5f * (lane.low_t + lane.high_t);
      });
      values_at(bracketed, t, values);
      for_each_lane(bracketed, [&](int l) {
        Lane& lane = lanes_[l];
        (values[l] < 0.0f ? lane.low_t : lane.high_t) = t[l];
        (values[l] < 0.0f ? lane.low_value : lane.high_value) = values[l];
      });
    }
    for_each_lane(bracketed, [&](int l) { finish(l, secant(lanes_[l])); });
  }

  void finish(int l, float distance) {
    distance_[l] = distance;
    active_ &= ~(1u << l);
  }

  const RaycastField& field_;
  const MarchCells& cells_;
  PacketList& list_;
  Lane lanes_[kPacket];
  PacketPoints points_;
  PacketMask active_ = 0;
  float* distance_ = nullptr;
};

/// Normals where the rays of a packet cross.
void find_normals(const RaycastField& field, std::size_t count, const Ray* rays, const std::uint8_t* inside,
                  const float* distance, PacketList& list, Crossing* found) {
  PacketMask mask = 0;
  for (std::size_t l = 0; l < count; ++l) {
    found[l] = {};
    if (distance[l] < kInfinity) mask |= 1u << l;
  }
  if (mask == 0) return;
  PacketPoints points, towards, normals;
  for (std::size_t l = 0; l < kPacket; ++l) {
    const std::size_t lane = (mask >> l) & 1u ? l : static_cast<std::size_t>(__builtin_ctz(mask));
    const vec3 p = rays[lane].origin + distance[lane] * rays[lane].direction;
    const vec3 out = inside[lane] ? rays[lane].direction : -rays[lane].direction;
    points.x[l] = p.x;
    points.y[l] = p.y;
    points.z[l] = p.z;
    towards.x[l] = out.x;
    towards.y[l] = out.y;
    towards.z[l] = out.z;
  }
  normals_packet(field, points, mask, towards, list, normals);
  for (; mask != 0; mask &= mask - 1) {
    const int l = __builtin_ctz(mask);
    found[l] = {distance[l], {normals.x[l], normals.y[l], normals.z[l]}};
  }
}

}  // namespace

void march_crossings(const RaycastField& field, const MarchCells& cells, std::span<const Ray> rays,
                     std::span<const float> from, std::span<const float> limit, std::span<const std::uint8_t> inside,
                     std::span<Crossing> found) {
  if (from.size() != rays.size() || limit.size() != rays.size() || inside.size() != rays.size() ||
      found.size() != rays.size())
    throw Error(ErrorCode::invalid_argument, "the lists of rays to follow have different lengths");
  parallel_for((rays.size() + kPacket - 1) / kPacket, kPacketsAtOnce, [&](std::size_t begin, std::size_t end) {
    thread_local PacketList list;
    MarchPacket march(field, cells, list);
    alignas(64) float distance[kPacket];
    for (std::size_t packet = begin; packet < end; ++packet) {
      const std::size_t i = packet * kPacket, count = std::min<std::size_t>(kPacket, rays.size() - i);
      march.run(count, &rays[i], &from[i], &limit[i], &inside[i], distance);
      find_normals(field, count, &rays[i], &inside[i], distance, list, &found[i]);
    }
  });
}

}  // namespace meniscus
