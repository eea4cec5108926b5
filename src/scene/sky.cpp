#include "scene/sky.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>
#include <numbers>

namespace meniscus {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kTurbidity = 2.6f;
/// Radiance of a white ground, and the sun's part of its irradiance while the sun stands high.
constexpr float kWhiteGround = 1.0f;
constexpr float kSunPart = 0.62f;
/// Of the light through clouds; bluish by a trifle, its luminance one.
constexpr vec3 kCloudColour{0.976f, 1.0f, 1.071f};

float luminance(vec3 rgb) { return glm::dot(rgb, vec3{0.2126f, 0.7152f, 0.0722f}); }

/// CIE xyY to linear sRGB.
vec3 rgb_from_xyy(float x, float y, float luminance_y) {
  const float cx = x / y * luminance_y, cz = (1.0f - x - y) / y * luminance_y;
  return {3.2406f * cx - 1.5372f * luminance_y - 0.4986f * cz, -0.9689f * cx + 1.8758f * luminance_y + 0.0415f * cz,
          0.0557f * cx - 0.2040f * luminance_y + 1.0570f * cz};
}

/// Colour of the sun through the air, luminance one: Rayleigh and aerosol optical depths [Preetham1999] A.1 at 610,
/// 550 and 465 nm and the air mass of [Kasten1989].
vec3 sun_colour(float elevation) {
  const float degrees = std::max(elevation, 0.0f) * 180.0f / kPi;
  const float air_mass =
      1.0f / (std::sin(std::max(elevation, 0.0f)) + 0.50572f * std::pow(degrees + 6.07995f, -1.6364f));
  const vec3 wavelength_um{0.610f, 0.550f, 0.465f};
  const float beta = 0.04608f * kTurbidity - 0.04586f;
  const vec3 depth = 0.008735f * glm::pow(wavelength_um, vec3{-4.08f}) + beta * glm::pow(wavelength_um, vec3{-1.3f});
  const vec3 colour = glm::exp(-air_mass * depth);
  return colour / luminance(colour);
}

}  // namespace

float Sky::Perez::at(float cos_theta, float gamma, float cos_gamma) const {
  return (1.0f + a * std::exp(b / cos_theta)) * (1.0f + c * std::exp(d * gamma) + e * cos_gamma * cos_gamma);
}

Sky::Sky(vec3 sun, float cover) : sun_(sun), cover_(cover) {
  // The model holds for a sun above the horizon.
  const float elevation = std::asin(std::clamp(sun.z, -1.0f, 1.0f));
  const float theta = 0.5f * kPi - std::max(elevation, 0.035f);
  const float t = kTurbidity, theta2 = theta * theta, theta3 = theta2 * theta;

  // Coefficients of the distribution and values at the zenith, [Preetham1999] A.2.
  luminance_ = {0.1787f * t - 1.4630f, -0.3554f * t + 0.4275f, -0.0227f * t + 5.3251f,
                0.1206f * t - 2.5771f, -0.0670f * t + 0.3703f, 0.0f};
  x_ = {-0.0193f * t - 0.2592f, -0.0665f * t + 0.0008f, -0.0004f * t + 0.2125f,
        -0.0641f * t - 0.8989f, -0.0033f * t + 0.0452f, 0.0f};
  y_ = {-0.0167f * t - 0.2608f, -0.0950f * t + 0.0092f, -0.0079f * t + 0.2102f,
        -0.0441f * t - 1.6537f, -0.0109f * t + 0.0529f, 0.0f};
  const float chi = (4.0f / 9.0f - t / 120.0f) * (kPi - 2.0f * theta);
  luminance_.zenith = (4.0453f * t - 4.9710f) * std::tan(chi) - 0.2155f * t + 2.4192f;
  x_.zenith = t * t * (0.00166f * theta3 - 0.00375f * theta2 + 0.00209f * theta) +
              t * (-0.02903f * theta3 + 0.06377f * theta2 - 0.03202f * theta + 0.00394f) +
              (0.11693f * theta3 - 0.21196f * theta2 + 0.06052f * theta + 0.25886f);
  y_.zenith = t * t * (0.00275f * theta3 - 0.00610f * theta2 + 0.00317f * theta) +
              t * (-0.04214f * theta3 + 0.08970f * theta2 - 0.04153f * theta + 0.00516f) +
              (0.15346f * theta3 - 0.26756f * theta2 + 0.06670f * theta + 0.26688f);
  for (Perez* p : {&luminance_, &x_, &y_}) p->zenith /= p->at(1.0f, theta, std::cos(theta));

  // Irradiance of the unscaled sky on the ground, by the midpoint rule.
  vec3 sky_irradiance{0.0f};
  constexpr int kRings = 24, kSpokes = 48;
  for (int i = 0; i < kRings; ++i)
    for (int j = 0; j < kSpokes; ++j) {
      const float z = (static_cast<float>(i) + 0.5f) / kRings,
                  phi = (static_cast<float>(j) + 0.5f) * 2.0f * kPi / kSpokes;
      const float r = std::sqrt(1.0f - z * z);
      sky_irradiance += z * (2.0f * kPi / (kRings * kSpokes)) * unscaled({r * std::cos(phi), r * std::sin(phi), z});
    }

  // The sun's part shrinks when it stands low, and its light with it.
  const float height = std::clamp(sun.z / 0.4f, 0.0f, 1.0f);
  const float sun_part = kSunPart * height;
  const float total = kPi * kWhiteGround * (0.35f + 0.65f * height);
  scale_ = vec3{(1.0f - sun_part) * total / luminance(sky_irradiance)};
  vec3 sun_on_ground = sun_part * total * sun_colour(elevation);

  // White balance: the sun's warmth makes up for most of the sky's blue, so that a white ground is nearly neutral.
  const vec3 missing = glm::max(vec3{total} - scale_ * sky_irradiance, vec3{0.0f});
  if (luminance(missing) > 0) {
    const vec3 balanced = missing * (luminance(sun_on_ground) / luminance(missing));
    sun_on_ground = glm::mix(sun_on_ground, balanced, 0.85f);
  }
  // On a surface that faces the sun; with height = 0 both are zero.
  sun_irradiance_ = sun_on_ground / std::max(sun.z, 0.02f);

  // Clouds give the ground as much light as the clear sky and its sun. The overcast sky's irradiance is 7 pi / 9 times
  // the radiance of its zenith.
  const vec3 overcast_irradiance = total * kCloudColour;
  overcast_zenith_ = overcast_irradiance * (9.0f / (7.0f * kPi));
  ground_ = (0.3f / kPi) * glm::mix(scale_ * sky_irradiance + sun_on_ground, overcast_irradiance, cover_);
  sun_irradiance_ *= 1.0f - cover_;
}

vec3 Sky::above(vec3 direction) const {
  if (!(cover_ > 0)) return scale_ * unscaled(direction);
  // CIE standard overcast sky: L = L_zenith (1 + 2 sin elevation) / 3.                          [CIE2003] type 16
  const vec3 overcast = overcast_zenith_ * ((1.0f + 2.0f * std::max(direction.z, 0.0f)) / 3.0f);
  return glm::mix(scale_ * unscaled(direction), overcast, cover_);
}

vec3 Sky::unscaled(vec3 direction) const {
  const float cos_theta = std::max(direction.z, 0.035f);
  const float cos_gamma = std::clamp(glm::dot(direction, sun_), -1.0f, 1.0f), gamma = std::acos(cos_gamma);
  const float y_value = luminance_.zenith * luminance_.at(cos_theta, gamma, cos_gamma);
  const vec3 rgb = glm::max(rgb_from_xyy(x_.zenith * x_.at(cos_theta, gamma, cos_gamma),
                                         y_.zenith * y_.at(cos_theta, gamma, cos_gamma), y_value),
                            vec3{0.0f});
  // The model's horizon is yellowish on the sun's side; haze scatters all colours alike.
  const float haze = 0.25f + 0.70f * std::exp(-5.0f * std::max(direction.z, 0.0f));
  return glm::mix(rgb, vec3{0.80f, 1.03f, 1.30f} * luminance(rgb), haze);
}

vec3 Sky::radiance(vec3 direction) const {
  if (direction.z >= 0) return above(direction);
  const float down = std::clamp(-direction.z / 0.5f, 0.0f, 1.0f);
  const float blend = down * down * (3.0f - 2.0f * down);
  const float horizontal = std::sqrt(direction.x * direction.x + direction.y * direction.y);
  const vec3 horizon =
      horizontal > 1e-4f ? vec3{direction.x / horizontal, direction.y / horizontal, 0.0f} : vec3{1, 0, 0};
  return glm::mix(above(horizon), ground_, blend);
}

}  // namespace meniscus
