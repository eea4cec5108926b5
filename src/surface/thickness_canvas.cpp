#include "surface/thickness_canvas.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surface/thickness_canvas.cpp"
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

void points(const SplatCamera& camera, const float* x, const float* y, const float* z, const float* shares,
            float volume, std::size_t count, PointCanvas& canvas) {
  const Tag d;
  const hn::RebindToSigned<Tag> di;
  const std::size_t lanes = hn::Lanes(d);
  alignas(64) std::int32_t at[16];
  alignas(64) float fours[4 * 16];
  const HWY_CAPPED(float, 4) four;
  const Vec zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  const Vec per_du = hn::Set(d, 1.0f / camera.du), per_dv = hn::Set(d, 1.0f / camera.dv);
  const Vec per_area = hn::Set(d, 1.0f / (camera.du * camera.du));
  const Vec first_x = hn::Set(d, camera.u0 / camera.du + static_cast<float>(canvas.rect.x0)),
            first_y = hn::Set(d, camera.v0 / camera.dv + static_cast<float>(canvas.rect.y0));
  const Vec last_x = hn::Set(d, static_cast<float>(canvas.width())),
            last_y = hn::Set(d, static_cast<float>(canvas.height()));
  float* values = canvas.values.data();
  for (std::size_t begin = 0; begin < count; begin += lanes) {
    const std::size_t here = std::min(lanes, count - begin);
    const auto valid = hn::FirstN(d, here);
    const auto load = [&](const float* from) {
      return hn::LoadU(d, from + begin);  // there is room past the end
    };
    const Vec ox = hn::Sub(load(x), hn::Set(d, camera.eye.x)), oy = hn::Sub(load(y), hn::Set(d, camera.eye.y)),
              oz = hn::Sub(load(z), hn::Set(d, camera.eye.z));
    const auto along = [&](vec3 axis) {
      return hn::MulAdd(ox, hn::Set(d, axis.x), hn::MulAdd(oy, hn::Set(d, axis.y), hn::Mul(oz, hn::Set(d, axis.z))));
    };
    Vec u = along(camera.right), v = along(camera.up);
    Vec water = hn::Mul(hn::Set(d, volume), per_area);
    if (shares != nullptr) water = hn::Mul(water, load(shares));
    const Vec depth = along(camera.forward);
    if (camera.perspective) {
      // A sample's beam has the area du^2 z^2 / |(u, v, 1)| across the ray.
      const Vec per_z = hn::Div(one, depth);
      u = hn::Mul(u, per_z);
      v = hn::Mul(v, per_z);
      const Vec length = hn::Sqrt(hn::MulAdd(u, u, hn::MulAdd(v, v, one)));
      water = hn::Mul(hn::Mul(water, length), hn::Mul(per_z, per_z));
    }
    water = hn::IfThenElseZero(hn::And(valid, hn::Gt(depth, zero)), water);
    // Sample coordinates in the canvas, from -1 to its size: what falls beside goes to its rim.
    const Vec px = hn::MulSub(u, per_du, first_x), py = hn::MulSub(v, per_dv, first_y);
    const Vec ix = hn::Floor(px), iy = hn::Floor(py);
    const auto within = hn::And(hn::And(hn::Ge(ix, hn::Set(d, -1.0f)), hn::Lt(ix, last_x)),
                                hn::And(hn::Ge(iy, hn::Set(d, -1.0f)), hn::Lt(iy, last_y)));
    water = hn::IfThenElseZero(within, water);
    const Vec fx = hn::Sub(px, ix), fy = hn::Sub(py, iy);
    const Vec lower = hn::Mul(water, fy), upper = hn::Sub(water, lower);
    const Vec upper_right = hn::Mul(upper, fx), lower_right = hn::Mul(lower, fx);
    hn::StoreInterleaved4(hn::Sub(upper, upper_right), upper_right, hn::Sub(lower, lower_right), lower_right, d, fours);
    const auto column = hn::ConvertTo(di, hn::IfThenElseZero(within, hn::Add(ix, one)));
    const auto row = hn::ConvertTo(di, hn::IfThenElseZero(within, hn::Add(iy, one)));
    hn::Store(hn::Add(hn::Mul(row, hn::Set(di, canvas.pitch)), column), di, at);
    for (std::size_t l = 0; l < here; ++l)
      for (std::size_t k = 0; k < 4; k += hn::Lanes(four)) {
        float* to = values + 4 * static_cast<std::ptrdiff_t>(at[l]) + k;
        hn::StoreU(hn::Add(hn::LoadU(four, to), hn::LoadU(four, fours + 4 * l + k)), four, to);
      }
  }
}

void sums(const PointCanvas& points, ThicknessCanvas& canvas) {
  const Tag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const int x0 = points.rect.x0 - canvas.rect.x0, y0 = points.rect.y0 - canvas.rect.y0;
  for (int y = 0; y <= points.height(); ++y) {
    const float* from = points.values.data() + 4 * static_cast<std::ptrdiff_t>(y) * points.pitch;
    float *upper = canvas.row(y0 + y - 1) + x0 - 1, *lower = canvas.row(y0 + y) + x0 - 1;
    for (int x = 0; x <= points.width(); x += lanes) {
      Vec here, right, below, across;
      hn::LoadInterleaved4(d, from + 4 * x, here, right, below, across);
      const auto valid = hn::FirstN(d, static_cast<std::size_t>(std::min(lanes, points.width() + 1 - x)));
      const auto add = [&](float* to, Vec more) {
        hn::StoreU(hn::Add(hn::LoadU(d, to), hn::IfThenElseZero(valid, more)), d, to);
      };
      add(upper + x, here);
      add(upper + x + 1, right);
      add(lower + x, below);
      add(lower + x + 1, across);
    }
  }
}

/// Calls visit(values, u, v, valid lanes) for vectors of the samples of the rectangle that the canvas holds.
template <class Visit>
HWY_INLINE void for_each_vector(const SplatCamera& camera, const SampleRect& rect, ThicknessCanvas& canvas,
                                Visit visit) {
  const Tag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const int x0 = std::max(rect.x0, canvas.rect.x0), x1 = std::min(rect.x1, canvas.rect.x1);
  const int y0 = std::max(rect.y0, canvas.rect.y0), y1 = std::min(rect.y1, canvas.rect.y1);
  for (int y = y0; y <= y1; ++y) {
    const Vec v = hn::Set(d, camera.v0 + static_cast<float>(y) * camera.dv);
    float* row = canvas.row(y - canvas.rect.y0) - canvas.rect.x0;
    for (int x = x0; x <= x1; x += lanes) {
      const Vec u = hn::MulAdd(hn::Iota(d, static_cast<float>(x)), hn::Set(d, camera.du), hn::Set(d, camera.u0));
      visit(row + x, u, v, hn::FirstN(d, static_cast<std::size_t>(std::min(lanes, x1 - x + 1))));
    }
  }
}

template <class Valid>
HWY_INLINE void add_to(float* values, Vec water, Valid valid) {
  const Tag d;
  // Not masked: the canvas is one thread's, and there is room past its end.
  hn::StoreU(hn::Add(hn::LoadU(d, values), hn::IfThenElseZero(valid, water)), d, values);
}

void sphere(const SplatCamera& camera, vec3 centre, float radius, float weight, ThicknessCanvas& canvas) {
  const Tag d;
  const vec3 c = camera.to_camera(centre);
  const SampleRect rect = samples_of(camera, {centre, vec3{radius}});
  if (rect.empty()) return;
  const Vec cx = hn::Set(d, c.x), cy = hn::Set(d, c.y), cz = hn::Set(d, c.z), zero = hn::Zero(d);
  for_each_vector(camera, rect, canvas, [&](float* values, Vec u, Vec v, auto valid) {
    const Vec one = hn::Set(d, 1.0f), inverse_length = hn::Div(one, hn::Sqrt(hn::MulAdd(u, u, hn::MulAdd(v, v, one))));
    const auto [middle, half2] = sphere_chord(camera.perspective, u, v, inverse_length, cx, cy, cz, hn::Set(d, radius));
    const Vec half = hn::Sqrt(hn::Max(half2, zero));
    const Vec chord = hn::Sub(hn::Max(hn::Add(middle, half), zero), hn::Max(hn::Sub(middle, half), zero));
    add_to(values, hn::Mul(chord, hn::Set(d, weight)), valid);
  });
}

/// Length of the part of the ray that lies inside the box at `offset` from the eye and before it.
HWY_INLINE Vec chord_of(const SplatCamera& camera, vec3 offset, vec3 half, Vec u, Vec v) {
  const Tag d;
  // By the parameter t of origin + t direction, where direction is not a unit vector: forward goes by one.
  Vec low = hn::Zero(d), high = hn::Set(d, 1e30f);
  for (int axis = 0; axis < 3; ++axis) {
    const Vec across = hn::MulAdd(u, hn::Set(d, camera.right[axis]), hn::Mul(v, hn::Set(d, camera.up[axis])));
    const Vec forward = hn::Set(d, camera.forward[axis]);
    Vec direction = camera.perspective ? hn::Add(across, forward) : forward;
    const Vec middle = camera.perspective ? hn::Set(d, offset[axis]) : hn::Sub(hn::Set(d, offset[axis]), across);
    // A ray along the box's side: any steep slope tells inside from outside.
    direction = hn::IfThenElse(hn::Lt(hn::Abs(direction), hn::Set(d, 1e-12f)), hn::Set(d, 1e-12f), direction);
    const Vec slope = hn::Div(hn::Set(d, 1.0f), direction);
    const Vec at = hn::Mul(middle, slope), reach = hn::Abs(hn::Mul(hn::Set(d, half[axis]), slope));
    low = hn::Max(low, hn::Sub(at, reach));
    high = hn::Min(high, hn::Add(at, reach));
  }
  const Vec chord = hn::Max(hn::Sub(high, low), hn::Zero(d));
  if (!camera.perspective) return chord;
  return hn::Mul(chord, hn::Sqrt(hn::MulAdd(u, u, hn::MulAdd(v, v, hn::Set(d, 1.0f)))));
}

void box(const SplatCamera& camera, const SplatBox& box, float weight, float edge, ThicknessCanvas& canvas) {
  const Tag d;
  const bool steep = edge > 0.0f;
  const vec3 offset = box.middle - camera.eye;
  const float depth = camera.perspective ? std::max(glm::dot(offset, camera.forward), 0.0f) : 1.0f;
  const float width = depth > edge || !camera.perspective ? std::max(camera.du, edge / depth) : camera.du;
  SplatBox around = box;
  if (steep)
    around.half += 0.5f * width * (depth + (camera.perspective ? glm::dot(box.half, glm::abs(camera.forward)) : 0.0f));
  const SampleRect rect = samples_of(camera, around);
  if (rect.empty()) return;
  for_each_vector(camera, rect, canvas, [&](float* values, Vec u, Vec v, auto valid) {
    if (!steep) {
      add_to(values, hn::Mul(chord_of(camera, offset, box.half, u, v), hn::Set(d, weight)), valid);
      return;
    }
    // Where sides are seen edge on, a sample is the mean of eight places, no two in a row or column.
    constexpr int kPlaces = 8;
    const auto off = [&](int place) {
      return width * ((static_cast<float>(place) + 0.5f) / static_cast<float>(kPlaces) - 0.5f);
    };
    Vec sum = hn::Zero(d);
    for (int k = 0; k < kPlaces; ++k)
      sum = hn::Add(sum, chord_of(camera, offset, box.half, hn::Add(u, hn::Set(d, off(k))),
                                  hn::Add(v, hn::Set(d, off(3 * k % kPlaces)))));
    add_to(values, hn::Mul(sum, hn::Set(d, weight / static_cast<float>(kPlaces))), valid);
  });
}

}  // namespace

void AddPoints(const SplatCamera& camera, const float* x, const float* y, const float* z, const float* shares,
               float volume, std::size_t count, PointCanvas& canvas) {
  points(camera, x, y, z, shares, volume, count, canvas);
}
void AddSums(const PointCanvas& points, ThicknessCanvas& canvas) { sums(points, canvas); }
void AddSphere(const SplatCamera& camera, vec3 centre, float radius, float weight, ThicknessCanvas& canvas) {
  sphere(camera, centre, radius, weight, canvas);
}
void AddBox(const SplatCamera& camera, const SplatBox& one, float weight, float edge, ThicknessCanvas& canvas) {
  box(camera, one, weight, edge, canvas);
}

}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace meniscus {

HWY_EXPORT(AddPoints);
HWY_EXPORT(AddSums);
HWY_EXPORT(AddSphere);
HWY_EXPORT(AddBox);

void ThicknessCanvas::start(const SampleRect& samples) {
  rect = samples;
  if (rect.empty()) return;
  pitch = width() + 2;
  values.assign(static_cast<std::size_t>(pitch) * static_cast<std::size_t>(height() + 2) + 16, 0.0f);
}

void PointCanvas::start(const SampleRect& samples) {
  rect = samples;
  pitch = width() + 1;
  values.assign(4 * (static_cast<std::size_t>(pitch) * static_cast<std::size_t>(height() + 1) + 16), 0.0f);
}

void add_sums(const PointCanvas& points, ThicknessCanvas& canvas) { HWY_DYNAMIC_DISPATCH(AddSums)(points, canvas); }
void add_points(const SplatCamera& camera, const float* x, const float* y, const float* z, const float* shares,
                std::size_t count, float volume, PointCanvas& canvas) {
  HWY_DYNAMIC_DISPATCH(AddPoints)(camera, x, y, z, shares, volume, count, canvas);
}
void add_sphere(const SplatCamera& camera, vec3 centre, float radius, float weight, ThicknessCanvas& canvas) {
  HWY_DYNAMIC_DISPATCH(AddSphere)(camera, centre, radius, weight, canvas);
}
void add_box(const SplatCamera& camera, const SplatBox& box, float weight, float edge, ThicknessCanvas& canvas) {
  HWY_DYNAMIC_DISPATCH(AddBox)(camera, box, weight, edge, canvas);
}

}  // namespace meniscus
#endif
