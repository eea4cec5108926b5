#include "shading/normal_variance.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace meniscus {
namespace {

constexpr float kLargest = 0.25f;

/// Pixel of a picture coordinate; -1 outside of any picture.
int pixel_of(float coordinate) { return coordinate >= 0.0f && coordinate < 1e9f ? static_cast<int>(coordinate) : -1; }

}  // namespace

NormalVariance::NormalVariance(const View& view, std::span<const vec2> points, const Image<vec3>& normals)
    : points_(points), normals_(normals), width_(view.width), height_(view.height) {
  if (points.empty()) return;
  first_ = Image<int>(width_, height_, -1);
  for (std::size_t i = points.size(); i-- > 0;) {
    const int x = pixel_of(points[i].x), y = pixel_of(points[i].y);
    if (x >= 0 && x < width_ && y >= 0 && y < height_) first_(x, y) = static_cast<int>(i);
  }
}

void NormalVariance::include(std::size_t i, int x, int y, float& largest) const {
  if (x < 0 || y < 0 || x >= width_ || y >= height_) return;
  std::size_t other = static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  float distance_squared = 1.0f;
  if (!points_.empty()) {
    if (first_[other] < 0) return;
    other = static_cast<std::size_t>(first_[other]);
    const vec2 offset = points_[other] - points_[i];
    distance_squared = glm::dot(offset, offset);
    if (!(distance_squared > 0.04f)) return;
  }
  const vec3 a = normals_[i], b = normals_[other];
  if (b == vec3{0.0f}) return;
  const vec3 change = a - b;
  const float squared = glm::dot(change, change) / distance_squared;
  if (squared > largest) largest = squared;
}

float NormalVariance::at(std::size_t i) const {
  if (normals_[i] == vec3{0.0f}) return 0.0f;
  const int x = points_.empty() ? static_cast<int>(i % static_cast<std::size_t>(width_)) : pixel_of(points_[i].x);
  const int y = points_.empty() ? static_cast<int>(i / static_cast<std::size_t>(width_)) : pixel_of(points_[i].y);
  if (x < 0 || y < 0) return 0.0f;
  float largest = 0;
  if (points_.empty() && x > 0 && y > 0 && x + 1 < width_ && y + 1 < height_) {
    const auto row = static_cast<std::size_t>(width_);
    const vec3 normal = normals_[i];
    for (const std::size_t other : {i - 1, i + 1, i - row, i + row}) {
      const vec3 neighbour = normals_[other], change = normal - neighbour;
      const float squared = glm::dot(change, change);
      if (squared > largest && neighbour != vec3{0.0f}) largest = squared;
    }
    return std::min(largest, kLargest);
  }
  if (!points_.empty()) include(i, x, y, largest);
  include(i, x - 1, y, largest);
  include(i, x + 1, y, largest);
  include(i, x, y - 1, largest);
  include(i, x, y + 1, largest);
  return std::min(largest, kLargest);
}

}  // namespace meniscus
