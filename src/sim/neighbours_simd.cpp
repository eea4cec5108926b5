#include "sim/neighbours.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sim/neighbours_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// after highway.h
#include "base/packing-inl.h"

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = HWY_CAPPED(float, 16);
using Vec = hn::Vec<Tag>;

/// How far `v` is outside of low .. high.
HWY_INLINE Vec outside(Vec v, Vec low, Vec high) {
  return hn::Max(hn::Max(hn::Sub(low, v), hn::Sub(v, high)), hn::Zero(Tag()));
}

}  // namespace

void GatherNear(const ParticleGrid& grid, std::size_t begin, std::size_t end, const Bounds& box, float h2,
                Candidates& to) {
  const Tag d;
  const hn::RebindToSigned<Tag> di;
  const std::size_t lanes = hn::Lanes(d);
  const Vec low_x = hn::Set(d, box.low.x), low_y = hn::Set(d, box.low.y), low_z = hn::Set(d, box.low.z);
  const Vec high_x = hn::Set(d, box.high.x), high_y = hn::Set(d, box.high.y), high_z = hn::Set(d, box.high.z);
  const Vec limit = hn::Set(d, h2);
  std::size_t count = to.count;
  for (std::size_t k = begin; k < end; k += lanes) {
    const Vec x = hn::LoadU(d, grid.x() + k), y = hn::LoadU(d, grid.y() + k), z = hn::LoadU(d, grid.z() + k);
    const Vec away_x = outside(x, low_x, high_x), away_y = outside(y, low_y, high_y),
              away_z = outside(z, low_z, high_z);
    // In the order of the search below, so that rounding cannot leave out what that would find.
    const Vec squared = hn::MulAdd(away_x, away_x, hn::MulAdd(away_y, away_y, hn::Mul(away_z, away_z)));
    const auto near = hn::And(hn::Lt(squared, limit), hn::FirstN(d, end - k));
    const Packing packed(d, near);
    hn::StoreU(packed(x), d, to.x.data() + count);
    hn::StoreU(packed(y), d, to.y.data() + count);
    hn::StoreU(packed(z), d, to.z.data() + count);
    hn::StoreU(packed(hn::Iota(di, static_cast<std::int32_t>(k))), di, to.index.data() + count);
    count += hn::CountTrue(d, near);
  }
  to.count = count;
  // What fills the last vector is far away.
  for (std::size_t k = 0; k < 16; k += lanes)
    for (auto* values : {&to.x, &to.y, &to.z}) hn::StoreU(hn::Set(d, 1e18f), d, values->data() + count + k);
}

std::size_t NearAmong(const Candidates& candidates, const ParticleGrid& grid, std::size_t self, float h2,
                      std::int32_t* index, float* r2, bool& coincident) {
  const Tag d;
  const hn::RebindToSigned<Tag> di;
  const std::size_t lanes = hn::Lanes(d);
  const Vec px = hn::Set(d, grid.x()[self]), py = hn::Set(d, grid.y()[self]), pz = hn::Set(d, grid.z()[self]);
  const Vec limit = hn::Set(d, h2);
  const auto me = hn::Set(di, static_cast<std::int32_t>(self));
  std::size_t count = 0;
  for (std::size_t k = 0; k < candidates.count; k += lanes) {
    const Vec x = hn::Sub(hn::LoadU(d, candidates.x.data() + k), px);
    const Vec y = hn::Sub(hn::LoadU(d, candidates.y.data() + k), py);
    const Vec z = hn::Sub(hn::LoadU(d, candidates.z.data() + k), pz);
    const Vec squared = hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
    const auto number = hn::LoadU(di, candidates.index.data() + k);
    const auto near = hn::And(hn::Lt(squared, limit), hn::RebindMask(d, hn::Ne(number, me)));
    // There is room behind: whole vectors are stored, which costs less than only what was found.
    const Packing packed(d, near);
    hn::StoreU(packed(squared), d, r2 + count);
    hn::StoreU(packed(number), di, index + count);
    count += hn::CountTrue(d, near);
  }
  count = HWY_MIN(count, Neighbours::kMost);
  const auto nobody = hn::Set(di, static_cast<std::int32_t>(grid.size()));
  for (std::size_t k = 0; k < 16; k += lanes) {
    hn::StoreU(nobody, di, index + count + k);
    hn::StoreU(hn::Set(d, 4.0f * h2), d, r2 + count + k);
  }
  Vec least = limit;
  for (std::size_t k = 0; k < count; k += lanes) least = hn::Min(least, hn::LoadU(d, r2 + k));
  coincident = !hn::AllFalse(d, hn::Lt(least, hn::Set(d, 1e-8f * h2)));
  return count;
}

}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace meniscus {

HWY_EXPORT(GatherNear);
HWY_EXPORT(NearAmong);

void gather_near(const ParticleGrid& grid, std::size_t begin, std::size_t end, const Bounds& box, float h2,
                 Candidates& to) {
  HWY_DYNAMIC_DISPATCH(GatherNear)(grid, begin, end, box, h2, to);
}

std::size_t near_among(const Candidates& candidates, const ParticleGrid& grid, std::size_t self, float h2,
                       std::int32_t* index, float* r2, bool& coincident) {
  return HWY_DYNAMIC_DISPATCH(NearAmong)(candidates, grid, self, h2, index, r2, coincident);
}

}  // namespace meniscus
#endif
