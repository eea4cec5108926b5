#include "sim/sph.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sim/sph_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "sim/records-inl.h"

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

template <bool kTension>
HWY_INLINE void forces(const SphConstants& c, const Neighbours& neighbours, SphState& state, std::size_t begin,
                       std::size_t end) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  constexpr int kStride = SphState::kStride;
  const float* records = state.records.data();
  const float h = c.h, h2 = h * h, h4 = h2 * h2;
  const Vec support = hn::Set(d, h), support2 = hn::Set(d, h2), zero = hn::Zero(d), tiny = hn::Set(d, 1e-12f * h2);
  const Vec stiffness = hn::Set(d, c.stiffness);
  const float spiky = 14.32394487827058f / (h4 * h2) * c.volume;      // 45 / (pi h^6) volume
  const float poly6 = 9.400088826365070f / (h4 * h4 * h) * c.volume;  // 945 / (32 pi h^9) volume
  for (std::size_t i = begin; i < end; ++i) {
    const NeighbourList list = neighbours.of(i);
    const float* own = records + kStride * i;
    const float inverse = own[3];
    const Vec px = hn::Set(d, own[0]), py = hn::Set(d, own[1]), pz = hn::Set(d, own[2]);
    const Vec ux = hn::Set(d, own[4]), uy = hn::Set(d, own[5]), uz = hn::Set(d, own[6]);
    const Vec own_pressure = hn::Set(d, pressure_over_density2(c.stiffness, inverse));
    const Vec viscous = hn::Set(d, c.kinematic * inverse);
    Vec ax = zero, ay = zero, az = zero, nx = zero, ny = zero, nz = zero, bend = zero;
    for (std::size_t k = 0; k < list.count; k += lanes) {
      const Records place = load_records<kStride>(records, list.index + k);
      const Records motion = load_records<kStride>(records + 4, list.index + k);
      const Vec r2 = hn::LoadU(d, list.r2 + k);
      const Vec dx = hn::Sub(px, place.a), dy = hn::Sub(py, place.b), dz = hn::Sub(pz, place.c), inv = place.d;
      const Vec per_r = reciprocal_root(hn::Max(r2, tiny));
      const Vec gap = hn::Max(hn::NegMulAdd(r2, per_r, support), zero);
      // (p_i / rho_i^2 + p_j / rho_j^2) |grad W| / r
      const Vec pressure = hn::MulAdd(stiffness, hn::Max(hn::NegMulAdd(inv, inv, inv), zero), own_pressure);
      const Vec push = hn::Mul(hn::Mul(pressure, per_r), hn::Mul(gap, gap));
      // mu / (rho_i rho_j) laplacian W
      const Vec drag = hn::Mul(hn::Mul(viscous, inv), gap);
      ax = hn::MulAdd(push, dx, hn::MulAdd(drag, hn::Sub(motion.a, ux), ax));
      ay = hn::MulAdd(push, dy, hn::MulAdd(drag, hn::Sub(motion.b, uy), ay));
      az = hn::MulAdd(push, dz, hn::MulAdd(drag, hn::Sub(motion.c, uz), az));
      if (kTension) {
        const Vec s = hn::Max(hn::Sub(support2, r2), zero);
        const Vec weight = hn::Mul(s, inv);
        const Vec along = hn::Mul(weight, s);
        nx = hn::NegMulAdd(along, dx, nx);
        ny = hn::NegMulAdd(along, dy, ny);
        nz = hn::NegMulAdd(along, dz, nz);
        bend = hn::MulAdd(weight, hn::NegMulAdd(hn::Set(d, 7.0f), r2, hn::Set(d, 3.0f * h2)), bend);
      }
    }
    const Sums pushed = sums_of(ax, ay, az, bend);
    state.ax[i] = spiky * pushed.of[0];
    state.ay[i] = spiky * pushed.of[1];
    state.az[i] = spiky * pushed.of[2];
    if (kTension) {
      const Sums fall = sums_of(nx, ny, nz, zero);
      state.nx[i] = poly6 * fall.of[0];
      state.ny[i] = poly6 * fall.of[1];
      state.nz[i] = poly6 * fall.of[2];
      state.bend[i] = -poly6 * (pushed.of[3] + 3.0f * h4 * inverse);
    }
  }
}

}  // namespace

void Density(const SphConstants& c, const Neighbours& neighbours, SphState& state, std::size_t begin, std::size_t end) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  const float *x = neighbours.grid().x(), *y = neighbours.grid().y(), *z = neighbours.grid().z();
  const float h2 = c.h * c.h;
  const Vec support = hn::Set(d, c.h), tiny = hn::Set(d, 1e-12f * h2);
  const float scale = 4.774648292756860f / (h2 * h2 * h2) * c.per_lattice;  // 15 / (pi h^6)
  for (std::size_t i = begin; i < end; ++i) {
    const NeighbourList list = neighbours.of(i);
    Vec sum = hn::Zero(d);
    for (std::size_t k = 0; k < list.count; k += lanes) {
      const Vec r2 = hn::LoadU(d, list.r2 + k);
      const Vec s = hn::Max(hn::NegMulAdd(r2, reciprocal_root(hn::Max(r2, tiny)), support), hn::Zero(d));
      sum = hn::MulAdd(hn::Mul(s, s), s, sum);
    }
    float* record = state.records.data() + SphState::kStride * i;
    record[0] = x[i];
    record[1] = y[i];
    record[2] = z[i];
    record[3] = 1.0f / (state.solid[i] + scale * (sum_of(sum) + h2 * c.h));
  }
}

void Forces(const SphConstants& c, const Neighbours& neighbours, SphState& state, std::size_t begin, std::size_t end) {
  if (c.tension > 0.0f)
    forces<true>(c, neighbours, state, begin, end);
  else
    forces<false>(c, neighbours, state, begin, end);
}

}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace meniscus {

HWY_EXPORT(Density);
HWY_EXPORT(Forces);

void sph_density(const SphConstants& constants, const Neighbours& neighbours, SphState& state, std::size_t begin,
                 std::size_t end) {
  HWY_DYNAMIC_DISPATCH(Density)(constants, neighbours, state, begin, end);
}

void sph_forces(const SphConstants& constants, const Neighbours& neighbours, SphState& state, std::size_t begin,
                std::size_t end) {
  HWY_DYNAMIC_DISPATCH(Forces)(constants, neighbours, state, begin, end);
}

}  // namespace meniscus
#endif
