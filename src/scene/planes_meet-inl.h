// Where rays meet tank and ground; included once for each instruction set, after highway.h.

#if defined(MENISCUS_SCENE_PLANES_MEET_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MENISCUS_SCENE_PLANES_MEET_INL_H_
#undef MENISCUS_SCENE_PLANES_MEET_INL_H_
#else
#define MENISCUS_SCENE_PLANES_MEET_INL_H_
#endif

#include <hwy/highway.h>

#include "scene/planes.h"
#include "scene/planes_patterns-inl.h"

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

/// One vector of rays. Faces are kept as floats until they are stored.
class Meeting {
 public:
  HWY_INLINE Meeting(const Planes& planes, const RayBlock& rays, const BlockBeams& beams, int first)
      : planes_(planes), rays_(rays), beams_(beams), first_(static_cast<std::size_t>(first)) {}

  HWY_INLINE void run(const SolidsBox& solids, float tie, bool colours, BlockHits& hits) const {
    const Tag d;
    Vec best = all(std::numeric_limits<float>::infinity()), face = all(static_cast<float>(kNothing));
    Vec red = hn::Zero(d), green = red, blue = red, presence = all(1.0f);
    if (planes_.tank && planes_.tank->tank().style == TankStyle::tiled)
      tiled(colours, best, face, red, green, blue);
    else if (planes_.tank)
      bars(best, face, red, green, blue);
    if (planes_.ground.visible) ground(tie, colours, best, face, presence, red, green, blue);
    hn::Store(best, d, hits.distance + first_);
    hn::Store(red, d, hits.albedo[0] + first_);
    hn::Store(green, d, hits.albedo[1] + first_);
    hn::Store(blue, d, hits.albedo[2] + first_);
    hn::Store(presence, d, hits.presence + first_);
    const hn::RebindToSigned<Tag> di;
    hn::Store(hn::ConvertTo(di, face), di, hits.face + first_);
    Vec near = hn::Zero(d);
    if (!solids.box.empty()) {
      near = near_to(solids.box, best);
      if (!solids.parts.empty() && !hn::AllFalse(d, hn::Gt(near, hn::Zero(d)))) {
        near = hn::Zero(d);
        for (const Bounds& part : solids.parts) near = hn::Max(near, near_to(part, best));
      }
    }
    hn::Store(hn::ConvertTo(di, near), di, hits.near_solids + first_);
  }

 private:
  HWY_INLINE Vec origin(int axis) const { return hn::Load(Tag(), rays_.origin[axis] + first_); }
  HWY_INLINE Vec direction(int axis) const { return hn::Load(Tag(), rays_.direction[axis] + first_); }
  HWY_INLINE Vec at(int axis, Vec distance) const { return hn::Add(origin(axis), hn::Mul(distance, direction(axis))); }
  HWY_INLINE Vec width_at(Vec distance) const {
    const Tag d;
    return hn::Add(hn::Load(d, beams_.width + first_), hn::Mul(hn::Load(d, beams_.spread + first_), distance));
  }
  HWY_INLINE Vec along(vec3 v) const {
    return hn::Add(hn::Add(hn::Mul(direction(0), all(v.x)), hn::Mul(direction(1), all(v.y))),
                   hn::Mul(direction(2), all(v.z)));
  }
  static HWY_INLINE Vec dot(Vec x, Vec y, Vec z, vec3 v) {
    return hn::Add(hn::Add(hn::Mul(x, all(v.x)), hn::Mul(y, all(v.y))), hn::Mul(z, all(v.z)));
  }
  static HWY_INLINE Mask within(const Bounds& box, Vec v, int axis, float margin) {
    return hn::And(hn::Ge(v, all(box.low[axis] - margin)), hn::Le(v, all(box.high[axis] + margin)));
  }
  static HWY_INLINE Vec face_of(int axis, Mask positive) {
    return hn::IfThenElse(positive, all(static_cast<float>(2 * axis + 1)), all(static_cast<float>(2 * axis)));
  }

  /// See TankBody::tiled_hit().
  HWY_INLINE void tiled(bool colours, Vec& best, Vec& face, Vec& red, Vec& green, Vec& blue) const {
    const Tag d;
    const Vec zero = hn::Zero(d);
    const TankBody& tank = *planes_.tank;
    const Bounds& inside = tank.tank().inside;
    const Bounds outside = tank.bounds();
    const float overlap = tank.overlap();
    for (int axis = 0; axis < 3; ++axis) {
      const int s = (axis + 1) % 3, t = (axis + 2) % 3;
      const Vec way = direction(axis);
      const Mask forward = hn::Gt(way, zero);
      const Vec wall = hn::IfThenElse(forward, all(inside.high[axis]), all(inside.low[axis]));
      const Vec distance = hn::Div(hn::Sub(wall, origin(axis)), way);
      Mask met = hn::And(hn::Ge(distance, zero), hn::Lt(distance, best));
      met = hn::And(met, axis == tank.up() ? hn::Lt(way, zero) : hn::Ne(way, zero));
      met = hn::And(met, within(inside, at(s, distance), s, overlap));
      met = hn::And(met, within(inside, at(t, distance), t, overlap));
      best = hn::IfThenElse(met, distance, best);
      face = hn::IfThenElse(met, face_of(axis, hn::Not(forward)), face);
    }
    const Mask walls = hn::Ge(face, zero);
    const Vec at_wall = best;

    // The rim.
    const int up = tank.up(), side = tank.side(), other = tank.other();
    const Vec distance = hn::Div(hn::Sub(all(inside.high[up]), origin(up)), direction(up));
    const Mask over = hn::And(hn::Lt(direction(up), zero), hn::And(hn::Ge(distance, zero), hn::Lt(distance, best)));
    Mask rim = over;
    if (!hn::AllFalse(d, over)) {
      const auto beyond = [&](int axis) HWY_ATTR {
        const Vec point = at(axis, distance), way = direction(axis);
        return hn::Or(hn::And(hn::Lt(point, all(inside.low[axis])), hn::Lt(way, zero)),
                      hn::And(hn::Gt(point, all(inside.high[axis])), hn::Gt(way, zero)));
      };
      rim = hn::And(rim, hn::Or(beyond(side), beyond(other)));
      rim = hn::And(rim, within(outside, at(side, distance), side, 0));
      rim = hn::And(rim, within(outside, at(other, distance), other, 0));
      best = hn::IfThenElse(rim, distance, best);
      face = hn::IfThenElse(rim, all(static_cast<float>(2 * up + 1)), face);
    }
    if (!colours) return;
    Vec joints = hn::IfThenElseZero(rim, all(1.0f));
    const Mask tiles = hn::AndNot(rim, walls);
    if (!hn::AllFalse(d, tiles)) joints = hn::IfThenElse(tiles, joints_at(tank, at_wall, face), joints);
    const Mask any = hn::Or(walls, rim);
    const vec3 tile = tank.tank().albedo, joint = tank.tank().joint_albedo;
    red = hn::IfThenElse(any, mixed(tile.x, joint.x, joints), red);
    green = hn::IfThenElse(any, mixed(tile.y, joint.y, joints), green);
    blue = hn::IfThenElse(any, mixed(tile.z, joint.z, joints), blue);
  }

  /// See TankBody::tiles(): the fraction of joints.
  HWY_INLINE Vec joints_at(const TankBody& tank, Vec distance, Vec face) const {
    const Mask on_x = hn::Lt(face, all(1.5f)), on_z = hn::Gt(face, all(3.5f));
    const auto chosen = [&](Vec x, Vec y, Vec z)
                            HWY_ATTR { return hn::IfThenElse(on_x, x, hn::IfThenElse(on_z, z, y)); };
    const vec3 low = tank.tank().inside.low, tile = tank.tile();
    const auto place = [&](int axis)
                           HWY_ATTR { return hn::Div(hn::Sub(at(axis, distance), all(low[axis])), all(tile[axis])); };
    const Vec x = place(0), y = place(1), z = place(2);
    const Vec width = width_at(distance);
    const Vec cos_in = hn::Max(all(1e-4f), hn::Abs(chosen(direction(0), direction(1), direction(2))));
    const Vec width_s = footprint_of(width, cos_in, chosen(direction(1), direction(2), direction(0)));
    const Vec width_t = footprint_of(width, cos_in, chosen(direction(2), direction(0), direction(1)));
    const Vec extent_s = hn::Div(width_s, chosen(all(tile.y), all(tile.z), all(tile.x)));
    const Vec extent_t = hn::Div(width_t, chosen(all(tile.z), all(tile.x), all(tile.y)));
    constexpr float kJoint = TankBody::kJoint;
    const Vec half = all(0.5f * kJoint), one = all(1.0f);
    const Vec in_s = pulse_mean_of(hn::Add(chosen(y, z, x), half), extent_s, kJoint);
    const Vec in_t = pulse_mean_of(hn::Add(chosen(z, x, y), half), extent_t, kJoint);
    return hn::Sub(one, hn::Mul(hn::Sub(one, in_s), hn::Sub(one, in_t)));
  }

  /// Distances at which the rays enter and leave a box, and the axis through whose face they enter.
  HWY_INLINE void cross(const Bounds& box, Vec& enter, Vec& leave, Vec& axis_in) const {
    enter = all(-std::numeric_limits<float>::infinity());
    leave = all(std::numeric_limits<float>::infinity());
    axis_in = hn::Zero(Tag());
    for (int axis = 0; axis < 3; ++axis) {
      // A ray along a face is as good as one that is not quite; it leaves no 0 / 0.
      const Vec way = direction(axis);
      const Vec inverse = hn::Div(all(1.0f), hn::IfThenElse(hn::Lt(hn::Abs(way), all(1e-20f)), all(1e-20f), way));
      const Vec a = hn::Mul(hn::Sub(all(box.low[axis]), origin(axis)), inverse);
      const Vec b = hn::Mul(hn::Sub(all(box.high[axis]), origin(axis)), inverse);
      const Vec in = hn::Min(a, b);
      axis_in = hn::IfThenElse(hn::Gt(in, enter), all(static_cast<float>(axis)), axis_in);
      enter = hn::Max(in, enter);
      leave = hn::Min(hn::Max(a, b), leave);
    }
  }

  /// One where a box is met before `limit`.
  HWY_INLINE Vec near_to(const Bounds& box, Vec limit) const {
    Vec enter, leave, axis;
    cross(box, enter, leave, axis);
    return hn::IfThenElseZero(hn::Le(hn::Max(enter, hn::Zero(Tag())), hn::Min(leave, limit)), all(1.0f));
  }

  /// See TankBody::bar_hit().
  HWY_INLINE void bars(Vec& best, Vec& face, Vec& red, Vec& green, Vec& blue) const {
    const Tag d;
    const Vec zero = hn::Zero(d);
    Vec enter, leave, axis;
    cross(planes_.tank->bounds(), enter, leave, axis);
    if (hn::AllFalse(d, hn::And(hn::Le(enter, leave), hn::Ge(leave, zero)))) return;
    for (const Bounds& bar : planes_.tank->bars()) {
      cross(bar, enter, leave, axis);
      const Mask met = hn::And(hn::And(hn::Le(enter, leave), hn::Ge(enter, zero)), hn::Lt(enter, best));
      best = hn::IfThenElse(met, enter, best);
      const Vec way = hn::IfThenElse(hn::Lt(axis, all(0.5f)), direction(0),
                                     hn::IfThenElse(hn::Lt(axis, all(1.5f)), direction(1), direction(2)));
      const Vec positive = hn::IfThenElseZero(hn::Le(way, zero), all(1.0f));
      face = hn::IfThenElse(met, hn::Add(hn::Add(axis, axis), positive), face);
    }
    const Mask any = hn::Ge(face, zero);
    red = hn::IfThenElse(any, all(TankBody::kEdgeColour.x), red);
    green = hn::IfThenElse(any, all(TankBody::kEdgeColour.y), green);
    blue = hn::IfThenElse(any, all(TankBody::kEdgeColour.z), blue);
  }

  static HWY_INLINE Vec smooth(Vec v) {
    const Vec t = clamped(v, 0.0f, 1.0f);
    const Vec inner = hn::Add(hn::Mul(t, hn::Sub(hn::Mul(all(6.0f), t), all(15.0f))), all(10.0f));
    return hn::Mul(hn::Mul(hn::Mul(t, t), t), inner);
  }

  /// See Scene::Parts::ground_hit().
  HWY_INLINE void ground(float tie, bool colours, Vec& best, Vec& face, Vec& presence, Vec& red, Vec& green,
                         Vec& blue) const {
    const Tag d;
    const Ground& g = planes_.ground;
    const Vec down = hn::Neg(along(g.up)), zero = hn::Zero(d), one = all(1.0f);
    const Vec above = hn::Sub(dot(origin(0), origin(1), origin(2), g.up), all(g.height));
    const Vec distance = hn::Max(hn::Div(above, down), zero);
    Mask met = hn::And(hn::Gt(down, all(1e-7f)), hn::Lt(hn::Mul(distance, all(1.0f + tie)), best));
    if (hn::AllFalse(d, met)) return;
    const Vec x = at(0, distance), y = at(1, distance), z = at(2, distance);
    if (planes_.tank && planes_.tank->tank().style == TankStyle::tiled) {
      const TankBody& tank = *planes_.tank;
      const Bounds& inside = tank.tank().inside;
      const auto in = [&](int axis, float margin) HWY_ATTR {
        return within(inside, axis == 0 ? x : axis == 1 ? y : z, axis, margin);
      };
      met = hn::AndNot(hn::And(hn::And(in(tank.side(), 0), in(tank.other(), 0)), in(tank.up(), tank.overlap())), met);
    }
    Vec left = smooth(hn::Mul(down, all(1.0f / kHorizonHaze)));
    if (g.fade_radius > 0) {
      const Vec off_x = hn::Sub(x, all(g.centre.x)), off_y = hn::Sub(y, all(g.centre.y)),
                off_z = hn::Sub(z, all(g.centre.z));
      const Vec height = dot(off_x, off_y, off_z, g.up);
      const Vec square = hn::Add(hn::Add(hn::Mul(off_x, off_x), hn::Mul(off_y, off_y)), hn::Mul(off_z, off_z));
      const Vec from_centre = hn::Sqrt(hn::Max(hn::Sub(square, hn::Mul(height, height)), zero));
      const Vec part = hn::MulSub(from_centre, all(1.0f / g.fade_radius), all(0.15f));
      left = hn::Mul(left, hn::Sub(one, smooth(hn::Mul(part, all(1.0f / 0.85f)))));
    }
    met = hn::And(met, hn::Gt(left, zero));
    if (hn::AllFalse(d, met)) return;
    best = hn::IfThenElse(met, distance, best);
    face = hn::IfThenElse(met, all(static_cast<float>(kGroundFace)), face);
    presence = hn::IfThenElse(met, left, presence);
    if (!colours) return;
    Vec first = one;
    if (g.square > 0) {
      const Vec width = width_at(distance);
      const Vec scale = all(1.0f / g.square);
      const Vec width_u = hn::Mul(footprint_of(width, down, along(planes_.u_axis)), scale);
      const Vec width_v = hn::Mul(footprint_of(width, down, along(planes_.v_axis)), scale);
      const Vec wave_u = square_wave_mean_of(hn::Mul(dot(x, y, z, planes_.u_axis), scale), width_u);
      const Vec wave_v = square_wave_mean_of(hn::Mul(dot(x, y, z, planes_.v_axis), scale), width_v);
      first = clamped(hn::Add(all(0.5f), hn::Mul(hn::Mul(all(0.5f), wave_u), wave_v)), 0.0f, 1.0f);
    }
    const vec3 a = g.second_albedo, b = g.albedo;
    red = hn::IfThenElse(met, mixed(a.x, b.x, first), red);
    green = hn::IfThenElse(met, mixed(a.y, b.y, first), green);
    blue = hn::IfThenElse(met, mixed(a.z, b.z, first), blue);
  }

  const Planes& planes_;
  const RayBlock& rays_;
  const BlockBeams& beams_;
  std::size_t first_;
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#endif
