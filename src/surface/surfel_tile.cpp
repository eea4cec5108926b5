// Discs met by the rays of a tile, one vector of neighbouring samples at a time [Iwasaki2008] 5.2.
#include "surface/surfel_tile.h"

#include <algorithm>

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surface/surfel_tile.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// after highway.h
#include <hwy/contrib/math/math-inl.h>

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = HWY_CAPPED(float, 16);
using Vec = hn::Vec<Tag>;
using Mask = hn::Mask<Tag>;

/// Three values a lane; a disc's are the same in all lanes.
struct Vec3 {
  Vec x, y, z;
};
HWY_INLINE Vec3 all(vec3 v) {
  const Tag d;
  return {hn::Set(d, v.x), hn::Set(d, v.y), hn::Set(d, v.z)};
}
HWY_INLINE Vec dot(const Vec3& a, const Vec3& b) {
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}

struct Disc {
  HWY_INLINE explicit Disc(const SurfelDisc& disc)
      : centre(all(disc.centre)),
        normal(all(disc.normal)),
        straight(all(disc.straight)),
        skew(all(disc.skew)),
        radius2(hn::Set(Tag(), disc.radius2)),
        falloff(hn::Set(Tag(), -2.0f / disc.radius2)) {}
  HWY_INLINE Vec3 bent(const Vec3& v) const {
    return {hn::MulAdd(straight.x, v.x, hn::MulAdd(skew.z, v.y, hn::Mul(skew.y, v.z))),
            hn::MulAdd(straight.y, v.y, hn::MulAdd(skew.z, v.x, hn::Mul(skew.x, v.z))),
            hn::MulAdd(straight.z, v.z, hn::MulAdd(skew.y, v.x, hn::Mul(skew.x, v.y)))};
  }
  Vec3 centre, normal, straight, skew;
  Vec radius2, falloff;
};

struct Meeting {
  Mask met;
  Vec depth;  ///< in lengths of the direction
  Vec r2;     ///< m^2, from the disc's centre
  Vec3 from_centre;
};

/// From the place w of the ray that is nearest to the centre, q = w + t d with a t^2 + b t + c = 0; the root in the
/// form that holds for a flat disc, too, on the side that faces the eye.
template <bool kPerspective>
HWY_INLINE Meeting meet(const Disc& disc, Vec x, Vec y, Vec length, Vec per_length2) {
  const Tag d;
  const Vec zero = hn::Zero(d), one = hn::Set(d, 1.0f), half = hn::Set(d, 0.5f);
  const Vec length2 = hn::Mul(length, length);
  Vec nearest;
  Vec3 w, bent_direction, direction;
  if (kPerspective) {
    direction = {x, y, one};
    nearest = hn::Mul(dot(disc.centre, direction), per_length2);
    w = {hn::MulSub(nearest, x, disc.centre.x), hn::MulSub(nearest, y, disc.centre.y), hn::Sub(nearest, disc.centre.z)};
    bent_direction = disc.bent(direction);
  } else {
    direction = {zero, zero, one};
    nearest = disc.centre.z;
    w = {hn::Sub(x, disc.centre.x), hn::Sub(y, disc.centre.y), zero};
    bent_direction = {disc.skew.y, disc.skew.x, disc.straight.z};
  }
  const Vec w2 = dot(w, w);
  const Vec two_a = dot(direction, bent_direction);
  const Vec b = hn::Add(dot(disc.normal, direction), dot(w, bent_direction));
  const Vec c = hn::MulAdd(half, dot(w, disc.bent(w)), dot(disc.normal, w));
  const Vec root2 = hn::NegMulAdd(hn::Add(two_a, two_a), c, hn::Mul(b, b));
  const Vec below = hn::Sub(hn::Sqrt(hn::Max(root2, zero)), b);
  const Vec t = hn::Div(hn::Add(c, c), hn::Max(below, hn::Set(d, 1e-6f)));
  Meeting meeting;
  meeting.r2 = hn::MulAdd(hn::Mul(t, t), length2, w2);
  meeting.depth = hn::Add(nearest, t);
  meeting.met = hn::And(hn::And(hn::Ge(root2, zero), hn::Gt(below, hn::Set(d, 1e-6f))),
                        hn::And(hn::Le(meeting.r2, disc.radius2), hn::Gt(meeting.depth, zero)));
  meeting.from_centre = {hn::MulAdd(t, direction.x, w.x), hn::MulAdd(t, direction.y, w.y),
                         hn::MulAdd(t, direction.z, w.z)};
  return meeting;
}

/// Calls visit(disc, first sample, number of them) for the rows of the tile that each disc may cover.
template <class Visit>
HWY_INLINE void for_each_run(const SurfelTile& tile, const SurfelSamples& samples, Visit visit) {
  for (const std::uint32_t index : tile.mine) {
    const SurfelDisc& given = tile.discs[index];
    const Disc disc(given);
    const int x0 = std::max(given.x0 - tile.x0, 0), x1 = std::min(given.x1 - tile.x0, kSurfelTile - 1);
    const int y0 = std::max(given.y0 - tile.y0, 0), y1 = std::min(given.y1 - tile.y0, kSurfelTile - 1);
    for (int y = y0; y <= y1; ++y) {
      const std::uint32_t begin = samples.start[y * kSurfelTile + x0], end = samples.start[y * kSurfelTile + x1 + 1];
      visit(given, disc, begin, end);
    }
  }
}

template <bool kPerspective>
HWY_INLINE void find_nearest(const SurfelTile& tile, const SurfelSamples& samples) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  for_each_run(tile, samples, [&](const SurfelDisc&, const Disc& disc, std::size_t i, std::size_t end) HWY_ATTR {
    for (; i < end; i += lanes) {
      const Meeting meeting =
          meet<kPerspective>(disc, hn::LoadU(d, samples.x + i), hn::LoadU(d, samples.y + i),
                             hn::LoadU(d, samples.length + i), hn::LoadU(d, samples.per_length2 + i));
      const Mask met = hn::And(meeting.met, hn::FirstN(d, end - i));
      const Vec nearest = hn::LoadU(d, samples.nearest + i), last = hn::LoadU(d, samples.last + i);
      hn::StoreU(hn::IfThenElse(met, hn::Min(nearest, meeting.depth), nearest), d, samples.nearest + i);
      hn::StoreU(hn::IfThenElse(met, hn::Max(last, meeting.depth), last), d, samples.last + i);
    }
  });
}

template <bool kPerspective, bool kOwnNormals>
HWY_INLINE void sum_near(const SurfelTile& tile, const SurfelSamples& samples) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  const Vec epsilon = hn::Set(d, tile.epsilon);
  const auto add = [&](Vec value, float* at) HWY_ATTR { hn::StoreU(hn::Add(value, hn::LoadU(d, at)), d, at); };
  for_each_run(tile, samples, [&](const SurfelDisc& given, const Disc& disc, std::size_t i, std::size_t end) HWY_ATTR {
    for (; i < end; i += lanes) {
      const Vec length = hn::LoadU(d, samples.length + i);
      const Meeting meeting = meet<kPerspective>(disc, hn::LoadU(d, samples.x + i), hn::LoadU(d, samples.y + i), length,
                                                 hn::LoadU(d, samples.per_length2 + i));
      const Vec behind = hn::Mul(hn::Sub(meeting.depth, hn::LoadU(d, samples.nearest + i)), length);
      const Mask counts = hn::And(hn::And(meeting.met, hn::Le(behind, epsilon)), hn::FirstN(d, end - i));
      if (hn::AllFalse(d, counts)) continue;
      const Vec exponent = hn::Mul(disc.falloff, meeting.r2);
      const Vec weight = hn::IfThenElseZero(counts, hn::Exp(d, hn::Max(exponent, hn::Set(d, -2.0f))));
      Vec3 normal;
      if (kOwnNormals) {
        normal = disc.bent(meeting.from_centre);
        normal = {hn::Add(normal.x, disc.normal.x), hn::Add(normal.y, disc.normal.y), hn::Add(normal.z, disc.normal.z)};
      } else {
        normal = all(given.shaded);
      }
      add(hn::Mul(weight, normal.x), samples.nx + i);
      add(hn::Mul(weight, normal.y), samples.ny + i);
      add(hn::Mul(weight, normal.z), samples.nz + i);
      add(hn::Mul(weight, hn::Mul(meeting.depth, length)), samples.depth + i);
      add(weight, samples.weight + i);
    }
  });
}

}  // namespace

void DrawSurfels(const SurfelTile& tile, const SurfelSamples& samples) {
  if (tile.perspective) {
    find_nearest<true>(tile, samples);
    tile.own_normals ? sum_near<true, true>(tile, samples) : sum_near<true, false>(tile, samples);
  } else {
    find_nearest<false>(tile, samples);
    tile.own_normals ? sum_near<false, true>(tile, samples) : sum_near<false, false>(tile, samples);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace meniscus {

HWY_EXPORT(DrawSurfels);

void draw_surfels(const SurfelTile& tile, const SurfelSamples& samples) {
  HWY_DYNAMIC_DISPATCH(DrawSurfels)(tile, samples);
}

}  // namespace meniscus
#endif
