// Where rays meet a sphere, by lanes; included once for each instruction set, after highway.h.

#if defined(MENISCUS_SURFACE_SPHERE_CHORD_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MENISCUS_SURFACE_SPHERE_CHORD_INL_H_
#undef MENISCUS_SURFACE_SPHERE_CHORD_INL_H_
#else
#define MENISCUS_SURFACE_SPHERE_CHORD_INL_H_
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

/// Part of a ray inside a sphere: between the distances middle - sqrt(half2) and middle + sqrt(half2), m; none where
/// half2 is not positive.
template <class V>
struct SphereChord {
  V middle, half2;
};

/// The chords of the rays of a picture in camera space (SplatCamera).
/// @param u, v            coordinates of the rays
/// @param inverse_length  1 / |(u, v, 1)|; not used where rays are parallel
/// @param cx, cy, cz      centre of the sphere, m
template <class V>
HWY_INLINE SphereChord<V> sphere_chord(bool perspective, V u, V v, V inverse_length, V cx, V cy, V cz, V radius) {
  namespace hn = hwy::HWY_NAMESPACE;
  if (!perspective) {
    const V ox = hn::Sub(cx, u), oy = hn::Sub(cy, v);
    return {cz, hn::MulSub(radius, radius, hn::MulAdd(ox, ox, hn::Mul(oy, oy)))};
  }
  // The part of the centre across the ray is subtracted before it is squared: far away, the difference of two large
  // squares would have no digits left.
  const V dx = hn::Mul(u, inverse_length), dy = hn::Mul(v, inverse_length), dz = inverse_length;
  const V middle = hn::MulAdd(cx, dx, hn::MulAdd(cy, dy, hn::Mul(cz, dz)));
  const V ox = hn::NegMulAdd(middle, dx, cx), oy = hn::NegMulAdd(middle, dy, cy), oz = hn::NegMulAdd(middle, dz, cz);
  return {middle, hn::MulSub(radius, radius, hn::MulAdd(ox, ox, hn::MulAdd(oy, oy, hn::Mul(oz, oz))))};
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#endif
