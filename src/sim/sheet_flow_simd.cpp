#include "sim/sheet_flow.h"

#include "sim/ground_constants.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sim/sheet_flow_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// Calls step(d, i) for all of `count`, many at a time and the rest one by one.
template <class Step>
HWY_INLINE void for_each(std::size_t count, const Step& step) {
  const hn::ScalableTag<double> d;
  const hn::CappedTag<double, 1> one;
  std::size_t i = 0;
  for (; i + hn::Lanes(d) <= count; i += hn::Lanes(d)) step(d, i);
  for (; i < count; ++i) step(one, i);
}

}  // namespace

void StepFlow(const SidesRow& r) {
  for_each(r.count, [&](auto d, std::size_t i) HWY_ATTR {
    const hn::Rebind<float, decltype(d)> narrow;
    const auto zero = hn::Zero(d), film = hn::Set(d, kHeldFilm);
    const auto bed_a = hn::PromoteTo(d, hn::LoadU(narrow, r.bed_a + i));
    const auto bed_b = hn::PromoteTo(d, hn::LoadU(narrow, r.bed_b + i));
    const auto depth_a = hn::LoadU(d, r.depth_a + i), depth_b = hn::LoadU(d, r.depth_b + i);
    const auto q = hn::LoadU(d, r.flow + i);
    const auto step = hn::Sub(bed_a, bed_b);
    const auto rise = hn::Add(step, hn::Sub(depth_a, depth_b));
    const auto deep = hn::Max(hn::Add(depth_a, hn::Min(step, zero)), hn::Sub(depth_b, hn::Max(step, zero)));
    const auto flowing = hn::Sub(deep, film);
    const auto uneven =
        hn::Or(hn::Ge(hn::Abs(rise), hn::Set(d, kStillLevel)), hn::Ge(hn::Abs(q), hn::Set(d, kStillFlow)));
    const auto moves = hn::And(hn::Ge(flowing, hn::Set(d, kStillDepth)), uneven);
    if (hn::AllFalse(d, moves)) {
      hn::StoreU(zero, d, r.flow + i);
      return;
    }
    const auto half = hn::Set(d, 0.5), dt = hn::Set(d, r.dt), gravity = hn::Set(d, kGroundGravity);
    const auto laminar = hn::Mul(half, hn::Add(hn::LoadU(d, r.laminar_a + i), hn::LoadU(d, r.laminar_b + i)));
    const auto friction = hn::Mul(half, hn::Add(hn::LoadU(d, r.friction_a + i), hn::LoadU(d, r.friction_b + i)));
    // Multiplied by h^2 h_f above and below: one division.
    const auto thick = hn::Mul(hn::Mul(deep, deep), flowing);
    const auto drag = hn::Add(hn::Mul(laminar, flowing), hn::Mul(hn::Mul(friction, hn::Abs(q)), deep));
    const auto driven = hn::Add(q, hn::Mul(hn::Mul(gravity, flowing), hn::Mul(rise, hn::Set(d, r.over))));
    const auto next = hn::Div(hn::Mul(driven, thick), hn::Add(thick, hn::Mul(dt, drag)));
    const auto fastest = hn::Mul(flowing, hn::Sqrt(hn::Max(hn::Mul(gravity, deep), zero)));
    hn::StoreU(hn::IfThenElseZero(moves, hn::Min(hn::Max(next, hn::Neg(fastest)), fastest)), d, r.flow + i);
  });
}

void LimitFlow(const CellsRow& r) {
  for_each(r.count, [&](auto d, std::size_t i) HWY_ATTR {
    const auto zero = hn::Zero(d), one = hn::Set(d, 1.0);
    const auto back = [&](const double* q) HWY_ATTR { return hn::Max(hn::Neg(hn::LoadU(d, q + i)), zero); };
    const auto on = [&](const double* q) HWY_ATTR { return hn::Max(hn::LoadU(d, q + i), zero); };
    const auto out = hn::Add(hn::Add(back(r.flow_a), on(r.flow_a + 1)), hn::Add(back(r.flow_b), on(r.flow_b_next)));
    const auto leaves = hn::Mul(out, hn::Set(d, r.over));
    const auto free = hn::Max(hn::Sub(hn::LoadU(d, r.depth + i), hn::Set(d, kHeldFilm)), zero);
    const auto short_of = hn::Gt(leaves, free);
    if (hn::AllFalse(d, short_of))
      hn::StoreU(one, d, r.part + i);
    else
      hn::StoreU(hn::IfThenElse(short_of, hn::Div(free, hn::IfThenElse(short_of, leaves, one)), one), d, r.part + i);
  });
}

double MoveWater(const CellsRow& r, double* moved) {
  double deepest = 0;
  for_each(r.count, [&](auto d, std::size_t i) HWY_ATTR {
    const auto zero = hn::Zero(d);
    const auto a0 = hn::LoadU(d, r.flow_a + i), a1 = hn::LoadU(d, r.flow_a + i + 1);
    const auto b0 = hn::LoadU(d, r.flow_b + i), b1 = hn::LoadU(d, r.flow_b_next + i);
    const auto depth = hn::LoadU(d, r.depth + i);
    const auto sum = hn::Add(hn::Add(hn::Abs(a0), hn::Abs(a1)), hn::Add(hn::Abs(b0), hn::Abs(b1)));
    hn::StoreU(sum, d, moved + i);
    auto next = depth;
    if (!hn::AllTrue(d, hn::Eq(sum, zero))) {
      const double* p = r.part + i;
      const auto part = hn::LoadU(d, p);
      const auto part_at = [&](const double* place) HWY_ATTR { return hn::LoadU(d, place); };
      const auto through = [&](auto q, auto from, auto to)
                               HWY_ATTR { return hn::Mul(q, hn::IfThenElse(hn::Gt(q, zero), from, to)); };
      const auto along_a = hn::Sub(through(a0, part_at(p - 1), part), through(a1, part, part_at(p + 1)));
      const auto along_b = hn::Sub(through(b0, part_at(p - r.stride), part), through(b1, part, part_at(p + r.stride)));
      next = hn::Max(hn::Add(depth, hn::Mul(hn::Add(along_a, along_b), hn::Set(d, r.over))), zero);
      hn::StoreU(next, d, r.depth + i);
    }
    const double most = hn::GetLane(hn::MaxOfLanes(d, next));
    deepest = deepest < most ? most : deepest;
  });
  return deepest;
}

}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace meniscus {

HWY_EXPORT(StepFlow);
HWY_EXPORT(LimitFlow);
HWY_EXPORT(MoveWater);

void step_flow(const SidesRow& row) { HWY_DYNAMIC_DISPATCH(StepFlow)(row); }
void limit_flow(const CellsRow& row) { HWY_DYNAMIC_DISPATCH(LimitFlow)(row); }
double move_water(const CellsRow& row, double* moved) { return HWY_DYNAMIC_DISPATCH(MoveWater)(row, moved); }

}  // namespace meniscus
#endif
