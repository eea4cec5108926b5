#include "scene/equirectangular.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>

namespace meniscus {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

float luminance(vec3 rgb) { return glm::dot(rgb, vec3{0.2126f, 0.7152f, 0.0722f}); }

}  // namespace

Equirectangular::Equirectangular(Image<vec3> picture) : picture_(std::move(picture)) {}

vec3 Equirectangular::at(vec3 direction) const {
  const int width = picture_.width(), height = picture_.height();
  const float u = 0.5f + std::atan2(direction.x, direction.y) / (2.0f * kPi);
  const float v = std::acos(std::clamp(direction.z, -1.0f, 1.0f)) / kPi;
  const float x = u * static_cast<float>(width) - 0.5f;
  const float y = std::clamp(v * static_cast<float>(height) - 0.5f, 0.0f, static_cast<float>(height - 1));
  const int i = static_cast<int>(std::floor(x)), j = std::min(static_cast<int>(y), height - 1);
  const float s = x - static_cast<float>(i), t = y - static_cast<float>(j);
  // Longitude goes round.
  const int left = (i + width) % width, right = (left + 1) % width, below = std::min(j + 1, height - 1);
  return (1.0f - t) * ((1.0f - s) * picture_(left, j) + s * picture_(right, j)) +
         t * ((1.0f - s) * picture_(left, below) + s * picture_(right, below));
}

vec3 Equirectangular::direction_of(int x, int y) const {
  const float phi = ((static_cast<float>(x) + 0.5f) / static_cast<float>(picture_.width()) - 0.5f) * 2.0f * kPi;
  const float theta = (static_cast<float>(y) + 0.5f) / static_cast<float>(picture_.height()) * kPi;
  return {std::sin(theta) * std::sin(phi), std::sin(theta) * std::cos(phi), std::cos(theta)};
}

Equirectangular::Sun Equirectangular::take_sun() {
  const float cell = 2.0f * kPi * kPi / (static_cast<float>(picture_.width()) * static_cast<float>(picture_.height()));
  const auto solid_angle = [&](int y) {
    return cell * std::sin((static_cast<float>(y) + 0.5f) / static_cast<float>(picture_.height()) * kPi);
  };

  // All light, and the brightest pixel.
  double all = 0;
  float peak = 0;
  int peak_x = 0, peak_y = 0;
  for (int y = 0; y < picture_.height(); ++y)
    for (int x = 0; x < picture_.width(); ++x) {
      const float value = luminance(picture_(x, y));
      all += static_cast<double>(value * solid_angle(y));
      if (value > peak) peak = value, peak_x = x, peak_y = y;
    }

  // The ring from 6 to 10 degrees around it.
  const vec3 centre = direction_of(peak_x, peak_y);
  const float cos_disc = std::cos(6.0f * kPi / 180.0f), cos_ring = std::cos(10.0f * kPi / 180.0f);
  vec3 ring{0.0f};
  float ring_weight = 0;
  for (int y = 0; y < picture_.height(); ++y)
    for (int x = 0; x < picture_.width(); ++x) {
      const float c = glm::dot(direction_of(x, y), centre);
      if (c < cos_disc && c > cos_ring) ring += solid_angle(y) * picture_(x, y), ring_weight += solid_angle(y);
    }
  Sun sun;
  if (!(ring_weight > 0)) return sun;
  ring /= ring_weight;

  // What the spot has more than the ring.
  vec3 towards{0.0f};
  for (int y = 0; y < picture_.height(); ++y)
    for (int x = 0; x < picture_.width(); ++x) {
      const vec3 direction = direction_of(x, y);
      if (glm::dot(direction, centre) < cos_disc) continue;
      const vec3 excess = glm::max(picture_(x, y) - ring, vec3{0.0f}) * solid_angle(y);
      sun.irradiance += excess;
      towards += luminance(excess) * direction;
    }
  sun.found = peak > 20.0f * luminance(ring) && static_cast<double>(luminance(sun.irradiance)) > 0.05 * all;
  if (!sun.found) return Sun{};
  sun.direction = glm::normalize(towards);
  for (int y = 0; y < picture_.height(); ++y)
    for (int x = 0; x < picture_.width(); ++x)
      if (glm::dot(direction_of(x, y), centre) >= cos_disc) picture_(x, y) = glm::min(picture_(x, y), ring);
  return sun;
}

}  // namespace meniscus
