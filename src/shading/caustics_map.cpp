#include "shading/caustics_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace meniscus {
namespace {

/// Over this part of a pixel behind the water light goes over from all to none, so that its waterline is no stairs.
constexpr float kSoftDepth = 1.0f;

/// Weights of a cubic B-spline on four values, t in [0, 1) from the second.
std::array<float, 4> spline(float t) {
  const float u = 1.0f - t;
  return {u * u * u / 6.0f, (4.0f - 6.0f * t * t + 3.0f * t * t * t) / 6.0f,
          (4.0f - 6.0f * u * u + 3.0f * u * u * u) / 6.0f, t * t * t / 6.0f};
}

}  // namespace

CausticsMap::CausticsMap(const View& view, Image<vec3> seen, Image<vec3> behind, SceneMap solids)
    : view_(view), seen_(std::move(seen)), behind_(std::move(behind)), solids_(std::move(solids)) {
  const float pixel = view.pixel_size(0.0f), per_area = 1.0f / (pixel * pixel);
  for (vec3& texel : seen_) texel *= per_area;
  for (vec3& texel : behind_) texel *= per_area;
  scale_ = pixel / solids_.view.pixel_size(0.0f);
  const vec3 corner = solids_.view.project(view_.ray({0.0f, 0.0f}).origin);
  first_ = {corner.x, corner.y};
}

vec3 CausticsMap::power() const {
  glm::dvec3 sum{0.0};
  for (const vec3& texel : seen_) sum += glm::dvec3(texel);
  for (const vec3& texel : behind_) sum += glm::dvec3(texel);
  const double pixel = static_cast<double>(view_.pixel_size(0.0f));
  return vec3(sum * pixel * pixel);
}

vec3 CausticsMap::irradiance(vec3 point, vec3 normal) const {
  const float cosine = facing(normal);
  if (!(cosine > 0)) return vec3{0.0f};
  const vec3 at = view_.project(point);
  const float x = at.x - 0.5f, y = at.y - 0.5f;
  if (!(x > -1.0f && y > -1.0f && x < static_cast<float>(view_.width) && y < static_cast<float>(view_.height)))
    return vec3{0.0f};
  const int i = static_cast<int>(std::floor(x)), j = static_cast<int>(std::floor(y));
  const float s = x - static_cast<float>(i), t = y - static_cast<float>(j);
  // Each texel's own layer: light of what stands before the point is not taken for its own.
  const float before = at.z - solids_.bias(normal);
  const auto texel = [&](int u, int v) {
    if (!(u >= 0 && v >= 0 && u < view_.width && v < view_.height)) return vec3{0.0f};
    const int x = static_cast<int>(first_.x + scale_ * (static_cast<float>(u) + 0.5f));
    const int y = static_cast<int>(first_.y + scale_ * (static_cast<float>(v) + 0.5f));
    const Image<float>& depth = solids_.depth;
    const bool hidden = before > depth(std::clamp(x, 0, depth.width() - 1), std::clamp(y, 0, depth.height() - 1));
    if (!hidden) return seen_(u, v);
    return behind_.empty() ? vec3{0.0f} : behind_(u, v);
  };
  const vec3 light = (1.0f - t) * ((1.0f - s) * texel(i, j) + s * texel(i + 1, j)) +
                     t * ((1.0f - s) * texel(i, j + 1) + s * texel(i + 1, j + 1));
  return cosine * light;
}

UnbentLight::UnbentLight(const View& view, Image<float> depth, Image<float> coverage)
    : view_(view), depth_(std::move(depth)), coverage_(std::move(coverage)), around_(depth_.width(), depth_.height()) {
  parallel_for(static_cast<std::size_t>(depth_.height()), 16, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
      for (int x = 0; x < depth_.width(); ++x) {
        Around& around = around_(x, y);
        bool closed = true;
        float farthest = 0;
        for (int v = y - 1; v <= y + 2; ++v)
          for (int u = x - 1; u <= x + 2; ++u) {
            const bool here = u >= 0 && v >= 0 && u < depth_.width() && v < depth_.height() && coverage_(u, v) > 0;
            closed = closed && here && coverage_(u, v) >= 1.0f;
            if (!here) continue;
            around.nearest = std::min(around.nearest, depth_(u, v));
            farthest = std::max(farthest, depth_(u, v));
          }
        if (closed) around.closed_from = farthest + 1.001f * kSoftDepth * view_.pixel_size(farthest);
      }
  });
}

float UnbentLight::fraction(vec3 point) const {
  const vec3 at = view_.project(point);
  if (!(at.z > 0)) return 1.0f;
  const float x = at.x - 0.5f, y = at.y - 0.5f;
  if (!(x >= 0 && y >= 0 && x < static_cast<float>(depth_.width() - 1) && y < static_cast<float>(depth_.height() - 1)))
    return 1.0f;
  const float distance = view_.projection == Projection::perspective ? glm::length(point - view_.eye) : at.z;
  const int i = static_cast<int>(x), j = static_cast<int>(y);
  const Around& around = around_(i, j);
  if (!(distance > around.nearest)) return 1.0f;
  if (distance >= around.closed_from) return 0.0f;
  const std::array<float, 4> across = spline(x - static_cast<float>(i)), along = spline(y - static_cast<float>(j));
  const float per_depth = 1.0f / (kSoftDepth * view_.pixel_size(distance));
  float taken = 0;
  for (int b = 0; b < 4; ++b)
    for (int a = 0; a < 4; ++a) {
      const int u = i + a - 1, v = j + b - 1;
      if (!(u >= 0 && v >= 0 && u < depth_.width() && v < depth_.height()) || !(coverage_(u, v) > 0)) continue;
      taken += across[static_cast<std::size_t>(a)] * along[static_cast<std::size_t>(b)] * coverage_(u, v) *
               std::clamp((distance - depth_(u, v)) * per_depth, 0.0f, 1.0f);
    }
  return std::clamp(1.0f - taken, 0.0f, 1.0f);
}

vec3 LightCast::refracted(vec3 point, vec3 normal) const {
  const CausticsMap* best = nullptr;
  float cosine = 0;
  for (const CausticsMap& map : maps)
    if (map.facing(normal) > cosine + (best ? 0.2f : 0.0f)) {
      cosine = map.facing(normal);
      best = &map;
    }
  return best ? best->irradiance(point, normal) : vec3{0.0f};
}

Bounds casting_box(const Surface& surface, const Bounds& region) {
  const Bounds bounds = surface.bounds();
  if (region.empty() || bounds.empty()) return bounds;
  const Bounds common{glm::max(bounds.low, region.low), glm::min(bounds.high, region.high)};
  return common.empty() ? bounds : common;
}

}  // namespace meniscus
