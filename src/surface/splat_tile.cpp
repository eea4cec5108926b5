#include "surface/splat_tile.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surface/splat_tile.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "surface/sphere_chord-inl.h"

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = HWY_CAPPED(float, 16);
using Vec = hn::Vec<Tag>;

/// Calls visit(offset in the tile, middle, half, hits) for every vector of pixels that the sphere may cover:
/// the ray runs through the sphere between the distances middle - half and middle + half where `hits`.
template <class Visit>
HWY_INLINE void for_each_chord(const TileRays& rays, const TileSphere& sphere, Visit visit) {
  const Tag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const Vec cx = hn::Set(d, sphere.x), cy = hn::Set(d, sphere.y), cz = hn::Set(d, sphere.z);
  const Vec radius = hn::Set(d, sphere.radius);
  const Vec zero = hn::Zero(d);
  for (int y = sphere.y0; y <= sphere.y1; ++y) {
    const Vec v = hn::Set(d, rays.v0 + static_cast<float>(y) * rays.dv);
    for (int x = sphere.x0 - sphere.x0 % lanes; x <= sphere.x1; x += lanes) {
      const int offset = y * kTileWidth + x;
      const Vec u = hn::MulAdd(hn::Iota(d, static_cast<float>(x)), hn::Set(d, rays.du), hn::Set(d, rays.u0));
      const Vec inverse_length = rays.perspective ? hn::Load(d, rays.inverse_length + offset) : zero;
      const auto [middle, half2] = sphere_chord(rays.perspective, u, v, inverse_length, cx, cy, cz, radius);
      const auto hits = hn::Gt(half2, zero);
      if (hn::AllFalse(d, hits)) continue;
      visit(d, offset, middle, hn::Sqrt(hn::Max(half2, zero)), hits);
    }
  }
}

void splat_chord(const TileRays& rays, const TileSphere& sphere, float* HWY_RESTRICT sum) {
  for_each_chord(rays, sphere, [&](Tag d, int offset, Vec middle, Vec half, auto hits) {
    const Vec near_end = hn::Max(hn::Sub(middle, half), hn::Zero(d));
    const Vec chord = hn::Max(hn::Sub(hn::Add(middle, half), near_end), hn::Zero(d));
    hn::Store(hn::Add(hn::Load(d, sum + offset), hn::IfThenElseZero(hits, chord)), d, sum + offset);
  });
}

}  // namespace

void SplatChord(const TileRays& rays, const TileSphere& sphere, float* sum) { splat_chord(rays, sphere, sum); }

}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace meniscus {

HWY_EXPORT(SplatChord);

void splat_chord_into_tile(const TileRays& rays, const TileSphere& sphere, float* sum) {
  HWY_DYNAMIC_DISPATCH(SplatChord)(rays, sphere, sum);
}

}  // namespace meniscus
#endif
