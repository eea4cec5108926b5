/// Height fields with waves that are known as functions, and suns over them.
#pragma once

#include <cmath>
#include <functional>
#include <glm/geometric.hpp>

#include "fixtures.h"
#include "meniscus/shading.h"
#include "shading/caustics_plane.h"

namespace meniscus::tests {

/// Height and its derivatives along a and b.
struct Wave {
  double height, da, db;
};
using Waves = std::function<Wave(double a, double b)>;

inline Waves still(double height) {
  return [=](double, double) { return Wave{height, 0, 0}; };
}

/// Three crossing trains, about `amplitude` high each.
inline Waves crossing(double height, double amplitude) {
  return [=](double a, double b) {
    Wave wave{height, 0, 0};
    const auto add = [&](double part, double ka, double kb, double phase) {
      wave.height += amplitude * part * std::sin(ka * a + kb * b + phase);
      wave.da += amplitude * part * ka * std::cos(ka * a + kb * b + phase);
      wave.db += amplitude * part * kb * std::cos(ka * a + kb * b + phase);
    };
    add(1, 9, 2, 0);
    add(0.7, -5, 11, 1);
    add(0.4, 7, 15, 2);
    return wave;
  };
}

/// @param points  along the longer side
inline HeightField field_of(const Waves& waves, vec2 low, vec2 high, int points, Axis up = Axis::y) {
  HeightField field;
  field.up = up;
  field.low = low;
  const float step = std::max(high.x - low.x, high.y - low.y) / static_cast<float>(points - 1);
  field.step = vec2{step};
  const int width = 1 + static_cast<int>(std::lround((high.x - low.x) / step));
  const int height = 1 + static_cast<int>(std::lround((high.y - low.y) / step));
  field.height = Image<float>(width, height);
  field.normal = Image<vec3>(width, height);
  const FieldFrame frame(field);
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i) {
      const vec2 place = frame.place(i, j);
      const Wave wave = waves(static_cast<double>(place.x), static_cast<double>(place.y));
      field.height(i, j) = static_cast<float>(wave.height);
      field.normal(i, j) =
          glm::normalize(frame.world({static_cast<float>(-wave.da), static_cast<float>(-wave.db)}, 1.0f));
    }
  return field;
}

/// Nothing of it is looked at but its field.
class FieldSurface : public Surface {
 public:
  explicit FieldSurface(HeightField field) : field_(std::move(field)) {
    const FieldFrame frame(field_);
    const WaterLevel level(field_);
    bounds_.add(frame.world(frame.low, field_.floor));
    bounds_.add(frame.world(frame.high(), level.highest()));
  }
  SurfaceBuffers see(const View& view, std::span<const vec2> points, StageTimes*) const override {
    const int width = points.empty() ? view.width : static_cast<int>(points.size());
    const int height = points.empty() ? view.height : 1;
    SurfaceBuffers seen;
    seen.depth = Image<float>(width, height, std::numeric_limits<float>::infinity());
    seen.normal = Image<vec3>(width, height);
    seen.thickness = Image<float>(width, height);
    seen.coverage = Image<float>(width, height);
    return seen;
  }
  Image<float> thickness(const View& view, std::span<const vec2> points, StageTimes*) const override {
    return see(view, points, nullptr).thickness;
  }
  Bounds bounds() const override { return bounds_; }
  const HeightField* height_field() const override { return &field_; }

 private:
  HeightField field_;
  Bounds bounds_;
};

inline Environment sun_from(vec3 direction) {
  EnvironmentOptions options;
  options.sun_direction = direction;
  return Environment(options);
}

inline vec3 at_angle(double angle) {
  return {static_cast<float>(std::sin(angle)), static_cast<float>(std::cos(angle)), 0};
}

}  // namespace meniscus::tests
