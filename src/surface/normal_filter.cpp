#include "surface/normal_filter.h"

#include <cmath>

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surface/normal_filter.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// after highway.h
#include <hwy/contrib/math/math-inl.h>

#ifndef MENISCUS_SURFACE_NORMAL_FILTER_PLANES
#define MENISCUS_SURFACE_NORMAL_FILTER_PLANES
namespace meniscus {
namespace {

/// One component after another, with a border as wide as the window so that no tap leaves the arrays.
struct Planes {
  std::vector<float> px, py, pz, nx, ny, nz;
  std::size_t pitch = 0;
};

struct FilterRow {
  const Planes* planes;
  std::size_t start;  ///< index of the row's first pixel in the planes
  int width;
  int radius;
  float tolerance;
  const float* spatial;  ///< (2 radius + 1)^2 values of -r^2 / (2 sigma^2)
};

}  // namespace
}  // namespace meniscus
#endif

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = HWY_CAPPED(float, 16);
using Vec = hn::Vec<Tag>;

/// exp(v) for v <= 0 to 2e-5 relative: (1 + v / 1024 + v^2 / (2 1024^2))^1024, and 0 below -60.
HWY_INLINE Vec exponential(Vec v) {
  const Tag d;
  const Vec one = hn::Set(d, 1.0f);
  const Vec small = hn::Mul(hn::Max(v, hn::Set(d, -60.0f)), hn::Set(d, 1.0f / 1024.0f));
  Vec e = hn::MulAdd(small, hn::MulAdd(small, hn::Set(d, 0.5f), one), one);
  for (int i = 0; i < 10; ++i) e = hn::Mul(e, e);
  return hn::IfThenElseZero(hn::Gt(v, hn::Set(d, -60.0f)), e);
}

}  // namespace

/// Filters one row; out_x .. hold width values rounded up to a multiple of 16.
void FilterNormalRow(const FilterRow& row, float* out_x, float* out_y, float* out_z) {
  const Tag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const Planes& planes = *row.planes;
  const Vec by_tolerance = hn::Set(d, -0.5f / (row.tolerance * row.tolerance));
  const Vec by_sharpness = hn::Set(d, 1.0f / kNormalSharpness);
  const Vec one = hn::Set(d, 1.0f);
  for (int x = 0; x < row.width; x += lanes) {
    const std::size_t centre = row.start + static_cast<std::size_t>(x);
    const Vec nx = hn::LoadU(d, &planes.nx[centre]), ny = hn::LoadU(d, &planes.ny[centre]),
              nz = hn::LoadU(d, &planes.nz[centre]);
    Vec sum_x = nx, sum_y = ny, sum_z = nz;
    if (hn::AllTrue(d, hn::Eq(hn::MulAdd(nx, nx, hn::MulAdd(ny, ny, hn::Mul(nz, nz))), hn::Zero(d)))) {
      hn::StoreU(sum_x, d, out_x + x);
      hn::StoreU(sum_y, d, out_y + x);
      hn::StoreU(sum_z, d, out_z + x);
      continue;
    }
    const Vec px = hn::LoadU(d, &planes.px[centre]), py = hn::LoadU(d, &planes.py[centre]),
              pz = hn::LoadU(d, &planes.pz[centre]);
    const float* spatial = row.spatial;
    for (int dy = -row.radius; dy <= row.radius; ++dy) {
      std::size_t tap = centre + static_cast<std::size_t>(dy) * planes.pitch - static_cast<std::size_t>(row.radius);
      for (int dx = -row.radius; dx <= row.radius; ++dx, ++tap, ++spatial) {
        if (dx == 0 && dy == 0) continue;
        const Vec qx = hn::LoadU(d, &planes.nx[tap]), qy = hn::LoadU(d, &planes.ny[tap]),
                  qz = hn::LoadU(d, &planes.nz[tap]);
        const Vec off_plane = hn::MulAdd(nx, hn::Sub(hn::LoadU(d, &planes.px[tap]), px),
                                         hn::MulAdd(ny, hn::Sub(hn::LoadU(d, &planes.py[tap]), py),
                                                    hn::Mul(nz, hn::Sub(hn::LoadU(d, &planes.pz[tap]), pz))));
        const Vec agreement = hn::MulAdd(nx, qx, hn::MulAdd(ny, qy, hn::Mul(nz, qz)));
        Vec exponent = hn::MulAdd(hn::Mul(off_plane, off_plane), by_tolerance, hn::Set(d, *spatial));
        exponent = hn::MulAdd(hn::Sub(agreement, one), by_sharpness, exponent);
        const Vec weight = exponential(exponent);
        sum_x = hn::MulAdd(weight, qx, sum_x);
        sum_y = hn::MulAdd(weight, qy, sum_y);
        sum_z = hn::MulAdd(weight, qz, sum_z);
      }
    }
    const Vec size2 = hn::MulAdd(sum_x, sum_x, hn::MulAdd(sum_y, sum_y, hn::Mul(sum_z, sum_z)));
    const Vec norm = hn::Div(one, hn::Sqrt(hn::Max(size2, hn::Set(d, 1e-20f))));
    hn::StoreU(hn::Mul(sum_x, norm), d, out_x + x);
    hn::StoreU(hn::Mul(sum_y, norm), d, out_y + x);
    hn::StoreU(hn::Mul(sum_z, norm), d, out_z + x);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace meniscus {

HWY_EXPORT(FilterNormalRow);

Image<vec3> filtered_normals(const View& view, const Image<float>& depth, const Image<vec3>& normals, int radius,
                             float tolerance) {
  constexpr std::size_t kVector = 16;
  constexpr float kNoSurface = 1e15f;  // so far off every plane that the weight is zero
  const int width = depth.width(), height = depth.height();
  const auto border = static_cast<std::size_t>(radius);
  Planes planes;
  planes.pitch = static_cast<std::size_t>(width) + 2 * border + kVector;
  const std::size_t size = planes.pitch * (static_cast<std::size_t>(height) + 2 * border) + kVector;
  const auto row_start = [&](std::size_t y) { return (y + border) * planes.pitch + border; };
  for (auto* plane : {&planes.px, &planes.py, &planes.pz}) plane->resize(size, kNoSurface);
  for (auto* plane : {&planes.nx, &planes.ny, &planes.nz}) plane->resize(size, 0.0f);
  parallel_for(static_cast<std::size_t>(height), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y)
      for (int x = 0; x < width; ++x) {
        const float t = depth(x, static_cast<int>(y));
        if (!(t < std::numeric_limits<float>::infinity())) continue;
        const Ray ray = view.ray({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
        const vec3 point = ray.origin - view.eye + t * ray.direction;
        const vec3 normal = normals(x, static_cast<int>(y));
        const std::size_t at = row_start(y) + static_cast<std::size_t>(x);
        planes.px[at] = point.x;
        planes.py[at] = point.y;
        planes.pz[at] = point.z;
        planes.nx[at] = normal.x;
        planes.ny[at] = normal.y;
        planes.nz[at] = normal.z;
      }
  });
  const float sigma = 0.5f * static_cast<float>(radius);
  std::vector<float> spatial;
  for (int dy = -radius; dy <= radius; ++dy)
    for (int dx = -radius; dx <= radius; ++dx)
      spatial.push_back(-0.5f * static_cast<float>(dx * dx + dy * dy) / (sigma * sigma));
  Image<vec3> filtered(width, height, vec3{0});
  parallel_for(static_cast<std::size_t>(height), 8, [&](std::size_t begin, std::size_t end) {
    const std::size_t padded = (static_cast<std::size_t>(width) + kVector - 1) / kVector * kVector;
    std::vector<float> x_row(padded), y_row(padded), z_row(padded);
    for (std::size_t y = begin; y < end; ++y) {
      HWY_DYNAMIC_DISPATCH(FilterNormalRow)
      (FilterRow{&planes, row_start(y), width, radius, tolerance, spatial.data()}, x_row.data(), y_row.data(),
       z_row.data());
      for (int x = 0; x < width; ++x) {
        const auto i = static_cast<std::size_t>(x);
        if (depth(x, static_cast<int>(y)) < std::numeric_limits<float>::infinity())
          filtered(x, static_cast<int>(y)) = {x_row[i], y_row[i], z_row[i]};
      }
    }
  });
  return filtered;
}

}  // namespace meniscus
#endif
