#include "sim/pbf.h"

#include <cmath>

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sim/pbf_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "sim/records-inl.h"

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

/// Calls visit(index, fourth, x, y, z, r2, gap, per_r) for the neighbours of i by vectors: the fourth of their records,
/// x = x_i - x_j ..., gap = h - r where it is positive and j is a neighbour, else 0.
template <class Visit>
HWY_INLINE void for_neighbours(const PbfConstants& c, const Neighbours& neighbours, const std::vector<float>& records,
                               std::size_t i, Visit visit) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  const NeighbourList list = neighbours.of(i);
  const Vec support = hn::Set(d, c.h), tiny = hn::Set(d, 1e-12f * c.h * c.h);
  const float* own = records.data() + 4 * i;
  const Vec px = hn::Set(d, own[0]), py = hn::Set(d, own[1]), pz = hn::Set(d, own[2]);
  for (std::size_t k = 0; k < list.count; k += lanes) {
    const Records other = load_records<4>(records.data(), list.index + k);
    const Vec x = hn::Sub(px, other.a), y = hn::Sub(py, other.b), z = hn::Sub(pz, other.c);
    const Vec r2 = hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
    const Vec per_r = reciprocal_root(hn::Max(r2, tiny));
    const Vec gap = hn::Max(hn::NegMulAdd(r2, per_r, support), hn::Zero(d));
    visit(list.index + k, other.d, x, y, z, r2, gap, per_r);
  }
}

}  // namespace

void Lambda(const PbfConstants& c, const Neighbours& neighbours, PbfState& state, std::size_t begin, std::size_t end) {
  const Tag d;
  const float h3 = c.h * c.h * c.h;
  const float value = 4.774648292756860f / (h3 * h3) * c.per_lattice;  // 15 / (pi h^6)
  const float slope = 14.32394487827058f / (h3 * h3) * c.per_lattice;  // 45 / (pi h^6)
  for (std::size_t i = begin; i < end; ++i) {
    Vec sum = hn::Zero(d), squares = sum, gx = sum, gy = sum, gz = sum;
    for_neighbours(c, neighbours, state.place, i,
                   [&](const std::int32_t*, Vec, Vec x, Vec y, Vec z, Vec, Vec gap, Vec per_r) HWY_ATTR {
                     const Vec gap2 = hn::Mul(gap, gap);
                     sum = hn::MulAdd(gap2, gap, sum);
                     squares = hn::MulAdd(gap2, gap2, squares);
                     const Vec along = hn::Mul(gap2, per_r);
                     gx = hn::MulAdd(along, x, gx);
                     gy = hn::MulAdd(along, y, gy);
                     gz = hn::MulAdd(along, z, gz);
                   });
    const Sums slopes = sums_of(gx, gy, gz, sum);
    const float pressed = value * (slopes.of[3] + h3) + state.solid[i] - 1.0f;
    const float x = state.wall_x[i] - slope * slopes.of[0], y = state.wall_y[i] - slope * slopes.of[1],
                z = state.wall_z[i] - slope * slopes.of[2];
    const float steepness = x * x + y * y + z * z + slope * slope * sum_of(squares) + c.relaxation;
    std::copy_n(state.place.data() + 4 * i, 3, state.pressed.data() + 4 * i);
    state.pressed[4 * i + 3] = pressed > 0.0f ? -pressed / steepness : 0.0f;
  }
}

void Change(const PbfConstants& c, const Neighbours& neighbours, PbfState& state, std::size_t begin, std::size_t end) {
  const Tag d;
  const float h3 = c.h * c.h * c.h;
  const float slope = 14.32394487827058f / (h3 * h3) * c.per_lattice;
  const Vec unit = hn::Set(d, 1.0f / (0.8f * c.h)), apart = hn::Set(d, c.apart);
  for (std::size_t i = begin; i < end; ++i) {
    Vec dx = hn::Zero(d), dy = dx, dz = dx;
    const Vec own = hn::Set(d, state.lambda(i));
    for_neighbours(c, neighbours, state.pressed, i,
                   [&](const std::int32_t*, Vec lambda, Vec x, Vec y, Vec z, Vec, Vec gap, Vec per_r) HWY_ATTR {
                     // s_corr = -k (W(r) / W(0.2 h))^4 with the spiky kernel: the twelfth power of the gap.
                     // Where that is less than nothing to a float it stays so, for subnormal numbers are slow.
                     const Vec part = hn::Max(hn::Mul(gap, unit), hn::Set(d, 0.05f));
                     const Vec cube = hn::Mul(part, hn::Mul(part, part)), sixth = hn::Mul(cube, cube);
                     const Vec both = hn::Add(own, lambda);
                     const Vec strength = hn::NegMulAdd(apart, hn::Mul(sixth, sixth), both);
                     const Vec along = hn::Mul(hn::Mul(strength, per_r), hn::Mul(gap, gap));
                     dx = hn::NegMulAdd(along, x, dx);
                     dy = hn::NegMulAdd(along, y, dy);
                     dz = hn::NegMulAdd(along, z, dz);
                   });
    const Sums way = sums_of(dx, dy, dz, hn::Zero(d));
    state.dx[i] = slope * way.of[0];
    state.dy[i] = slope * way.of[1];
    state.dz[i] = slope * way.of[2];
  }
}

void Blend(const PbfConstants& c, const Neighbours& neighbours, PbfState& state, std::size_t begin, std::size_t end) {
  const Tag d;
  const float h2 = c.h * c.h, h6 = h2 * h2 * h2;
  const float value = 1.566681471060845f / (h6 * h2 * c.h) * c.volume * c.blend;  // 315 / (64 pi h^9)
  const float slope = 14.32394487827058f / h6 * c.volume;
  const bool curl = !state.curl_x.empty();
  for (std::size_t i = begin; i < end; ++i) {
    Vec dx = hn::Zero(d), dy = dx, dz = dx, cx = dx, cy = dx, cz = dx;
    const vec3 own = state.velocity_of(i);
    const Vec ux = hn::Set(d, own.x), uy = hn::Set(d, own.y), uz = hn::Set(d, own.z);
    for_neighbours(c, neighbours, state.place, i,
                   [&](const std::int32_t* j, Vec, Vec x, Vec y, Vec z, Vec r2, Vec gap, Vec per_r) HWY_ATTR {
                     const Records motion = load_records<4>(state.velocity.data(), j);
                     const Vec vx = hn::Sub(motion.a, ux), vy = hn::Sub(motion.b, uy), vz = hn::Sub(motion.c, uz);
                     const Vec s = hn::IfThenElseZero(hn::Gt(gap, hn::Zero(d)), hn::Sub(hn::Set(d, h2), r2));
                     const Vec weight = hn::Mul(s, hn::Mul(s, s));
                     dx = hn::MulAdd(weight, vx, dx);
                     dy = hn::MulAdd(weight, vy, dy);
                     dz = hn::MulAdd(weight, vz, dz);
                     if (!curl) return;
                     // omega = sum v_ij x grad_j W, where grad_j W points along x_i - x_j.
                     const Vec along = hn::Mul(hn::Mul(gap, gap), per_r);
                     cx = hn::MulAdd(along, hn::Sub(hn::Mul(vy, z), hn::Mul(vz, y)), cx);
                     cy = hn::MulAdd(along, hn::Sub(hn::Mul(vz, x), hn::Mul(vx, z)), cy);
                     cz = hn::MulAdd(along, hn::Sub(hn::Mul(vx, y), hn::Mul(vy, x)), cz);
                   });
    const Sums way = sums_of(dx, dy, dz, hn::Zero(d));
    state.dx[i] = value * way.of[0];
    state.dy[i] = value * way.of[1];
    state.dz[i] = value * way.of[2];
    if (!curl) continue;
    const Sums turn = sums_of(cx, cy, cz, hn::Zero(d));
    state.curl_x[i] = slope * turn.of[0];
    state.curl_y[i] = slope * turn.of[1];
    state.curl_z[i] = slope * turn.of[2];
    std::copy_n(state.place.data() + 4 * i, 3, state.pressed.data() + 4 * i);
    state.pressed[4 * i + 3] = std::sqrt(state.curl_x[i] * state.curl_x[i] + state.curl_y[i] * state.curl_y[i] +
                                         state.curl_z[i] * state.curl_z[i]);
  }
}

void CurlSlope(const PbfConstants& c, const Neighbours& neighbours, PbfState& state, std::size_t begin,
               std::size_t end) {
  const Tag d;
  const float h3 = c.h * c.h * c.h;
  const float slope = 14.32394487827058f / (h3 * h3) * c.volume;
  for (std::size_t i = begin; i < end; ++i) {
    Vec dx = hn::Zero(d), dy = dx, dz = dx;
    const Vec own = hn::Set(d, state.pressed[4 * i + 3]);
    for_neighbours(c, neighbours, state.pressed, i,
                   [&](const std::int32_t*, Vec curl, Vec x, Vec y, Vec z, Vec, Vec gap, Vec per_r) HWY_ATTR {
                     const Vec rise = hn::Sub(curl, own);
                     const Vec along = hn::Mul(hn::Mul(rise, per_r), hn::Mul(gap, gap));
                     dx = hn::NegMulAdd(along, x, dx);
                     dy = hn::NegMulAdd(along, y, dy);
                     dz = hn::NegMulAdd(along, z, dz);
                   });
    const Sums way = sums_of(dx, dy, dz, hn::Zero(d));
    state.dx[i] = slope * way.of[0];
    state.dy[i] = slope * way.of[1];
    state.dz[i] = slope * way.of[2];
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace meniscus {

HWY_EXPORT(Lambda);
HWY_EXPORT(Change);
HWY_EXPORT(Blend);
HWY_EXPORT(CurlSlope);

void pbf_lambda(const PbfConstants& constants, const Neighbours& neighbours, PbfState& state, std::size_t begin,
                std::size_t end) {
  HWY_DYNAMIC_DISPATCH(Lambda)(constants, neighbours, state, begin, end);
}

void pbf_change(const PbfConstants& constants, const Neighbours& neighbours, PbfState& state, std::size_t begin,
                std::size_t end) {
  HWY_DYNAMIC_DISPATCH(Change)(constants, neighbours, state, begin, end);
}

void pbf_blend(const PbfConstants& constants, const Neighbours& neighbours, PbfState& state, std::size_t begin,
               std::size_t end) {
  HWY_DYNAMIC_DISPATCH(Blend)(constants, neighbours, state, begin, end);
}

void pbf_curl_slope(const PbfConstants& constants, const Neighbours& neighbours, PbfState& state, std::size_t begin,
                    std::size_t end) {
  HWY_DYNAMIC_DISPATCH(CurlSlope)(constants, neighbours, state, begin, end);
}

}  // namespace meniscus
#endif
