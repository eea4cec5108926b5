#include "shading/light_map.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace meniscus {
namespace {

/// Columns that are blurred at once: lines of a picture lie far apart in memory.
constexpr std::size_t kColumns = 32;

/// Running mean over 2 radius + 1 values of `lanes` lines side by side; the values of a line stand `stride` apart.
template <class T>
void box_lines(T* values, int count, std::size_t lanes, std::ptrdiff_t stride, int radius, std::vector<T>& lines) {
  lines.resize(static_cast<std::size_t>(count) * lanes);
  for (int i = 0; i < count; ++i)
    std::copy(values + i * stride, values + i * stride + lanes, &lines[static_cast<std::size_t>(i) * lanes]);
  const auto at = [&](int i) { return &lines[static_cast<std::size_t>(std::clamp(i, 0, count - 1)) * lanes]; };
  T sum[kColumns]{};
  for (int i = -radius; i <= radius; ++i)
    for (std::size_t k = 0; k < lanes; ++k) sum[k] += at(i)[k];
  const float scale = 1.0f / static_cast<float>(2 * radius + 1);
  for (int i = 0; i < count; ++i) {
    T* here = values + i * stride;
    const T* next = at(i + radius + 1);
    const T* last = at(i - radius);
    for (std::size_t k = 0; k < lanes; ++k) {
      here[k] = sum[k] * scale;
      sum[k] += next[k];
      sum[k] -= last[k];
    }
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
      for (int pass = 0; pass < 3; ++pass) box_lines(image.row(static_cast<int>(y)), width, 1, 1, radius, line);
  });
  parallel_for(static_cast<std::size_t>(width), kColumns, [&](std::size_t begin, std::size_t end) {
    std::vector<T> lines;
    for (int pass = 0; pass < 3; ++pass) box_lines(image.data() + begin, height, end - begin, width, radius, lines);
  });
}

float* values_of(Image<vec3>& image, int y) { return &image.row(y)->x; }
float* values_of(Image<float>& image, int y) { return image.row(y); }

/// Values of a texel lie side by side, `channels` of them.
template <class T>
void blur_finely_any(Image<T>& image, float sigma_px) {
  constexpr int channels = static_cast<int>(sizeof(T) / sizeof(float));
  constexpr float kLargest = 6.0f, kReach = 3.0f;
  if (!(sigma_px > 0.05f) || image.empty()) return;
  if (sigma_px > kLargest) return blur_any(image, sigma_px);
  const int radius = static_cast<int>(std::ceil(kReach * sigma_px));
  std::vector<float> weight(static_cast<std::size_t>(2 * radius + 1));
  float all = 0;
  for (int k = -radius; k <= radius; ++k) {
    const float x = static_cast<float>(k) / sigma_px;
    all += weight[static_cast<std::size_t>(k + radius)] = std::exp(-0.5f * x * x);
  }
  for (float& w : weight) w /= all;
  const int width = image.width(), height = image.height(), values = channels * width;
  // Rows without light stay so along x, and are left out along y.
  std::vector<std::uint8_t> lit(static_cast<std::size_t>(height));
  parallel_for(static_cast<std::size_t>(height), 16, [&](std::size_t begin, std::size_t end) {
    std::vector<float> line(static_cast<std::size_t>(values + 2 * channels * radius), 0.0f);
    for (std::size_t y = begin; y < end; ++y) {
      float* row = values_of(image, static_cast<int>(y));
      lit[y] = std::any_of(row, row + values, [](float v) { return v != 0; });
      if (!lit[y]) continue;
      std::copy(row, row + values, line.begin() + channels * radius);
      std::fill(row, row + values, 0.0f);
      for (int k = 0; k <= 2 * radius; ++k) {
        const float w = weight[static_cast<std::size_t>(k)];
        const float* from = line.data() + channels * k;
        for (int i = 0; i < values; ++i) row[i] += w * from[i];
      }
    }
  });
  Image<T> result(width, height);
  parallel_for(static_cast<std::size_t>(height), 16, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      float* row = values_of(result, y);
      for (int k = -radius; k <= radius; ++k) {
        if (y + k < 0 || y + k >= height || !lit[static_cast<std::size_t>(y + k)]) continue;
        const float w = weight[static_cast<std::size_t>(k + radius)];
        const float* from = values_of(image, y + k);
        for (int i = 0; i < values; ++i) row[i] += w * from[i];
      }
    }
  });
  image = std::move(result);
}

}  // namespace

void blur(Image<vec3>& image, float sigma_px) { blur_any(image, sigma_px); }
void blur(Image<float>& image, float sigma_px) { blur_any(image, sigma_px); }
void blur_finely(Image<vec3>& image, float sigma_px) { blur_finely_any(image, sigma_px); }
void blur_finely(Image<float>& image, float sigma_px) { blur_finely_any(image, sigma_px); }

LightMap::LightMap(const View& view, Image<Fractions> texels, vec3 up, Image<float> level, float soft)
    : texels_(std::move(texels)), up_(up), level_(std::move(level)), soft_(soft) {
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
  const float s = x - static_cast<float>(i), t = y - static_cast<float>(j);
  const float w00 = (1.0f - s) * (1.0f - t), w10 = s * (1.0f - t), w01 = (1.0f - s) * t, w11 = s * t;
  float under = 1;
  if (!level_.empty()) {
    const float* above = level_.row(j) + i;
    const float* below = level_.row(j + 1) + i;
    const float level = w00 * above[0] + w10 * above[1] + w01 * below[0] + w11 * below[1];
    under = std::min(1.0f, (level - glm::dot(up_, point)) / soft_);
    if (!(under > 0)) return {};
  }
  const Fractions* above = texels_.row(j) + i;
  const Fractions* below = texels_.row(j + 1) + i;
  Light light;
  light.sun = w00 * above[0].sun + w10 * above[1].sun + w01 * below[0].sun + w11 * below[1].sun;
  light.sky = w00 * above[0].sky + w10 * above[1].sky + w01 * below[0].sky + w11 * below[1].sky;
  if (under < 1) {
    light.sun = glm::mix(vec3{1.0f}, light.sun, under);
    light.sky = glm::mix(vec3{1.0f}, light.sky, under);
  }
  return light;
}

}  // namespace meniscus
