#include "shading/light_map.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

namespace meniscus {
namespace {

/// Running mean over 2 radius + 1 values of a line whose values stand `stride` apart.
template <class T>
void box_line(T* values, int count, std::ptrdiff_t stride, int radius, std::vector<T>& line) {
  line.resize(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) line[static_cast<std::size_t>(i)] = values[i * stride];
  const auto at = [&](int i) { return line[static_cast<std::size_t>(std::clamp(i, 0, count - 1))]; };
  T sum{};
  for (int i = -radius; i <= radius; ++i) sum += at(i);
  const float scale = 1.0f / static_cast<float>(2 * radius + 1);
  for (int i = 0; i < count; ++i) {
    values[i * stride] = sum * scale;
    sum += at(i + radius + 1);
    sum -= at(i - radius);
  }
}

template <class T>
void blur_any(Image<T>& image, float sigma_px) {
  // Three boxes of radius r have the variance r (r + 1).
  const int radius = static_cast<int>(std::lround(0.5f * (std::sqrt(1.0f + 4.0f * sigma_px * sigma_px) - 1.0f)));
  if (radius < 1 || image.empty()) return;
  const int width = image.width(), height = image.height();
  parallel_for(static_cast<std::size_t>(height), 16, [&](std::size_t begin, std::size_t end) {
    std::vector<T> line;
    for (std::size_t y = begin; y < end; ++y)
      for (int pass = 0; pass < 3; ++pass) box_line(image.row(static_cast<int>(y)), width, 1, radius, line);
  });
  parallel_for(static_cast<std::size_t>(width), 16, [&](std::size_t begin, std::size_t end) {
    std::vector<T> line;
    for (std::size_t x = begin; x < end; ++x)
      for (int pass = 0; pass < 3; ++pass) box_line(image.data() + x, height, width, radius, line);
  });
}

}  // namespace

void blur(Image<vec3>& image, float sigma_px) { blur_any(image, sigma_px); }
void blur(Image<float>& image, float sigma_px) { blur_any(image, sigma_px); }

LightMap::LightMap(const View& view, Image<Texel> texels) : view_(view), texels_(std::move(texels)) {}

vec3 LightMap::at(vec3 point, vec3 Texel::*part) const {
  const vec3 p = view_.project(point);
  const float x = p.x - 0.5f, y = p.y - 0.5f;
  if (!(x >= 0 && y >= 0 && x < static_cast<float>(texels_.width() - 1) &&
        y < static_cast<float>(texels_.height() - 1)))
    return vec3{1.0f};
  const int i = static_cast<int>(x), j = static_cast<int>(y);
  const Texel* above = texels_.row(j) + i;
  const Texel* below = texels_.row(j + 1) + i;
  const float s = x - static_cast<float>(i), t = y - static_cast<float>(j);
  return (1.0f - t) * ((1.0f - s) * above[0].*part + s * above[1].*part) +
         t * ((1.0f - s) * below[0].*part + s * below[1].*part);
}

vec3 LightMap::sun(vec3 point) const { return at(point, &Texel::sun); }
vec3 LightMap::sky(vec3 point) const { return at(point, &Texel::sky); }

}  // namespace meniscus
