#include "scene/texture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace meniscus {
namespace {

/// The stages to the left of this one hold no transfer functions. IEC 61966-2-1.
float to_linear(float s) { return s <= 0.04045f ? s / 12.92f : std::pow((s + 0.055f) / 1.055f, 2.4f); }
float to_srgb(float l) { return l <= 0.0031308f ? 12.92f * l : 1.055f * std::pow(l, 1.0f / 2.4f) - 0.055f; }

const std::array<float, 256>& linear_of_byte() {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> values;
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = to_linear(static_cast<float>(i) / 255.0f);
    return values;
  }();
  return table;
}

vec3 linear(Texel c) {
  const auto& table = linear_of_byte();
  return {table[c.r], table[c.g], table[c.b]};
}
std::uint8_t byte_of(float l) {
  return static_cast<std::uint8_t>(std::clamp(to_srgb(l) * 255.0f + 0.5f, 0.0f, 255.0f));
}

int wrapped(int i, int size) {
  const int rest = i % size;
  return rest < 0 ? rest + size : rest;
}

/// Points along the long axis of the region at most.
constexpr int kMostPoints = 8;

}  // namespace

Texture::Texture(Image<Texel> picture) {
  Image<vec3> fine(picture.width(), picture.height());
  for (std::size_t i = 0; i < fine.size(); ++i) fine[i] = linear(picture[i]);
  levels_.push_back(std::move(picture));
  while (fine.width() > 1 || fine.height() > 1) {
    Image<vec3> coarse(std::max(1, fine.width() / 2), std::max(1, fine.height() / 2));
    Image<Texel> level(coarse.width(), coarse.height());
    // Texels of odd sizes are shared by their neighbours: each coarse one is the mean of all that it lies over.
    const float step_x = static_cast<float>(fine.width()) / static_cast<float>(coarse.width());
    const float step_y = static_cast<float>(fine.height()) / static_cast<float>(coarse.height());
    for (int y = 0; y < coarse.height(); ++y)
      for (int x = 0; x < coarse.width(); ++x) {
        const float left = static_cast<float>(x) * step_x, top = static_cast<float>(y) * step_y;
        const float right = left + step_x, bottom = top + step_y;
        vec3 sum{0.0f};
        float weights = 0;
        for (int j = static_cast<int>(top); j < std::min(fine.height(), static_cast<int>(std::ceil(bottom))); ++j)
          for (int i = static_cast<int>(left); i < std::min(fine.width(), static_cast<int>(std::ceil(right))); ++i) {
            const float in_x = std::min(right, static_cast<float>(i + 1)) - std::max(left, static_cast<float>(i));
            const float in_y = std::min(bottom, static_cast<float>(j + 1)) - std::max(top, static_cast<float>(j));
            sum += in_x * in_y * fine(i, j);
            weights += in_x * in_y;
          }
        coarse(x, y) = sum / weights;
        level(x, y) = {byte_of(coarse(x, y).x), byte_of(coarse(x, y).y), byte_of(coarse(x, y).z)};
      }
    levels_.push_back(std::move(level));
    fine = std::move(coarse);
  }
}

vec3 Texture::bilinear(std::size_t level, vec2 point) const {
  const Image<Texel>& texels = levels_[level];
  // Only the place within the period counts; far away, any does.
  const auto within = [](float t) { return std::abs(t) < 1e6f ? t - std::floor(t) : 0.0f; };
  const float x = within(point.x) * static_cast<float>(texels.width()) - 0.5f;
  const float y = (1.0f - within(point.y)) * static_cast<float>(texels.height()) - 0.5f;
  const float left = std::floor(x), top = std::floor(y);
  const float s = x - left, t = y - top;
  const int i0 = wrapped(static_cast<int>(left), texels.width()), i1 = wrapped(i0 + 1, texels.width());
  const int j0 = wrapped(static_cast<int>(top), texels.height()), j1 = wrapped(j0 + 1, texels.height());
  return (1.0f - t) * ((1.0f - s) * linear(texels(i0, j0)) + s * linear(texels(i1, j0))) +
         t * ((1.0f - s) * linear(texels(i0, j1)) + s * linear(texels(i1, j1)));
}

vec3 Texture::trilinear(float level, vec2 point) const {
  level = std::clamp(level, 0.0f, static_cast<float>(levels_.size() - 1));
  const auto fine = static_cast<std::size_t>(level);
  const float t = level - static_cast<float>(fine);
  const vec3 low = bilinear(fine, point);
  return t > 0 ? glm::mix(low, bilinear(fine + 1, point), t) : low;
}

vec3 Texture::at(vec2 point, vec2 along, float width) const {
  const vec2 size{static_cast<float>(this->width()), static_cast<float>(height())};
  // Widths in texels; a long region is covered by several round ones.
  const float short_px = width * std::max(size.x, size.y);
  const float long_px = 2.0f * glm::length(along * size);
  const float ratio = long_px / std::max(short_px, 1.0f);
  const int points = ratio > 1.0f ? std::min(kMostPoints, static_cast<int>(std::ceil(ratio))) : 1;
  const float each = std::max(short_px, long_px / static_cast<float>(points));
  const float level = each > 1.0f ? std::log2(each) : 0.0f;
  vec3 sum{0.0f};
  for (int k = 0; k < points; ++k) {
    const float t = (2.0f * static_cast<float>(k) + 1.0f) / static_cast<float>(points) - 1.0f;
    sum += trilinear(level, point + t * along);
  }
  return sum / static_cast<float>(points);
}

}  // namespace meniscus
