#include "shading/light_map.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

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

LightMap::LightMap(const View& view, Image<Fractions> texels) : texels_(std::move(texels)) {
  const float per_metre = 1.0f / view.pixel_size(0.0f);
  x_axis_ = view.right * per_metre;
  y_axis_ = -view.up * per_metre;
  origin_ = vec2{0.5f * static_cast<float>(view.width) - 0.5f - glm::dot(view.eye, x_axis_),
                 0.5f * static_cast<float>(view.height) - 0.5f - glm::dot(view.eye, y_axis_)};
}

WaterLight::Light LightMap::at(vec3 point, vec3) const {
  const float x = glm::dot(x_axis_, point) + origin_.x, y = glm::dot(y_axis_, point) + origin_.y;
  if (!(x >= 0 && y >= 0 && x < static_cast<float>(texels_.width() - 1) &&
        y < static_cast<float>(texels_.height() - 1)))
    return {};
  const int i = static_cast<int>(x), j = static_cast<int>(y);
  const Fractions* above = texels_.row(j) + i;
  const Fractions* below = texels_.row(j + 1) + i;
  const float s = x - static_cast<float>(i), t = y - static_cast<float>(j);
  const float w00 = (1.0f - s) * (1.0f - t), w10 = s * (1.0f - t), w01 = (1.0f - s) * t, w11 = s * t;
  Light light;
  light.sun = w00 * above[0].sun + w10 * above[1].sun + w01 * below[0].sun + w11 * below[1].sun;
  light.sky = w00 * above[0].sky + w10 * above[1].sky + w01 * below[0].sky + w11 * below[1].sky;
  return light;
}

}  // namespace meniscus
