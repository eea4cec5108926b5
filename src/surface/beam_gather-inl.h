// What is gathered for a beam and for parts of it; included once for each instruction set, after highway.h.

#if defined(MENISCUS_SURFACE_BEAM_GATHER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MENISCUS_SURFACE_BEAM_GATHER_INL_H_
#undef MENISCUS_SURFACE_BEAM_GATHER_INL_H_
#else
#define MENISCUS_SURFACE_BEAM_GATHER_INL_H_
#endif

#include <hwy/highway.h>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "base/packing-inl.h"
#include "surface/beam_rays-inl.h"
#include "surface/packet_sizes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

/// Row of cells along x by row of a block: y and z.
struct RowPlaces {
  alignas(64) float y[BandGrid::kSide * BandGrid::kSide];
  alignas(64) float z[BandGrid::kSide * BandGrid::kSide];
};
constexpr RowPlaces make_row_places() {
  RowPlaces places{};
  for (int row = 0; row < BandGrid::kSide * BandGrid::kSide; ++row) {
    places.y[row] = static_cast<float>(row % BandGrid::kSide);
    places.z[row] = static_cast<float>(row / BandGrid::kSide);
  }
  return places;
}
constexpr RowPlaces kRowPlaces = make_row_places();

/// Calls visit(begin, end) for the runs of kept particles whose cells may touch the capsule: of each row of cells along
/// x those beside the part of its axis that comes near the row. Rows of a block are looked at many at once.
template <class Visit>
HWY_INLINE void for_each_run_along(const BandGrid& grid, const Capsule& capsule, Visit visit) {
  constexpr int kSide = BandGrid::kSide;
  constexpr float kHalfRow = 0.7072f;  // cells from the middle of a row to its edges
  const Tag d;
  const hn::Rebind<std::int32_t, Tag> di;
  const int lanes = static_cast<int>(hn::Lanes(d));
  // All in cells.
  const float per_cell = 1.0f / grid.cell_size(), radius = capsule.radius * per_cell + 1e-3f;
  const vec3 from = (capsule.from - grid.origin()) * per_cell, to = (capsule.to - grid.origin()) * per_cell;
  const glm::ivec3 blocks{grid.blocks_x(), grid.blocks_y(), grid.blocks_z()};
  const vec3 least = (glm::min(from, to) - radius) * (1.0f / kSide),
             most = (glm::max(from, to) + radius) * (1.0f / kSide);
  const vec3 end(blocks);
  if (!(least.x < end.x && least.y < end.y && least.z < end.z && most.x >= 0 && most.y >= 0 && most.z >= 0)) return;
  const glm::ivec3 first(glm::max(least, 0.0f)), last(glm::min(most, end - 1.0f));
  const vec3 along = to - from;
  const float across2 = along.y * along.y + along.z * along.z;
  const float per_across2 = across2 > 1e-12f ? 1.0f / across2 : 0.0f;
  const float per_across = across2 > 1e-12f ? std::sqrt(per_across2) : 1e6f;
  const Vec zero = hn::Zero(d), one = hn::Set(d, 1.0f), radius2 = hn::Set(d, radius * radius),
            reach2 = hn::Set(d, (radius + kHalfRow) * (radius + kHalfRow)), half_row = hn::Set(d, kHalfRow),
            rise_x = hn::Set(d, along.x), rise_y = hn::Set(d, along.y), rise_z = hn::Set(d, along.z);
  const Vec last_cell = hn::Set(d, static_cast<float>(kSide) - 0.5f), cells = hn::Set(d, static_cast<float>(kSide));
  alignas(64) std::int32_t low_cell[kPacket], high_cell[kPacket];
  for (int bz = first.z; bz <= last.z; ++bz)
    for (int by = first.y; by <= last.y; ++by)
      for (int bx = first.x; bx <= last.x; ++bx) {
        const int block = grid.find(bx, by, bz);
        if (block < 0) continue;
        const vec3 origin = from - static_cast<float>(kSide) * vec3(bx, by, bz);  // the axis' start, from the block
        for (int row = 0; row < kSide * kSide; row += lanes) {
          const Vec y = hn::Load(d, kRowPlaces.y + row), z = hn::Load(d, kRowPlaces.z + row);
          // The part s of the axis nearest to the middle of the row, seen along x, and what comes within reach.
          const Vec off_y = hn::Sub(y, hn::Set(d, origin.y - 0.5f)), off_z = hn::Sub(z, hn::Set(d, origin.z - 0.5f));
          const Vec foot = hn::Mul(hn::MulAdd(off_y, rise_y, hn::Mul(off_z, rise_z)), hn::Set(d, per_across2));
          const Vec s = hn::Min(hn::Max(foot, zero), one);
          const Vec apart_y = hn::NegMulAdd(s, rise_y, off_y), apart_z = hn::NegMulAdd(s, rise_z, off_z);
          const Vec apart2 = hn::MulAdd(apart_y, apart_y, hn::Mul(apart_z, apart_z));
          auto near = hn::Lt(apart2, reach2);
          if (hn::AllFalse(d, near)) continue;
          const Vec share = hn::Mul(hn::Sqrt(hn::Max(hn::Sub(reach2, apart2), zero)), hn::Set(d, per_across));
          const Vec x0 = hn::MulAdd(hn::Max(hn::Sub(s, share), zero), rise_x, hn::Set(d, origin.x)),
                    x1 = hn::MulAdd(hn::Min(hn::Add(s, share), one), rise_x, hn::Set(d, origin.x));
          const Vec beside = hn::Max(hn::Sub(hn::Sqrt(apart2), half_row), zero);
          const Vec reach_x = hn::Sqrt(hn::Max(hn::NegMulAdd(beside, beside, radius2), zero));
          const Vec low = hn::Sub(hn::Min(x0, x1), reach_x), high = hn::Add(hn::Max(x0, x1), reach_x);
          near = hn::And(near, hn::And(hn::Lt(low, cells), hn::Ge(high, zero)));
          hn::Store(hn::ConvertTo(di, hn::Max(low, zero)), di, low_cell);
          hn::Store(hn::ConvertTo(di, hn::Min(high, last_cell)), di, high_cell);
          for_each_lane(bits_of(near), [&](int l) {
            const int cell = (row + l) * kSide;
            const BandGrid::Run run = grid.run(block, cell + low_cell[l], cell + high_cell[l]);
            if (run.begin < run.end) visit(run.begin, run.end);
          });
        }
      }
}

/// Squared distances from a capsule's axis.
class FromAxis {
 public:
  explicit FromAxis(const Capsule& capsule) : from_(capsule.from), along_(capsule.to - capsule.from) {
    const float length2 = glm::dot(along_, along_);
    per_length2_ = length2 > 0.0f ? 1.0f / length2 : 0.0f;
  }
  HWY_INLINE Vec distance2(Vec x, Vec y, Vec z) const {
    const Tag d;
    const Vec along_x = hn::Set(d, along_.x), along_y = hn::Set(d, along_.y), along_z = hn::Set(d, along_.z);
    const Vec off_x = hn::Sub(x, hn::Set(d, from_.x)), off_y = hn::Sub(y, hn::Set(d, from_.y)),
              off_z = hn::Sub(z, hn::Set(d, from_.z));
    const Vec part = hn::Mul(hn::MulAdd(off_x, along_x, hn::MulAdd(off_y, along_y, hn::Mul(off_z, along_z))),
                             hn::Set(d, per_length2_));
    const Vec at = hn::Min(hn::Max(part, hn::Zero(d)), hn::Set(d, 1.0f));
    const Vec across_x = hn::NegMulAdd(at, along_x, off_x), across_y = hn::NegMulAdd(at, along_y, off_y),
              across_z = hn::NegMulAdd(at, along_z, off_z);
    return hn::MulAdd(across_x, across_x, hn::MulAdd(across_y, across_y, hn::Mul(across_z, across_z)));
  }

 private:
  vec3 from_, along_;
  float per_length2_;
};

/// Whether particles may be missing near the stretch that a capsule was put around.
HWY_INLINE bool near_full(const BandGrid& grid, const Capsule& capsule, float reach) {
  const float apart = capsule.radius - reach;
  return grid.touches_full(glm::min(capsule.from, capsule.to) - apart, glm::max(capsule.from, capsule.to) + apart);
}

/// Whole vectors are read: what is beyond the end lies far away and has no mass.
HWY_INLINE void end_list(PacketList& list, bool sizes) {
  const Tag d;
  list.reserve(list.count + 2 * kPacket, false);
  hn::StoreU(hn::Set(d, 1e18f), d, list.x.data() + list.count);
  for (const AlignedFloats* values : {&list.y, &list.z, &list.mass})
    hn::StoreU(hn::Zero(d), d, values->data() + list.count);
  if (!sizes) return;
  list.per_smoothing.reserve(list.count + 2 * kPacket, list.count);
  hn::StoreU(hn::Set(d, 1.0f), d, list.per_smoothing.data() + list.count);
}

/// Fills the list with the particles in the capsule.
/// @param reach  m: smoothing length, or some more, of the capsule's radius
HWY_NOINLINE void gather_capsule(const RaycastField& field, const Capsule& capsule, float reach, PacketList& list) {
  if (HWY_UNLIKELY(field.has_sizes())) {
    const float apart = capsule.radius - reach;
    gather_sizes(field, glm::min(capsule.from, capsule.to) - apart, glm::max(capsule.from, capsule.to) + apart, reach,
                 false, list);
    return end_list(list, true);
  }
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  const BandGrid& grid = field.grid;
  const FromAxis axis(capsule);
  const Vec radius2 = hn::Set(d, capsule.radius * capsule.radius);
  list.count = 0;
  list.near_full = near_full(grid, capsule, reach);
  const auto take = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; i += lanes) {
      const Vec x = hn::LoadU(d, grid.x() + i), y = hn::LoadU(d, grid.y() + i), z = hn::LoadU(d, grid.z() + i);
      // Lanes past the run's end belong to other cells, which may be part of the box and come again.
      const auto near = hn::And(hn::Lt(axis.distance2(x, y, z), radius2), hn::FirstN(d, end - i));
      if (hn::AllFalse(d, near)) continue;
      const Packing packed(d, near);
      const auto keep = [&](Vec values, const AlignedFloats& to) {
        hn::StoreU(packed(values), d, to.data() + list.count);
      };
      keep(x, list.x);
      keep(y, list.y);
      keep(z, list.z);
      keep(hn::LoadU(d, field.mass.data() + i), list.mass);
      list.count += hn::CountTrue(d, near);
    }
  };
  // Runs are far apart in memory: many are asked for before the first is looked at.
  constexpr int kAtOnce = 64;
  BandGrid::Run runs[kAtOnce];
  int count = 0;
  std::size_t particles = 0;
  const auto take_all = [&] {
    list.reserve(list.count + particles + 2 * kPacket, false);
    for (int r = 0; r < count; ++r) take(runs[r].begin, runs[r].end);
    count = 0;
    particles = 0;
  };
  for_each_run_along(grid, capsule, [&](std::size_t begin, std::size_t end) {
    for (const float* values : {grid.x(), grid.y(), grid.z(), field.mass.data()}) {
      __builtin_prefetch(values + begin);
      __builtin_prefetch(values + end - 1);
    }
    runs[count++] = {begin, end};
    particles += end - begin;
    if (count == kAtOnce) take_all();
  });
  take_all();
  end_list(list, false);
}

/// Fills a list with those of another that lie in the capsule, in the same order.
/// @param reach  m, of the capsule's radius; particles with sizes reach as far as they do instead
template <bool kSizes>
HWY_NOINLINE void narrow_list(const RaycastField& field, const PacketList& all, const Capsule& capsule, float reach,
                              PacketList& list) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  const FromAxis axis(capsule);
  const Vec apart = hn::Set(d, capsule.radius - reach);
  Vec radius2 = hn::Set(d, capsule.radius * capsule.radius);
  list.count = 0;
  list.near_full = all.near_full && near_full(field.grid, capsule, reach);
  list.reserve(all.count + 2 * kPacket, false);
  if constexpr (kSizes) list.per_smoothing.reserve(all.count + 2 * kPacket, 0);
  for (std::size_t j = 0; j < all.count; j += lanes) {
    const Vec x = hn::Load(d, all.x.data() + j), y = hn::Load(d, all.y.data() + j), z = hn::Load(d, all.z.data() + j);
    if constexpr (kSizes) {
      const Vec own = hn::Add(hn::Div(hn::Set(d, 1.0f), hn::Load(d, all.per_smoothing.data() + j)), apart);
      radius2 = hn::Mul(own, own);
    }
    auto near = hn::Lt(axis.distance2(x, y, z), radius2);
    if constexpr (kSizes) near = hn::And(near, hn::FirstN(d, all.count - j));
    if (hn::AllFalse(d, near)) continue;
    const Packing packed(d, near);
    const auto keep = [&](Vec values, const AlignedFloats& to) {
      hn::StoreU(packed(values), d, to.data() + list.count);
    };
    keep(x, list.x);
    keep(y, list.y);
    keep(z, list.z);
    keep(hn::Load(d, all.mass.data() + j), list.mass);
    if constexpr (kSizes) keep(hn::Load(d, all.per_smoothing.data() + j), list.per_smoothing);
    list.count += hn::CountTrue(d, near);
  }
  end_list(list, kSizes);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#endif
