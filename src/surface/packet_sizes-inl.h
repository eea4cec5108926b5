// Lists of particles that have sizes of their own; included once for each instruction set, after highway.h.

#if defined(MENISCUS_SURFACE_PACKET_SIZES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MENISCUS_SURFACE_PACKET_SIZES_INL_H_
#undef MENISCUS_SURFACE_PACKET_SIZES_INL_H_
#else
#define MENISCUS_SURFACE_PACKET_SIZES_INL_H_
#endif

#include <hwy/highway.h>

#include "base/packing-inl.h"
#include "surface/packet.h"

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = HWY_CAPPED(float, kPacket);
using Vec = hn::Vec<Tag>;

/// What a particle's reach is proportional to.
enum class Reach { smoothing_length, spacing, neither };

/// Adds the particles of one level that reach into the box: `reach` is that of the level's largest particle, m; each
/// one's own is its share of that, plus `margin`.
HWY_INLINE void gather_level(const RaycastField& all, const RaycastField& level, vec3 low, vec3 high, float reach,
                             Reach by, float margin, bool colours, PacketList& list) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  const auto& grid = level.grid;
  const Vec low_x = hn::Set(d, low.x), low_y = hn::Set(d, low.y), low_z = hn::Set(d, low.z);
  const Vec high_x = hn::Set(d, high.x), high_y = hn::Set(d, high.y), high_z = hn::Set(d, high.z);
  const Vec largest = hn::Set(d, reach), more = hn::Set(d, margin), zero = hn::Zero(d);
  const Vec per_h = hn::Set(d, 1.0f / level.options.smoothing_length),
            per_radius = hn::Set(d, 1.0f / level.options.normal_radius), scale = hn::Set(d, level.scale / all.scale);
  const auto outside = [&](Vec v, Vec from, Vec to) {
    return hn::Max(hn::Max(hn::Sub(from, v), hn::Sub(v, to)), zero);
  };
  grid.for_each_run(low - (reach + margin), high + (reach + margin), [&](std::size_t begin, std::size_t end) {
    const std::size_t room = list.count + (end - begin) + 2 * kPacket;
    list.reserve(room, colours);
    list.per_smoothing.reserve(room, list.count);
    list.per_normal_radius.reserve(room, list.count);
    for (std::size_t i = begin; i < end; i += lanes) {
      const Vec x = hn::LoadU(d, grid.x() + i), y = hn::LoadU(d, grid.y() + i), z = hn::LoadU(d, grid.z() + i);
      const Vec off_x = outside(x, low_x, high_x), off_y = outside(y, low_y, high_y), off_z = outside(z, low_z, high_z);
      const Vec off2 = hn::MulAdd(off_x, off_x, hn::MulAdd(off_y, off_y, hn::Mul(off_z, off_z)));
      const Vec spacings = hn::LoadU(d, level.per_spacing.data() + i),
                lengths = hn::LoadU(d, level.per_smoothing.data() + i);
      const Vec own = hn::Add(hn::Div(largest, by == Reach::spacing   ? spacings
                                               : by == Reach::neither ? hn::Set(d, 1.0f)
                                                                      : lengths),
                              more);
      // Lanes past the run's end belong to other cells, which may be part of the box and come again.
      const auto near = hn::And(hn::Lt(off2, hn::Mul(own, own)), hn::FirstN(d, end - i));
      const std::size_t found = hn::CountTrue(d, near);
      if (found == 0) continue;
      const Packing packed(d, near);
      const auto keep = [&](Vec values, const AlignedFloats& to) {
        hn::StoreU(packed(values), d, to.data() + list.count);
      };
      // s_j^3 W(0, h_j) is that of the largest times this ratio cubed.
      const Vec ratio = hn::Div(lengths, spacings);
      const Vec factor = hn::Mul(hn::Mul(ratio, ratio), hn::Mul(ratio, scale));
      keep(x, list.x);
      keep(y, list.y);
      keep(z, list.z);
      keep(hn::Mul(hn::LoadU(d, level.mass.data() + i), factor), list.mass);
      keep(hn::Mul(lengths, per_h), list.per_smoothing);
      keep(hn::Mul(spacings, per_radius), list.per_normal_radius);
      if (colours) {
        keep(hn::LoadU(d, level.red.data() + i), list.red);
        keep(hn::LoadU(d, level.green.data() + i), list.green);
        keep(hn::LoadU(d, level.blue.data() + i), list.blue);
      }
      list.count += found;
    }
  });
}

/// Fills the list with the particles of all levels that reach into the box, level by level in their sorted order.
/// @param radius  m: the field's normal radius for lists that serve normals; else its smoothing length, or some more
HWY_MAYBE_UNUSED HWY_NOINLINE void gather_sizes(const RaycastField& field, vec3 low, vec3 high, float radius,
                                                bool colours, PacketList& list) {
  list.count = 0;
  list.near_full = false;  // all particles of such fields are kept
  const float length = field.options.smoothing_length, normals = field.options.normal_radius;
  const auto gather = [&](const RaycastField& level) {
    const RaycastOptions& of = level.options;
    if (radius == normals && radius == length)  // it serves either
      gather_level(field, level, low, high, std::max(of.normal_radius, of.smoothing_length), Reach::neither, 0.0f,
                   colours, list);
    else if (radius == normals)
      gather_level(field, level, low, high, of.normal_radius, Reach::spacing, 0.0f, colours, list);
    else
      gather_level(field, level, low, high, of.smoothing_length, Reach::smoothing_length,
                   std::max(radius - length, 0.0f), colours, list);
  };
  gather(field);
  for (const RaycastField& level : field.coarser) gather(level);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#endif
