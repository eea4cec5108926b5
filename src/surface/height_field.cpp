// The columns themselves: places, samples, normals.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "meniscus/surface.h"
#include "surface/height_field_axes.h"

namespace meniscus {
namespace {

constexpr float kDry = -std::numeric_limits<float>::infinity();
constexpr float kBeyond = 1e-3f;  ///< steps beyond the border that still count

/// Slope between the neighbours of a point along one axis, those that are water.
float slope(float before, float here, float after, float step) {
  const bool has_before = before > kDry, has_after = after > kDry;
  if (has_before && has_after) return (after - before) / (2 * step);
  if (has_after) return (after - here) / step;
  if (has_before) return (here - before) / step;
  return 0;
}

}  // namespace

vec3 HeightField::point(float i, float j, float level) const {
  return FieldAxes(up).place(low.x + i * step.x, low.y + j * step.y, level);
}

vec2 HeightField::grid_point(vec3 p) const {
  const FieldAxes axes(up);
  return {(p[axes.a] - low.x) / step.x, (p[axes.b] - low.y) / step.y};
}

Bounds HeightField::bounds() const {
  Bounds box;
  int i0 = height.width(), i1 = -1, j0 = height.height(), j1 = -1;
  float top = floor;
  for (int j = 0; j < height.height(); ++j)
    for (int i = 0; i < height.width(); ++i) {
      if (!(height(i, j) > kDry)) continue;
      i0 = std::min(i0, i), i1 = std::max(i1, i), j0 = std::min(j0, j), j1 = std::max(j1, j);
      top = std::max(top, height(i, j));
    }
  if (i1 < 0) return box;
  // Water reaches half a step into the cells at its border.
  const auto grown = [](int first, int last, int count) {
    return vec2{std::max(static_cast<float>(first) - 0.5f, 0.0f),
                std::min(static_cast<float>(last) + 0.5f, static_cast<float>(count - 1))};
  };
  const vec2 a = grown(i0, i1, height.width()), b = grown(j0, j1, height.height());
  box.add(point(a.x, b.x, floor));
  box.add(point(a.y, b.y, top));
  return box;
}

HeightField::Sample HeightField::at(float i, float j) const {
  Sample sample;
  const auto last_i = static_cast<float>(height.width() - 1), last_j = static_cast<float>(height.height() - 1);
  if (empty() || !(i >= -kBeyond && j >= -kBeyond && i <= last_i + kBeyond && j <= last_j + kBeyond)) return sample;
  i = std::clamp(i, 0.0f, last_i);
  j = std::clamp(j, 0.0f, last_j);
  const int i0 = std::clamp(static_cast<int>(i), 0, std::max(height.width() - 2, 0));
  const int j0 = std::clamp(static_cast<int>(j), 0, std::max(height.height() - 2, 0));
  const float u = i - static_cast<float>(i0), v = j - static_cast<float>(j0);
  const bool has_normals = normal.size() == height.size();
  // Bilinear over the points that are water. Where all of those have no weight, the place lies in a hole's corner.
  float sum = 0, weights = 0, nearest = kDry, nearest_weight = -1;
  vec3 normals{0.0f}, nearest_normal{0.0f};
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 2; ++x) {
      const int p = std::min(i0 + x, height.width() - 1), q = std::min(j0 + y, height.height() - 1);
      const float level = height(p, q);
      if (!(level > kDry)) continue;
      const float weight = (x ? u : 1 - u) * (y ? v : 1 - v);
      sum += weight * level;
      weights += weight;
      if (has_normals) normals += weight * normal(p, q);
      if (weight > nearest_weight) {
        nearest_weight = weight;
        nearest = level;
        if (has_normals) nearest_normal = normal(p, q);
      }
    }
  if (!(nearest > kDry)) return sample;
  sample.height = weights > 0 ? sum / weights : nearest;
  const vec3 direction = weights > 0 && glm::length(normals) > 0 ? normals : nearest_normal;
  sample.normal = glm::length(direction) > 0 ? glm::normalize(direction) : direction_of(up);
  return sample;
}

void find_normals(HeightField& field) {
  const int width = field.height.width(), height = field.height.height();
  field.normal = Image<vec3>(width, height);
  const FieldAxes axes(field.up);
  const vec3 upright = direction_of(field.up);
  parallel_for(static_cast<std::size_t>(height), 16, [&](std::size_t begin, std::size_t end) {
    const std::vector<float> dry(static_cast<std::size_t>(width), kDry);
    for (int j = static_cast<int>(begin); j < static_cast<int>(end); ++j) {
      const float* row = field.height.row(j);
      const float* before = j > 0 ? field.height.row(j - 1) : dry.data();
      const float* after = j + 1 < height ? field.height.row(j + 1) : dry.data();
      vec3* normals = field.normal.row(j);
      for (int i = 0; i < width; ++i) {
        const float here = row[i];
        if (!(here > kDry)) {
          normals[i] = upright;
          continue;
        }
        const float by_a = slope(i > 0 ? row[i - 1] : kDry, here, i + 1 < width ? row[i + 1] : kDry, field.step.x);
        const float by_b = slope(before[i], here, after[i], field.step.y);
        normals[i] = glm::normalize(axes.place(-by_a, -by_b, 1.0f));
      }
    }
  });
}

}  // namespace meniscus
