// The sun's way past tank and solids; included once for each instruction set, after highway.h.

#if defined(MENISCUS_SCENE_PLANES_LIGHT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MENISCUS_SCENE_PLANES_LIGHT_INL_H_
#undef MENISCUS_SCENE_PLANES_LIGHT_INL_H_
#else
#define MENISCUS_SCENE_PLANES_LIGHT_INL_H_
#endif

#include <hwy/highway.h>

#include "scene/planes.h"
#include "scene/planes_patterns-inl.h"

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

HWY_INLINE Mask inside_of(const Bounds& box, Vec v, int axis, float margin) {
  return hn::And(hn::Ge(v, all(box.low[axis] - margin)), hn::Le(v, all(box.high[axis] + margin)));
}

/// One vector of points.
HWY_INLINE void sun_at(const Planes& planes, const SolidsBox& solids, const SunPath& sun, int first_point,
                       BlockPoints& points) {
  const Tag d;
  const hn::RebindToSigned<Tag> di;
  const auto first = static_cast<std::size_t>(first_point);
  const Vec zero = hn::Zero(d), infinity = all(std::numeric_limits<float>::infinity());

  // Light starts a little above the face.
  const auto place = [&](int axis) HWY_ATTR { return hn::Load(d, points.at[axis] + first); };
  const Vec size = hn::Max(hn::Abs(place(0)), hn::Max(hn::Abs(place(1)), hn::Abs(place(2))));
  const Vec away = hn::Add(hn::Mul(all(3e-5f), size), all(sun.grain));
  const auto raised = [&](int axis) HWY_ATTR {
    return hn::Add(place(axis), hn::Mul(away, hn::Load(d, points.face_normal[axis] + first)));
  };
  const Vec x = raised(0), y = raised(1), z = raised(2);
  const auto start = [&](int axis) HWY_ATTR { return axis == 0 ? x : axis == 1 ? y : z; };
  const auto at = [&](int axis, Vec distance)
                      HWY_ATTR { return hn::Add(start(axis), hn::Mul(distance, all(sun.direction[axis]))); };

  Vec red = all(1.0f), green = red, blue = red;
  if (planes.tank && planes.tank->tank().style == TankStyle::tiled) {
    // See TankBody::keeps_light_out().
    const Bounds& inside = planes.tank->tank().inside;
    const int up = planes.tank->up();
    const float bulge = planes.tank->bulge();
    const Mask above_floor =
        hn::And(hn::Gt(start(up), all(inside.low[up] + 0.02f * bulge)), hn::Lt(start(up), all(inside.high[up])));
    Mask dark = hn::Lt(x, hn::Neg(infinity));
    for (int axis = 0; axis < 3; ++axis) {
      const float along = sun.direction[axis];
      if (along == 0) continue;
      for (const bool high : {false, true}) {
        if (axis == up && high) continue;
        const Vec distance =
            hn::Div(hn::Sub(all(high ? inside.high[axis] : inside.low[axis]), start(axis)), all(along));
        const bool outwards = (along > 0) == high && axis != up;
        const Vec nearest = outwards ? hn::IfThenElseZero(above_floor, all(-bulge / std::abs(along))) : zero;
        Mask met = hn::Ge(distance, nearest);
        const Vec reached = hn::Max(distance, zero);
        const int s = (axis + 1) % 3, t = (axis + 2) % 3;
        met = hn::And(
            met, hn::And(inside_of(inside, at(s, reached), s, bulge), inside_of(inside, at(t, reached), t, bulge)));
        met = hn::And(met, hn::Lt(at(up, reached), all(inside.high[up])));
        dark = hn::Or(dark, met);
      }
    }
    red = green = blue = hn::IfThenZeroElse(dark, red);
  } else if (planes.tank) {
    // See TankBody::panes().
    const Bounds outside = planes.tank->bounds();
    for (const int axis : {planes.tank->side(), planes.tank->other()}) {
      const float along = sun.direction[axis];
      if (along == 0) continue;
      for (const bool high : {false, true}) {
        const Vec distance =
            hn::Div(hn::Sub(all(high ? outside.high[axis] : outside.low[axis]), start(axis)), all(along));
        const int s = (axis + 1) % 3, t = (axis + 2) % 3;
        Mask met = hn::And(hn::Ge(distance, zero), hn::Lt(distance, infinity));
        met =
            hn::And(met, hn::And(inside_of(outside, at(s, distance), s, 0), inside_of(outside, at(t, distance), t, 0)));
        const vec3 through = sun.through_pane[axis];
        red = hn::IfThenElse(met, hn::Mul(red, all(through.x)), red);
        green = hn::IfThenElse(met, hn::Mul(green, all(through.y)), green);
        blue = hn::IfThenElse(met, hn::Mul(blue, all(through.z)), blue);
      }
    }
  }
  hn::Store(red, d, points.light[0] + first);
  hn::Store(green, d, points.light[1] + first);
  hn::Store(blue, d, points.light[2] + first);

  // See PlacedSolids::near().
  Vec near = zero;
  if (!solids.box.empty()) {
    const Vec off_x = hn::Sub(all(solids.centre.x), x), off_y = hn::Sub(all(solids.centre.y), y),
              off_z = hn::Sub(all(solids.centre.z), z);
    const Vec square = hn::Add(hn::Add(hn::Mul(off_x, off_x), hn::Mul(off_y, off_y)), hn::Mul(off_z, off_z));
    const Vec farthest = hn::Add(hn::Sqrt(square), all(solids.half_diagonal));
    const Vec margin = hn::Add(hn::Load(d, points.width + first), hn::Mul(all(sun.cone), farthest));
    const auto near_to = [&](const Bounds& box) HWY_ATTR {
      Vec enter = zero, leave = infinity;
      for (int axis = 0; axis < 3; ++axis) {
        const float along = sun.direction[axis];
        const Vec inverse = all(1.0f / (std::abs(along) < 1e-20f ? 1e-20f : along));
        const Vec a = hn::Mul(hn::Sub(hn::Sub(all(box.low[axis]), margin), start(axis)), inverse);
        const Vec b = hn::Mul(hn::Sub(hn::Add(all(box.high[axis]), margin), start(axis)), inverse);
        enter = hn::Max(hn::Min(a, b), enter);
        leave = hn::Min(hn::Max(a, b), leave);
      }
      return hn::IfThenElseZero(hn::Le(enter, leave), all(1.0f));
    };
    near = near_to(solids.box);
    if (!solids.parts.empty() && !hn::AllFalse(d, hn::Gt(near, zero))) {
      near = zero;
      for (const Bounds& part : solids.parts) near = hn::Max(near, near_to(part));
    }
  }
  hn::Store(hn::ConvertTo(di, near), di, points.near_solids + first);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#endif
