// What a march over the columns of a height field does in the cells; included once for each instruction set, after
// highway.h.

#if defined(MENISCUS_SURFACE_HEIGHT_FIELD_CELLS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MENISCUS_SURFACE_HEIGHT_FIELD_CELLS_INL_H_
#undef MENISCUS_SURFACE_HEIGHT_FIELD_CELLS_INL_H_
#else
#define MENISCUS_SURFACE_HEIGHT_FIELD_CELLS_INL_H_
#endif

#include <hwy/highway.h>

#include "surface/height_field_march-inl.h"

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

/// Those of the lanes whose cells are water in part only.
HWY_INLINE Mask in_cut_cells(const HeightFieldBody& body, const Places& at, Mask lanes) {
  const Tag d;
  if (!body.has_holes()) return hn::AndNot(lanes, lanes);
  const HeightFieldBody::Level& cells = body.levels()[0];
  const Int cell = hn::Add(hn::Mul(at.j, hn::Set(IntTag(), cells.width)), at.i);
  const Vec low = hn::GatherIndex(d, &cells.blocks[0].low, hn::Add(cell, cell));
  return hn::And(lanes, hn::Lt(low, hn::Set(d, -3e38f)));
}

/// The first place in the water.
struct Enter {
  static constexpr int first_level = 3;  ///< of the pyramid: water is mostly met soon
  const HeightFieldBody& body;
  const BoxRays& rays;
  Vec met;  ///< s of the crossing
  Mask hits, unsettled;

  HWY_INLINE Mask passes(const float* blocks, Int index, Vec low, Vec, Vec, Vec, Mask) {
    return hn::Gt(low, hn::GatherIndex(Tag(), blocks + 1, index));
  }
  HWY_INLINE Mask visit(const Places& at, Vec to, Mask lanes) {
    const Patches patches(body.heights().data(), body.cells_a() + 1, at.i, at.j);
    const Vec root = patches.above(rays, at.i, at.j, at.s).first_not_positive();
    const Mask found = hn::And(lanes, hn::Lt(root, hn::Sub(to, at.s)));
    const Mask cut = in_cut_cells(body, at, found);
    unsettled = hn::Or(unsettled, cut);
    hits = hn::Or(hits, hn::AndNot(cut, found));
    met = hn::IfThenElse(found, hn::Add(at.s, root), met);
    return found;
  }
};

/// The water along the rays, m.
struct Measure {
  static constexpr int first_level = 0;  ///< the surface has just been met
  const HeightFieldBody& body;
  const BoxRays& rays;
  Vec sum;
  Mask unsettled;

  HWY_INLINE Mask passes(const float* blocks, Int index, Vec low, Vec high, Vec s, Vec to, Mask lanes) {
    const Tag d;
    const Mask over = hn::Gt(low, hn::GatherIndex(d, blocks + 1, index));
    const Mask under = hn::Lt(high, hn::GatherIndex(d, blocks, index));
    sum = hn::Add(sum, hn::IfThenElseZero(hn::And(lanes, under), hn::Sub(to, s)));
    return hn::Or(over, under);
  }
  HWY_INLINE Mask visit(const Places& at, Vec to, Mask lanes) {
    const Tag d;
    const Vec zero = hn::Zero(d);
    const Patches patches(body.heights().data(), body.cells_a() + 1, at.i, at.j);
    const Quadratics q = patches.above(rays, at.i, at.j, at.s);
    const Vec end = hn::Sub(to, at.s);
    const Vec a = hn::IfThenElse(hn::Eq(q.a, zero), hn::Set(d, 1e-30f), q.a);
    const Vec discriminant = hn::NegMulAdd(hn::Mul(hn::Set(d, 4.0f), a), q.c, hn::Mul(q.b, q.b));
    const Vec half = hn::Mul(hn::Set(d, -0.5f), hn::Add(q.b, hn::CopySign(hn::Sqrt(hn::Max(discriminant, zero)), q.b)));
    const Vec one = hn::Div(half, a), other = hn::Div(q.c, half);
    const Vec from = hn::Min(hn::Max(hn::Min(one, other), zero), end),
              until = hn::Min(hn::Max(hn::Max(one, other), zero), end);
    const Vec between = hn::Sub(until, from);
    const Vec with_roots = hn::IfThenElse(hn::Gt(a, zero), between, hn::Sub(end, between));
    const Vec without = hn::IfThenElseZero(hn::Le(q.c, zero), end);
    const Vec wet = hn::IfThenElse(hn::Gt(discriminant, zero), with_roots, without);
    const Mask cut = in_cut_cells(body, at, hn::And(lanes, hn::Gt(wet, zero)));
    unsettled = hn::Or(unsettled, cut);
    sum = hn::Add(sum, hn::IfThenElseZero(lanes, wet));
    return cut;
  }
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#endif
