/// Water whose surface is a function of the place, above a floor at y = 0.
#pragma once

#include <cmath>
#include <functional>
#include <glm/geometric.hpp>

#include "meniscus/surface.h"

namespace meniscus::tests {

/// The top of a body of water on the rectangle |x| <= half.x, |z| <= half.y; its sides are not seen.
class AnalyticWater : public Surface {
 public:
  using Height = std::function<double(double x, double z)>;
  /// @param low, high  bounds of the height
  AnalyticWater(vec2 half, float low, float high, Height height)
      : half_(half), low_(low), high_(high), height_(std::move(height)) {}

  SurfaceBuffers see(const View& view, std::span<const vec2> points, StageTimes*) const override {
    const int width = points.empty() ? view.width : static_cast<int>(points.size());
    const int rows = points.empty() ? view.height : 1;
    SurfaceBuffers seen;
    seen.depth = Image<float>(width, rows, std::numeric_limits<float>::infinity());
    seen.normal = Image<vec3>(width, rows);
    seen.thickness = Image<float>(width, rows);
    seen.coverage = Image<float>(width, rows);
    for (int y = 0; y < rows; ++y)
      for (int x = 0; x < width; ++x) {
        const vec2 p = points.empty() ? vec2{static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f}
                                      : points[static_cast<std::size_t>(x)];
        const Ray ray = view.ray(p);
        const double t = meets(ray);
        if (!(t > 0)) continue;
        seen.depth(x, y) = static_cast<float>(t);
        seen.coverage(x, y) = 1;
        seen.normal(x, y) = normal(ray.origin.x + t * ray.direction.x, ray.origin.z + t * ray.direction.z);
        const double height = ray.origin.y + t * ray.direction.y;
        seen.thickness(x, y) = static_cast<float>(height / -static_cast<double>(ray.direction.y));
      }
    return seen;
  }
  Image<float> thickness(const View& view, std::span<const vec2> points, StageTimes*) const override {
    return see(view, points, nullptr).thickness;
  }
  Bounds bounds() const override {
    Bounds box;
    box.add({-half_.x, 0, -half_.y});
    box.add({half_.x, high_, half_.y});
    return box;
  }
  vec3 normal(double x, double z) const {
    constexpr double kStep = 1e-4;
    const double dx = (height_(x + kStep, z) - height_(x - kStep, z)) / (2 * kStep);
    const double dz = (height_(x, z + kStep) - height_(x, z - kStep)) / (2 * kStep);
    const double length = std::sqrt(1 + dx * dx + dz * dz);
    return {static_cast<float>(-dx / length), static_cast<float>(1 / length), static_cast<float>(-dz / length)};
  }

 private:
  /// Distance along a descending ray to the surface, by steps and bisection; -1 where it is not met.
  double meets(const Ray& ray) const {
    const glm::dvec3 o(ray.origin), d(ray.direction);
    if (!(d.y < -1e-3)) return -1;
    const double begin = (high_ + 1e-4 - o.y) / d.y, end = (low_ - 1e-4 - o.y) / d.y;
    const auto above = [&](double t) {
      const glm::dvec3 p = o + t * d;
      return p.y - height_(p.x, p.z);
    };
    constexpr int kSteps = 24;
    double before = begin;
    for (int i = 1; i <= kSteps; ++i) {
      const double t = begin + (end - begin) * i / kSteps;
      if (above(t) > 0) {
        before = t;
        continue;
      }
      double after = t;
      for (int k = 0; k < 30; ++k) (above(0.5 * (before + after)) > 0 ? before : after) = 0.5 * (before + after);
      const glm::dvec3 p = o + after * d;
      return std::abs(p.x) <= static_cast<double>(half_.x) && std::abs(p.z) <= static_cast<double>(half_.y) ? after
                                                                                                            : -1;
    }
    return -1;
  }
  vec2 half_;
  double low_, high_;
  Height height_;
};

/// The same height everywhere.
inline AnalyticWater flat_water(vec2 half, float height) {
  return {half, height, height, [height](double, double) { return static_cast<double>(height); }};
}

}  // namespace meniscus::tests
