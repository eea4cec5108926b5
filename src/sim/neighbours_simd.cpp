#include "sim/neighbours.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sim/neighbours_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

std::size_t NearAmong(const Candidates& candidates, const ParticleGrid& grid, std::size_t self, float h2,
                      std::int32_t* index, float* r2, float& least) {
  const HWY_CAPPED(float, 16) d;
  const hn::RebindToSigned<decltype(d)> di;
  const std::size_t lanes = hn::Lanes(d);
  const auto px = hn::Set(d, grid.x()[self]), py = hn::Set(d, grid.y()[self]), pz = hn::Set(d, grid.z()[self]);
  const auto limit = hn::Set(d, h2);
  const auto me = hn::Set(di, static_cast<std::int32_t>(self));
  auto lowest = limit;
  std::size_t count = 0;
  for (std::size_t k = 0; k < candidates.count; k += lanes) {
    const auto x = hn::Sub(hn::LoadU(d, candidates.x.data() + k), px);
    const auto y = hn::Sub(hn::LoadU(d, candidates.y.data() + k), py);
    const auto z = hn::Sub(hn::LoadU(d, candidates.z.data() + k), pz);
    const auto squared = hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
    const auto number = hn::LoadU(di, candidates.index.data() + k);
    const auto near = hn::And(hn::Lt(squared, limit), hn::RebindMask(d, hn::Ne(number, me)));
    lowest = hn::Min(lowest, hn::IfThenElse(near, squared, limit));
    // There is room behind: whole vectors are stored, which costs less than only what was found.
    hn::StoreU(hn::Compress(squared, near), d, r2 + count);
    hn::StoreU(hn::Compress(number, hn::RebindMask(di, near)), di, index + count);
    count += hn::CountTrue(d, near);
  }
  count = HWY_MIN(count, Neighbours::kMost);
  least = hn::GetLane(hn::MinOfLanes(d, lowest));
  for (std::size_t k = 0; k < 16; k += lanes) {
    hn::StoreU(me, di, index + count + k);
    hn::StoreU(limit, d, r2 + count + k);
  }
  return count;
}

}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace meniscus {

HWY_EXPORT(NearAmong);

std::size_t near_among(const Candidates& candidates, const ParticleGrid& grid, std::size_t self, float h2,
                       std::int32_t* index, float* r2, float& least) {
  return HWY_DYNAMIC_DISPATCH(NearAmong)(candidates, grid, self, h2, index, r2, least);
}

}  // namespace meniscus
#endif
