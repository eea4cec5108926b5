// The march of a few rays over the columns of a height field; included once for each instruction set, after highway.h.

#if defined(MENISCUS_SURFACE_HEIGHT_FIELD_MARCH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MENISCUS_SURFACE_HEIGHT_FIELD_MARCH_INL_H_
#undef MENISCUS_SURFACE_HEIGHT_FIELD_MARCH_INL_H_
#else
#define MENISCUS_SURFACE_HEIGHT_FIELD_MARCH_INL_H_
#endif

#include <hwy/highway.h>

#include "surface/height_field_packet.h"

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = HWY_CAPPED(float, kPacket);
using IntTag = hn::RebindToSigned<Tag>;
using Vec = hn::Vec<Tag>;
using Int = hn::Vec<IntTag>;
using Mask = hn::Mask<Tag>;

/// As many rays as there are lanes, in the columns' coordinates, s in m from where they come into the box.
struct BoxRays {
  Vec a, b, z;     ///< at s = 0
  Vec da, db, dz;  ///< per m
  Vec span;        ///< m within the box
};

/// c + b s + a s^2 in floats.
struct Quadratics {
  Vec a, b, c;

  /// The first s >= 0 where the value is not positive; large where there is none.
  HWY_INLINE Vec first_not_positive() const {
    const Tag d;
    const Vec zero = hn::Zero(d), none = hn::Set(d, 1e30f);
    const Vec discriminant = hn::NegMulAdd(hn::Mul(hn::Set(d, 4.0f), a), c, hn::Mul(b, b));
    const Vec root = hn::Sqrt(hn::Max(discriminant, zero));
    // Of the two forms of a root the one without cancellation; c > 0 here.
    const Mask falls = hn::Lt(b, zero);
    const Vec over = hn::IfThenElse(falls, hn::Add(c, c), hn::Add(b, root));
    const Vec under = hn::IfThenElse(falls, hn::Sub(root, b), hn::Mul(hn::Set(d, -2.0f), a));
    const Mask has = hn::And(hn::Ge(discriminant, zero), hn::Gt(under, zero));
    const Vec s = hn::IfThenElse(has, hn::Div(over, under), none);
    return hn::IfThenElse(hn::Le(c, zero), zero, s);
  }
};

/// The heights around cells, and the bilinear patches through them.
struct Patches {
  Vec h00, by_u, by_v, by_uv;

  HWY_INLINE Patches(const float* heights, int width, Int i, Int j) {
    const Tag d;
    const IntTag di;
    const Int p = hn::Add(hn::Mul(j, hn::Set(di, width)), i);
    h00 = hn::GatherIndex(d, heights, p);
    const Vec h10 = hn::GatherIndex(d, heights + 1, p), h01 = hn::GatherIndex(d, heights + width, p),
              h11 = hn::GatherIndex(d, heights + width + 1, p);
    by_u = hn::Sub(h10, h00);
    by_v = hn::Sub(h01, h00);
    by_uv = hn::Sub(hn::Sub(h11, h10), by_v);
  }
  /// Height of the rays over the patch of cell (i, j), from s on.
  HWY_INLINE Quadratics above(const BoxRays& rays, Int i, Int j, Vec s) const {
    const Tag d;
    const Vec u = hn::Sub(hn::MulAdd(s, rays.da, rays.a), hn::ConvertTo(d, i)),
              v = hn::Sub(hn::MulAdd(s, rays.db, rays.b), hn::ConvertTo(d, j));
    const Vec slope_u = hn::MulAdd(by_uv, v, by_u), slope_v = hn::MulAdd(by_uv, u, by_v);
    return {hn::Neg(hn::Mul(hn::Mul(by_uv, rays.da), rays.db)),
            hn::NegMulAdd(slope_u, rays.da, hn::NegMulAdd(slope_v, rays.db, rays.dz)),
            hn::Sub(hn::MulAdd(s, rays.dz, rays.z), hn::MulAdd(slope_u, u, hn::MulAdd(by_v, v, h00)))};
  }
};

/// Where the rays of a march stand: cells (i, j) and s.
struct Places {
  Vec s;
  Int i, j;
};

/// Goes along the rays as HeightFieldBody::traverse() does, with one level of the pyramid for all of them.
///
/// policy.passes(low, high, s, to, blocks) tells which lanes need not look into blocks, of which it gathers what it
/// wants; policy.visit(places, to, lanes) looks into cells and returns the lanes that are done.
/// @return lanes that were given up
template <class Policy>
HWY_INLINE Mask march(const HeightFieldBody& body, const BoxRays& rays, Places& at, Mask active, Policy& policy) {
  const Tag d;
  const IntTag di;
  const Vec zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  const Int none = hn::Zero(di), next = hn::Set(di, 1);
  const Int cells_a = hn::Set(di, body.cells_a()), cells_b = hn::Set(di, body.cells_b());
  const Int last_a = hn::Sub(cells_a, next), last_b = hn::Sub(cells_b, next);
  const Mask forward_a = hn::Gt(rays.da, zero), forward_b = hn::Gt(rays.db, zero);
  const auto forward_ia = hn::RebindMask(di, forward_a), forward_ib = hn::RebindMask(di, forward_b);
  const Vec per_da = hn::Div(one, rays.da), per_db = hn::Div(one, rays.db);
  const Vec never = hn::Set(d, 1e30f);
  const Mask still_a = hn::Lt(hn::Abs(rays.da), hn::Set(d, 1e-25f)),
             still_b = hn::Lt(hn::Abs(rays.db), hn::Set(d, 1e-25f));
  const int top_level = static_cast<int>(body.levels().size()) - 1;
  int level = std::min(policy.first_level, top_level);
  // More steps than any ray needs: what is not done then is given up.
  const int most = 64 + 8 * (body.cells_a() + body.cells_b() + 2);
  for (int step = 0; step < most && !hn::AllFalse(d, active); ++step) {
    const HeightFieldBody::Level& of = body.levels()[static_cast<std::size_t>(level)];
    const Int size = hn::Set(di, 1 << level), rest = hn::Set(di, (1 << level) - 1);
    const Int a0 = hn::AndNot(rest, at.i), b0 = hn::AndNot(rest, at.j);
    const Int a1 = hn::Min(hn::Add(a0, size), cells_a), b1 = hn::Min(hn::Add(b0, size), cells_b);
    const Int edge_a = hn::IfThenElse(forward_ia, a1, a0), edge_b = hn::IfThenElse(forward_ib, b1, b0);
    const Vec to_a = hn::IfThenElse(still_a, never, hn::Mul(hn::Sub(hn::ConvertTo(d, edge_a), rays.a), per_da));
    const Vec to_b = hn::IfThenElse(still_b, never, hn::Mul(hn::Sub(hn::ConvertTo(d, edge_b), rays.b), per_db));
    const Vec to = hn::Max(at.s, hn::Min(hn::Min(to_a, to_b), rays.span));
    const Vec z0 = hn::MulAdd(at.s, rays.dz, rays.z), z1 = hn::MulAdd(to, rays.dz, rays.z);
    const Int block =
        hn::Add(hn::Mul(hn::ShiftRightSame(at.j, level), hn::Set(di, of.width)), hn::ShiftRightSame(at.i, level));
    const Mask passing =
        policy.passes(&of.blocks[0].low, hn::Add(block, block), hn::Min(z0, z1), hn::Max(z0, z1), at.s, to, active);
    Mask moving = hn::And(active, passing);
    const Mask kept = hn::AndNot(passing, active);
    Mask waiting = hn::AndNot(moving, moving);
    const bool all_pass = hn::AllFalse(d, kept);
    const int looked_at = level;
    if (!all_pass && level > 0) {
      --level;
      if (hn::AllFalse(d, moving)) continue;
      waiting = kept;
    } else if (!all_pass) {
      moving = hn::AndNot(policy.visit(at, to, kept), active);
    }
    // Across the nearer side into the next cell: counted, not computed, so that no cell is left out or met twice.
    const Mask across_a = hn::Le(to_a, to_b);
    const auto across = hn::RebindMask(di, across_a);
    const Int place_a = hn::ConvertTo(di, hn::Max(hn::MulAdd(to, rays.da, rays.a), zero)),
              place_b = hn::ConvertTo(di, hn::Max(hn::MulAdd(to, rays.db, rays.b), zero));
    const Int i = hn::IfThenElse(across, hn::IfThenElse(forward_ia, a1, hn::Sub(a0, next)),
                                 hn::Min(hn::Max(place_a, a0), hn::Sub(a1, next)));
    const Int j = hn::IfThenElse(across, hn::Min(hn::Max(place_b, b0), hn::Sub(b1, next)),
                                 hn::IfThenElse(forward_ib, b1, hn::Sub(b0, next)));
    const Int in_i = hn::Min(hn::Max(i, none), last_a), in_j = hn::Min(hn::Max(j, none), last_b);
    const auto within = hn::And(hn::Eq(in_i, i), hn::Eq(in_j, j));
    const Mask goes_on = hn::And(hn::Lt(to, rays.span), hn::RebindMask(d, within));
    active = hn::Or(waiting, hn::And(moving, goes_on));
    const auto moved = hn::RebindMask(di, moving);
    if (all_pass && level < top_level) {
      // Larger blocks only where one is left: within one that could not be skipped there is something near.
      const Int changed = hn::Or(hn::Xor(in_i, at.i), hn::Xor(in_j, at.j));
      if (!hn::AllFalse(d,
                        hn::And(active, hn::RebindMask(d, hn::Gt(hn::ShiftRightSame(changed, looked_at + 1), none)))))
        ++level;
    }
    at.i = hn::IfThenElse(moved, in_i, at.i);
    at.j = hn::IfThenElse(moved, in_j, at.j);
    at.s = hn::IfThenElse(moving, to, at.s);
  }
  return active;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#endif
