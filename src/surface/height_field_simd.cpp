// Packets of rays into height fields: clipped, marched, improved, and what is seen there.
#include <algorithm>

#include "surface/height_field_packet.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surface/height_field_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// after highway.h
#include "surface/height_field_cells-inl.h"
#include "surface/height_field_march-inl.h"

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

using Wide = HWY_CAPPED(double, kPacket);
using Narrow = hn::Rebind<float, Wide>;  ///< as many floats
using WideVec = hn::Vec<Wide>;
using WideInt = hn::RebindToSigned<Narrow>;

constexpr float kSettled = 1e-3f;  ///< columns that Newton's step may go
constexpr float kGrazing = 1e-3f;  ///< cosine that an interpolated normal keeps to the ray

/// Sixteen rays in the columns' coordinates, with what is in the box of the water, and what is met there.
struct InBox {
  alignas(64) double a[kPacket], b[kPacket], z[kPacket];     ///< at t = 0
  alignas(64) double da[kPacket], db[kPacket], dz[kPacket];  ///< per m
  alignas(64) double begin[kPacket], end[kPacket];           ///< m along the ray
  alignas(64) float a0[kPacket], b0[kPacket], z0[kPacket];   ///< at begin
  alignas(64) float fda[kPacket], fdb[kPacket], fdz[kPacket], span[kPacket];
  alignas(64) float first[kPacket];                 ///< Face through which the box is entered
  alignas(64) float s[kPacket];                     ///< m from begin to the crossing
  alignas(64) std::int32_t i[kPacket], j[kPacket];  ///< its cell
  alignas(64) float u[kPacket], v[kPacket];         ///< its place in there
};

constexpr float code(Face face) { return static_cast<float>(face); }

/// HeightFieldBody::field_ray() and clipped().
HWY_INLINE void clip(const HeightFieldBody& body, const PacketRays& rays, InBox& box) {
  const Wide d;
  const Narrow n;
  const HeightFieldBody::Frame& frame = body.frame();
  const std::array<const float*, 3> origins{rays.ox, rays.oy, rays.oz}, directions{rays.dx, rays.dy, rays.dz};
  const auto from = [](const std::array<const float*, 3>& of, int axis) { return of[static_cast<std::size_t>(axis)]; };
  const WideVec zero = hn::Zero(d), one = hn::Set(d, 1.0), large = hn::Set(d, 1e30);
  for (std::size_t l = 0; l < kPacket; l += hn::Lanes(d)) {
    const auto wide = [&](const float* values) { return hn::PromoteTo(d, hn::Load(n, values + l)); };
    const WideVec per_a = hn::Set(d, frame.per_a), per_b = hn::Set(d, frame.per_b);
    const WideVec a = hn::Mul(hn::Sub(wide(from(origins, frame.a)), hn::Set(d, frame.low_a)), per_a);
    const WideVec b = hn::Mul(hn::Sub(wide(from(origins, frame.b)), hn::Set(d, frame.low_b)), per_b);
    const WideVec z = wide(from(origins, frame.up));
    const WideVec da = hn::Mul(wide(from(directions, frame.a)), per_a);
    const WideVec db = hn::Mul(wide(from(directions, frame.b)), per_b);
    const WideVec dz = wide(from(directions, frame.up));
    WideVec begin = zero, end = large, first = hn::Set(d, static_cast<double>(code(Face::start)));
    const auto slab = [&](WideVec origin, WideVec along, double low, double high, Face at_low, Face at_high) {
      const WideVec per = hn::Div(one, along), lowest = hn::Set(d, low), highest = hn::Set(d, high);
      const WideVec to_low = hn::Mul(hn::Sub(lowest, origin), per), to_high = hn::Mul(hn::Sub(highest, origin), per);
      const auto still = hn::Eq(along, zero);
      const auto beside = hn::Or(hn::Lt(origin, lowest), hn::Gt(origin, highest));
      const WideVec in = hn::IfThenElse(still, zero, hn::Min(to_low, to_high));
      const WideVec out = hn::IfThenElse(still, hn::IfThenElse(beside, hn::Neg(one), large), hn::Max(to_low, to_high));
      const WideVec face = hn::IfThenElse(hn::Gt(along, zero), hn::Set(d, static_cast<double>(code(at_low))),
                                          hn::Set(d, static_cast<double>(code(at_high))));
      first = hn::IfThenElse(hn::Gt(in, begin), face, first);
      begin = hn::Max(begin, in);
      end = hn::Min(end, out);
    };
    slab(a, da, 0, body.cells_a(), Face::side_a, Face::side_a);
    slab(b, db, 0, body.cells_b(), Face::side_b, Face::side_b);
    slab(z, dz, static_cast<double>(body.floor()), static_cast<double>(body.top()), Face::floor, Face::top);
    const auto narrow = [&](WideVec value, float* to) { hn::Store(hn::DemoteTo(n, value), n, to + l); };
    hn::Store(a, d, box.a + l), hn::Store(b, d, box.b + l), hn::Store(z, d, box.z + l);
    hn::Store(da, d, box.da + l), hn::Store(db, d, box.db + l), hn::Store(dz, d, box.dz + l);
    hn::Store(begin, d, box.begin + l), hn::Store(end, d, box.end + l);
    narrow(hn::MulAdd(begin, da, a), box.a0), narrow(hn::MulAdd(begin, db, b), box.b0);
    narrow(hn::MulAdd(begin, dz, z), box.z0);
    narrow(da, box.fda), narrow(db, box.fdb), narrow(dz, box.fdz);
    narrow(hn::Sub(end, begin), box.span), narrow(first, box.first);
  }
}

HWY_INLINE Mask mask_of(PacketMask mask, std::size_t first) {
  const Tag d;
  const PacketMask bits = mask >> first;
  const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(bits), static_cast<std::uint8_t>(bits >> 8)};
  return hn::LoadMaskBits(d, bytes);
}

HWY_INLINE PacketMask bits_of(Mask mask, std::size_t first) {
  const Tag d;
  alignas(8) std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  const PacketMask bits = static_cast<PacketMask>(bytes[0]) | static_cast<PacketMask>(bytes[1]) << 8;
  return (bits & ((1u << hn::Lanes(d)) - 1u)) << first;
}

/// The crossings in floats.
HWY_INLINE void find(const HeightFieldBody& body, InBox& box, PacketMask mask, FieldHits& hits) {
  const Tag d;
  const IntTag di;
  const Vec zero = hn::Zero(d);
  for (std::size_t l = 0; l < kPacket; l += hn::Lanes(d)) {
    const auto load = [&](const float* values) { return hn::Load(d, values + l); };
    const BoxRays rays{load(box.a0),  load(box.b0),  load(box.z0),  load(box.fda),
                       load(box.fdb), load(box.fdz), load(box.span)};
    const auto cell = [&](Vec place, int cells) {
      return hn::Min(hn::ConvertTo(di, hn::Max(place, zero)), hn::Set(di, cells - 1));
    };
    Places at{zero, cell(rays.a, body.cells_a()), cell(rays.b, body.cells_b())};
    const Mask active = hn::And(mask_of(mask, l), hn::Ge(rays.span, zero));
    Enter enter{body, rays, zero, hn::AndNot(active, active), hn::AndNot(active, active)};
    const Mask given_up = march(body, rays, at, active, enter);
    hits.hit |= bits_of(enter.hits, l);
    hits.unsettled |= bits_of(hn::Or(enter.unsettled, given_up), l);
    hn::Store(enter.met, d, box.s + l);
    hn::Store(at.i, di, box.i + l);
    hn::Store(at.j, di, box.j + l);
  }
}

/// One step of Newton's in double precision; where that is not enough, lanes become unsettled.
HWY_INLINE void improve(const HeightFieldRays& water, InBox& box, FieldHits& hits) {
  const HeightFieldBody& body = water.body();
  const Wide d;
  const Narrow n;
  const WideInt di;
  const float* heights = body.heights().data();
  const int width = body.cells_a() + 1;
  const WideVec zero = hn::Zero(d), one = hn::Set(d, 1.0);
  alignas(64) float far[kPacket];
  for (std::size_t l = 0; l < kPacket; l += hn::Lanes(d)) {
    const WideVec a = hn::Load(d, box.a + l), b = hn::Load(d, box.b + l), z = hn::Load(d, box.z + l);
    const WideVec da = hn::Load(d, box.da + l), db = hn::Load(d, box.db + l), dz = hn::Load(d, box.dz + l);
    const auto i = hn::Load(di, box.i + l), j = hn::Load(di, box.j + l);
    const auto first = hn::PromoteTo(d, hn::Load(n, box.first + l));
    const WideVec s = hn::PromoteTo(d, hn::Load(n, box.s + l));
    const WideVec t = hn::Add(hn::Load(d, box.begin + l), s);
    const WideVec wide_i = hn::PromoteTo(d, hn::ConvertTo(n, i)), wide_j = hn::PromoteTo(d, hn::ConvertTo(n, j));
    const WideVec u = hn::Sub(hn::MulAdd(t, da, a), wide_i), v = hn::Sub(hn::MulAdd(t, db, b), wide_j);
    const auto p = hn::Add(hn::Mul(j, hn::Set(di, width)), i);
    const auto height = [&](const float* of) { return hn::PromoteTo(d, hn::GatherIndex(n, of, p)); };
    const WideVec h00 = height(heights);
    const WideVec by_u = hn::Sub(height(heights + 1), h00), by_v = hn::Sub(height(heights + width), h00);
    const WideVec by_uv = hn::Sub(hn::Sub(height(heights + width + 1), h00), hn::Add(by_u, by_v));
    const WideVec slope_u = hn::MulAdd(by_uv, v, by_u), slope_v = hn::MulAdd(by_uv, u, by_v);
    const WideVec over = hn::Sub(hn::MulAdd(t, dz, z), hn::MulAdd(slope_u, u, hn::MulAdd(by_v, v, h00)));
    const WideVec rate = hn::NegMulAdd(slope_u, da, hn::NegMulAdd(slope_v, db, dz));
    const WideVec bend = hn::Mul(hn::Mul(by_uv, da), db);
    // Sides, the floor and the upper end of the box are where the box is entered: nothing is to be improved there.
    const auto top = hn::Or(hn::Gt(s, zero), hn::Eq(first, hn::Set(d, static_cast<double>(code(Face::top)))));
    const WideVec step = hn::IfThenElseZero(top, hn::Div(over, rate));
    const WideVec new_t = hn::Sub(t, step), new_u = hn::NegMulAdd(step, da, u), new_v = hn::NegMulAdd(step, db, v);
    const WideVec way = hn::Max(hn::Max(hn::Abs(hn::Mul(step, da)), hn::Abs(hn::Mul(step, db))),
                                hn::Abs(hn::Mul(step, hn::Set(d, body.frame().per_a))));
    // The error of the step is step^2 bend / rate.
    const WideVec error = hn::Abs(hn::Div(hn::Mul(step, bend), rate));
    const WideVec most = hn::Set(d, static_cast<double>(kSettled));
    const WideVec outside =
        hn::Max(hn::Max(hn::Neg(new_u), hn::Sub(new_u, one)), hn::Max(hn::Neg(new_v), hn::Sub(new_v, one)));
    const auto settled =
        hn::And(hn::And(hn::Lt(way, most), hn::Lt(outside, most)), hn::Or(hn::Not(top), hn::Lt(error, most)));
    hn::Store(hn::DemoteTo(n, hn::IfThenElse(settled, zero, one)), n, far + l);
    hn::Store(hn::DemoteTo(n, hn::Max(new_t, zero)), n, hits.depth + l);
    hn::Store(hn::DemoteTo(n, hn::Min(hn::Max(new_u, zero), one)), n, box.u + l);
    hn::Store(hn::DemoteTo(n, hn::Min(hn::Max(new_v, zero), one)), n, box.v + l);
  }
  for (int l = 0; l < kPacket; ++l) {
    const bool begins = box.s[l] <= 0;
    const auto face = static_cast<Face>(static_cast<int>(box.first[l]));
    const bool other =
        begins && (face == Face::start || (!water.sides() && (face == Face::side_a || face == Face::side_b)));
    if (far[l] > 0 || other) hits.unsettled |= (hits.hit & (1u << l));
  }
}

/// Normals of what is met, as HeightFieldRays::normal() tells.
HWY_INLINE void find_normals(const HeightFieldRays& water, const PacketRays& rays, const InBox& box, FieldHits& hits) {
  const Tag d;
  const IntTag di;
  const HeightFieldBody::Frame& frame = water.body().frame();
  const float* normals = &water.field().normal(0, 0).x;
  const int width = water.field().normal.width();
  const Vec zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  for (std::size_t l = 0; l < kPacket; l += hn::Lanes(d)) {
    const Vec u = hn::Load(d, box.u + l), v = hn::Load(d, box.v + l);
    const Int i = hn::Load(di, box.i + l), j = hn::Load(di, box.j + l);
    const Int p = hn::Mul(hn::Add(hn::Mul(j, hn::Set(di, width)), i), hn::Set(di, 3));
    const auto component = [&](int axis) {
      const float *near = normals + axis, *far = near + 3 * width;
      const Vec n00 = hn::GatherIndex(d, near, p), n10 = hn::GatherIndex(d, near + 3, p);
      const Vec n01 = hn::GatherIndex(d, far, p), n11 = hn::GatherIndex(d, far + 3, p);
      const Vec low = hn::MulAdd(u, hn::Sub(n10, n00), n00), high = hn::MulAdd(u, hn::Sub(n11, n01), n01);
      return hn::MulAdd(v, hn::Sub(high, low), low);
    };
    Vec x = component(0), y = component(1), z = component(2);
    const Vec dx = hn::Load(d, rays.dx + l), dy = hn::Load(d, rays.dy + l), dz = hn::Load(d, rays.dz + l);
    const auto make_unit = [&] {
      const Vec per = hn::Div(one, hn::Sqrt(hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)))));
      x = hn::Mul(x, per), y = hn::Mul(y, per), z = hn::Mul(z, per);
    };
    make_unit();
    // Interpolated normals may turn away from a ray that the surface itself faces: those are turned back to grazing.
    const Vec facing = hn::Neg(hn::MulAdd(x, dx, hn::MulAdd(y, dy, hn::Mul(z, dz))));
    const Vec turn = hn::Max(hn::Sub(hn::Set(d, kGrazing), facing), zero);
    if (!hn::AllFalse(d, hn::Gt(turn, zero))) {
      x = hn::NegMulAdd(turn, dx, x), y = hn::NegMulAdd(turn, dy, y), z = hn::NegMulAdd(turn, dz, z);
      make_unit();
    }
    // Where the box is entered through its sides or the floor, their own.
    const Vec first = hn::Load(d, box.first + l);
    const Mask begins = hn::And(hn::Le(hn::Load(d, box.s + l), zero), hn::Ne(first, hn::Set(d, code(Face::top))));
    if (!hn::AllFalse(d, begins)) {
      const auto along = [&](Face face, const float* direction) {
        const Vec against = hn::Neg(hn::CopySign(one, hn::Load(d, direction + l)));
        return hn::IfThenElseZero(hn::Eq(first, hn::Set(d, code(face))), against);
      };
      const Vec a = along(Face::side_a, box.fda), b = along(Face::side_b, box.fdb), up = along(Face::floor, box.fdz);
      const auto of = [&](int axis) { return axis == frame.a ? a : axis == frame.b ? b : up; };
      x = hn::IfThenElse(begins, of(0), x), y = hn::IfThenElse(begins, of(1), y), z = hn::IfThenElse(begins, of(2), z);
    }
    hn::StoreInterleaved3(x, y, z, d, hits.normal + 3 * l);
  }
}

/// HeightFieldBody::length() from the crossing on.
HWY_INLINE void find_thickness(const HeightFieldBody& body, const InBox& box, FieldHits& hits) {
  const Tag d;
  const IntTag di;
  const Vec zero = hn::Zero(d);
  const Vec lowest = hn::Set(d, std::max(body.levels().back().blocks[0].low, -3e38f));
  for (std::size_t l = 0; l < kPacket; l += hn::Lanes(d)) {
    const auto load = [&](const float* values) { return hn::Load(d, values + l); };
    BoxRays rays{load(box.a0), load(box.b0), load(box.z0), load(box.fda), load(box.fdb), load(box.fdz), load(box.span)};
    const Vec met = hn::Min(load(box.s), rays.span), end = rays.span;
    // What lies deeper than the lowest place of the surface is water without looking.
    const Mask down = hn::Lt(rays.dz, zero), up = hn::Gt(rays.dz, zero);
    const Vec level = hn::IfThenElse(hn::Lt(rays.z, lowest), end, met);
    const Vec way = hn::Min(hn::Max(hn::Div(hn::Sub(lowest, rays.z), rays.dz), met), end);
    const Vec edge = hn::IfThenElse(hn::Or(down, up), way, level);
    const Vec deep = hn::IfThenElse(down, hn::Sub(end, edge), hn::Sub(edge, met));
    const Vec from = hn::IfThenElse(down, met, edge);
    rays.span = hn::IfThenElse(down, edge, end);
    const auto cell = [&](Vec origin, Vec along, int cells) {
      return hn::Min(hn::ConvertTo(di, hn::Max(hn::MulAdd(from, along, origin), zero)), hn::Set(di, cells - 1));
    };
    Places at{from, cell(rays.a, rays.da, body.cells_a()), cell(rays.b, rays.db, body.cells_b())};
    const Mask active = hn::And(mask_of(hits.hit, l), hn::Lt(from, rays.span));
    Measure measure{body, rays, zero, hn::AndNot(active, active)};
    const Mask given_up = march(body, rays, at, active, measure);
    hits.unmeasured |= bits_of(hn::Or(measure.unsettled, given_up), l);
    hn::Store(hn::Add(deep, measure.sum), d, hits.thickness + l);
  }
}

}  // namespace

void EnterPacket(const HeightFieldRays& water, const PacketRays& rays, PacketMask mask, bool want_thickness,
                 FieldHits& hits) {
  hits.hit = hits.unsettled = hits.unmeasured = 0;
  if (water.body().empty()) return;
  InBox box;
  clip(water.body(), rays, box);
  find(water.body(), box, mask, hits);
  if (hits.hit == 0) return;
  improve(water, box, hits);
  find_normals(water, rays, box, hits);
  hits.hit &= ~hits.unsettled;
  if (want_thickness) find_thickness(water.body(), box, hits);
}

}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace meniscus {

HWY_EXPORT(EnterPacket);

void enter_packet(const HeightFieldRays& water, const PacketRays& rays, PacketMask mask, bool want_thickness,
                  FieldHits& hits) {
  HWY_DYNAMIC_DISPATCH(EnterPacket)(water, rays, mask, want_thickness, hits);
}

}  // namespace meniscus
#endif
