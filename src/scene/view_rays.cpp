#include "scene/view_rays.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "scene/view_rays.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

void ViewRays(const View& view, const BlockPixels& pixels, RayBlock& rays) {
  const HWY_CAPPED(float, 16) d;
  const bool perspective = view.projection == Projection::perspective;
  const float scale = 2.0f * view.half_height / static_cast<float>(view.height);
  const auto middle_x = hn::Set(d, 0.5f * static_cast<float>(view.width)),
             middle_y = hn::Set(d, 0.5f * static_cast<float>(view.height));
  for (std::size_t i = 0; i < static_cast<std::size_t>(rays.count); i += hn::Lanes(d)) {
    const auto x = hn::Mul(hn::Sub(hn::Load(d, pixels.x + i), middle_x), hn::Set(d, scale));
    const auto y = hn::Mul(hn::Sub(middle_y, hn::Load(d, pixels.y + i)), hn::Set(d, scale));
    // Where the points lie: on the plane at distance 1, or on the plane of the eye.
    auto square = hn::Zero(d);
    for (int axis = 0; axis < 3; ++axis) {
      const auto offset = hn::Add(hn::Mul(x, hn::Set(d, view.right[axis])), hn::Mul(y, hn::Set(d, view.up[axis])));
      const auto from = hn::Set(d, view.eye[axis]), forward = hn::Set(d, view.forward[axis]);
      const auto way = perspective ? hn::Add(forward, offset) : forward;
      hn::Store(perspective ? from : hn::Add(from, offset), d, rays.origin[axis] + i);
      hn::Store(way, d, rays.direction[axis] + i);
      square = hn::Add(square, hn::Mul(way, way));
    }
    if (!perspective) continue;
    const auto inverse = hn::Div(hn::Set(d, 1.0f), hn::Sqrt(square));
    for (auto& direction : rays.direction.at) hn::Store(hn::Mul(hn::Load(d, direction + i), inverse), d, direction + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace meniscus {

HWY_EXPORT(ViewRays);

void view_rays(const View& view, BlockPixels& pixels, int count, RayBlock& rays) {
  rays.count = count;
  if (view.projection == Projection::cube) {
    // Neighbours may lie on different faces.
    for (int lane = 0; lane < count; ++lane) rays.set(lane, view.ray({pixels.x[lane], pixels.y[lane]}));
    rays.close(count);
    return;
  }
  for (int lane = count; lane % 16 != 0; ++lane) {
    pixels.x[lane] = pixels.x[count - 1];
    pixels.y[lane] = pixels.y[count - 1];
  }
  HWY_DYNAMIC_DISPATCH(ViewRays)(view, pixels, rays);
}

}  // namespace meniscus
#endif
