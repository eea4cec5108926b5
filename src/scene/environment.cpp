#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>

#include "meniscus/scene.h"
#include "scene/direction_look_up.h"
#include "scene/equirectangular.h"
#include "scene/hdr_file.h"
#include "scene/sky.h"

namespace meniscus {
namespace {

/// The blurred copies: `roughness` grows evenly, the cone with its square.
struct Level {
  float sigma;  ///< rad
  int cells;
};
constexpr std::array<Level, DirectionLevels::kBlurred> kLevels{
    {{0.032f, 256}, {0.128f, 128}, {0.288f, 64}, {0.512f, 48}, {0.8f, 48}}};
constexpr int kSharpCells = 320;
constexpr int kIrradianceCells = 32;

bool has_length(vec3 v) {
  const float length = glm::length(v);
  return length > 1e-12f && std::isfinite(length);
}

}  // namespace

struct Environment::Parts {
  UpFrame frame;
  Equirectangular map;  ///< empty for the analytic sky
  DirectionMap sharp;   ///< of the analytic sky
  std::array<DirectionMap, kLevels.size()> levels;
  DirectionMap irradiance;
  vec3 sun_direction{0, 1, 0};
  vec3 sun_irradiance{0.0f};
  bool sun_visible = true;
  float scale = 1;  ///< of all radiances

  vec3 sharp_at(vec3 local) const { return scale * (map.empty() ? sharp.at(local) : map.at(local)); }
};

Environment::Environment(const EnvironmentOptions& options) {
  if (!has_length(options.up) || !has_length(options.sun_direction))
    throw Error(ErrorCode::invalid_argument, "a direction of the environment has no length");
  if (!(options.sun_radiance_scale >= 0) || !std::isfinite(options.sun_radiance_scale))
    throw Error(ErrorCode::invalid_argument, "the scale of the sun's radiance is negative or not finite");
  if (!(options.radiance_scale >= 0) || !std::isfinite(options.radiance_scale))
    throw Error(ErrorCode::invalid_argument, "the scale of the environment's radiance is negative or not finite");
  if (!(options.cloud_cover >= 0 && options.cloud_cover <= 1))
    throw Error(ErrorCode::invalid_argument, "the cloud cover is not in [0, 1]");
  auto parts = std::make_shared<Parts>();
  parts->frame = up_frame(options.up);
  parts->sun_direction = glm::normalize(options.sun_direction);
  parts->sun_visible = options.sun_visible;
  const vec3 local_sun = parts->frame.local(parts->sun_direction);

  if (options.hdr_path.empty()) {
    const Sky sky(local_sun, options.cloud_cover);
    parts->sharp = DirectionMap(kSharpCells, [&](vec3 direction) { return sky.radiance(direction); });
    parts->sun_irradiance = sky.sun_irradiance();
  } else {
    parts->map = Equirectangular(read_hdr(options.hdr_path));
    const Equirectangular::Sun sun = parts->map.take_sun();
    if (sun.found) parts->sun_direction = parts->frame.world(sun.direction);
    parts->sun_irradiance = sun.irradiance;
  }
  parts->sun_irradiance *= options.sun_radiance_scale * options.radiance_scale;
  parts->scale = options.radiance_scale;

  // Each level from the one before it: the variances of Gaussians add up.
  DirectionMap source =
      parts->map.empty() ? parts->sharp : DirectionMap(512, [&](vec3 direction) { return parts->map.at(direction); });
  float variance = 0;
  for (std::size_t k = 0; k < kLevels.size(); ++k) {
    const float wanted = kLevels[k].sigma * kLevels[k].sigma;
    parts->levels[k] = blurred(k == 0 ? source : parts->levels[k - 1], std::sqrt(wanted - variance), kLevels[k].cells);
    variance = wanted;
  }
  parts->irradiance = convolved_with_cosine(parts->levels[1], kIrradianceCells);
  parts_ = std::move(parts);
}

vec3 Environment::radiance(vec3 direction) const { return parts_->sharp_at(parts_->frame.local(direction)); }

vec3 Environment::radiance(vec3 direction, float roughness) const {
  const vec3 local = parts_->frame.local(direction);
  constexpr float kCount = static_cast<float>(kLevels.size());
  const float level = std::clamp(roughness, 0.0f, 1.0f) * kCount;
  if (!(level > 1e-3f)) return parts_->sharp_at(local);
  const auto upper = std::min(static_cast<std::size_t>(level), kLevels.size() - 1);
  const float t = level - static_cast<float>(upper);
  const vec3 low = upper == 0 ? parts_->sharp_at(local) : parts_->scale * parts_->levels[upper - 1].at(local);
  return glm::mix(low, parts_->scale * parts_->levels[upper].at(local), t);
}

vec3 Environment::irradiance(vec3 normal) const {
  return parts_->scale * parts_->irradiance.at(parts_->frame.local(normal));
}

void Environment::radiance(const BlockVectors& directions, const float* roughness, const std::int32_t* wanted,
                           int count, BlockVectors& result) const {
  const Parts& parts = *parts_;
  if (!parts.map.empty()) {
    for (int lane = 0; lane < count; ++lane)
      result.set(lane, wanted[lane] != 0 ? radiance(directions.get(lane), roughness[lane]) : vec3{0.0f});
    return;
  }
  DirectionLevels levels;
  levels.maps[0] = &parts.sharp;
  for (std::size_t k = 0; k < kLevels.size(); ++k) levels.maps[k + 1] = &parts.levels[k];
  look_up(levels, parts.frame, parts.scale, directions, roughness, wanted, count, result);
}

void Environment::irradiance(const BlockVectors& normals, int count, BlockVectors& result) const {
  DirectionLevels levels;
  levels.maps[0] = &parts_->irradiance;
  look_up(levels, parts_->frame, parts_->scale, normals, nullptr, nullptr, count, result);
}

vec3 Environment::sun_direction() const { return parts_->sun_direction; }
vec3 Environment::sun_irradiance() const { return parts_->sun_irradiance; }
bool Environment::sun_visible() const { return parts_->sun_visible; }

vec3 Environment::sun_glare(vec3 direction, float variance) const {
  // exp(-(1 - cos) / s) / (2 pi s (1 - exp(-2 / s))) integrates to one over the sphere; a Gaussian of variance s.
  const float s = kSunVariance + std::max(variance, 0.0f);
  // Half the squared chord is 1 - cos without its cancellation.
  const vec3 chord = direction - parts_->sun_direction;
  const float above = 0.5f * glm::dot(chord, chord);
  if (above > 30.0f * s) return vec3{0.0f};
  const float backwards = s > 0.05f ? std::exp(-2.0f / s) : 0.0f;
  return parts_->sun_irradiance * (std::exp(-above / s) / (2.0f * std::numbers::pi_v<float> * s * (1.0f - backwards)));
}

}  // namespace meniscus
