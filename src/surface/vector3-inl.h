// Vectors of three components by lanes, and the points seen at pixels; included once for each instruction set, after
// highway.h.

#if defined(MENISCUS_SURFACE_VECTOR3_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MENISCUS_SURFACE_VECTOR3_INL_H_
#undef MENISCUS_SURFACE_VECTOR3_INL_H_
#else
#define MENISCUS_SURFACE_VECTOR3_INL_H_
#endif

#include <hwy/highway.h>

#include "meniscus/base.h"

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = HWY_CAPPED(float, 16);
using Vec = hn::Vec<Tag>;

struct Vec3V {
  Vec x, y, z;
};

HWY_INLINE Vec3V set(vec3 v) {
  const Tag d;
  return {hn::Set(d, v.x), hn::Set(d, v.y), hn::Set(d, v.z)};
}

HWY_INLINE Vec dot(Vec3V a, Vec3V b) { return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z))); }

HWY_INLINE Vec3V scaled(Vec3V a, Vec factor) {
  return {hn::Mul(a.x, factor), hn::Mul(a.y, factor), hn::Mul(a.z, factor)};
}

/// a + factor b
HWY_INLINE Vec3V combined(Vec3V a, Vec factor, Vec3V b) {
  return {hn::MulAdd(factor, b.x, a.x), hn::MulAdd(factor, b.y, a.y), hn::MulAdd(factor, b.z, a.z)};
}

HWY_INLINE Vec3V normalized(Vec3V a) {
  const Tag d;
  return scaled(a, hn::Div(hn::Set(d, 1.0f), hn::Sqrt(hn::Max(dot(a, a), hn::Set(d, 1e-30f)))));
}

template <class Mask>
HWY_INLINE Vec3V either(Mask first, Vec3V a, Vec3V b) {
  return {hn::IfThenElse(first, a.x, b.x), hn::IfThenElse(first, a.y, b.y), hn::IfThenElse(first, a.z, b.z)};
}

/// View::ray() of a perspective or orthographic view by lanes, with the eye as the origin of space.
class PictureRays {
 public:
  explicit PictureRays(const View& view)
      : per_pixel_(2.0f * view.half_height / static_cast<float>(view.height)),
        half_width_(0.5f * static_cast<float>(view.width)),
        half_height_(0.5f * static_cast<float>(view.height)),
        perspective_(view.projection == Projection::perspective),
        right_(set(view.right)),
        up_(set(view.up)),
        forward_(set(view.forward)) {}

  /// @param x, y    picture coordinates, px
  /// @param depth   m along the ray
  /// @param direction  of the ray, unit
  /// @return        the point at that depth, relative to the view's eye
  HWY_INLINE Vec3V point(Vec x, Vec y, Vec depth, Vec3V& direction) const {
    const Tag d;
    const Vec per_pixel = hn::Set(d, per_pixel_);
    const Vec p = hn::Mul(hn::Sub(x, hn::Set(d, half_width_)), per_pixel);
    const Vec q = hn::Mul(hn::Sub(hn::Set(d, half_height_), y), per_pixel);
    const Vec3V offset = combined(scaled(right_, p), q, up_);
    if (perspective_) {
      direction = normalized(combined(offset, hn::Set(d, 1.0f), forward_));
      return scaled(direction, depth);
    }
    direction = forward_;
    return combined(offset, depth, forward_);
  }

 private:
  float per_pixel_, half_width_, half_height_;
  bool perspective_;
  Vec3V right_, up_, forward_;
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#endif
