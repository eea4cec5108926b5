#include "meniscus/scene.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "scene/chequer.h"
#include "scene/direction_map.h"

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Sine of the angle under the horizon in which even an endless ground melts into the haze.
constexpr float kHorizonHaze = 0.012f;

float smooth(float t) {
  t = std::clamp(t, 0.0f, 1.0f);
  return t * t * t * (t * (6.0f * t - 15.0f) + 10.0f);
}

}  // namespace

Scene::Scene(Environment environment, Ground ground) : environment_(std::move(environment)), ground_(ground) {
  const float length = glm::length(ground_.up);
  if (!(length > 1e-12f) || !std::isfinite(length))
    throw Error(ErrorCode::invalid_argument, "the ground's up direction has no length");
  ground_.up /= length;
  const UpFrame frame = up_frame(ground_.up);
  u_axis_ = frame.east;
  v_axis_ = frame.north;
  constexpr float kPerPi = 1.0f / std::numbers::pi_v<float>;
  sun_exitance_ =
      environment_.sun_irradiance() * (kPerPi * std::max(0.0f, glm::dot(ground_.up, environment_.sun_direction())));
  sky_exitance_ = environment_.irradiance(ground_.up) * kPerPi;
}

void Scene::set_ground_light(std::shared_ptr<const GroundLight> light) { light_ = std::move(light); }
const Environment& Scene::environment() const { return environment_; }
const Ground& Scene::ground() const { return ground_; }

float Scene::ground_distance(const Ray& ray) const {
  const float down = -glm::dot(ray.direction, ground_.up);
  if (!ground_.visible || !(down > 1e-7f)) return kInfinity;
  return std::max(0.0f, (glm::dot(ray.origin, ground_.up) - ground_.height) / down);
}

vec3 Scene::ground_radiance(vec3 point, float width_u, float width_v) const {
  vec3 albedo = ground_.albedo;
  if (ground_.square > 0) {
    const float scale = 1.0f / ground_.square;
    const vec2 on_plane{glm::dot(point, u_axis_) * scale, glm::dot(point, v_axis_) * scale};
    albedo = glm::mix(ground_.second_albedo, ground_.albedo,
                      chequer_fraction(on_plane, vec2{width_u * scale, width_v * scale}));
  }
  if (!light_) return albedo * (sun_exitance_ + sky_exitance_);
  const GroundLight::Fractions light = light_->at(point);
  return albedo * (light.sun * sun_exitance_ + light.sky * sky_exitance_);
}

vec3 Scene::radiance(const Ray& ray, float footprint) const { return radiance(ray, Beam{0.0f, footprint}); }

vec3 Scene::radiance(const Ray& ray, Beam beam, float roughness) const {
  const float distance = ground_distance(ray);
  if (!(distance < kInfinity)) return environment_.radiance(ray.direction, roughness);

  // How much of the ground is left of the haze.
  const vec3 point = ray.origin + distance * ray.direction;
  const float cos_down = -glm::dot(ray.direction, ground_.up);
  float presence = smooth(cos_down / kHorizonHaze);
  if (ground_.fade_radius > 0) {
    const vec3 offset = point - ground_.centre;
    const float along = glm::dot(offset, ground_.up);
    const float from_centre = std::sqrt(std::max(0.0f, glm::dot(offset, offset) - along * along));
    presence *= 1.0f - smooth((from_centre / ground_.fade_radius - 0.15f) / 0.85f);
  }
  if (!(presence > 0)) return environment_.radiance(ray.direction, roughness);

  // The beam's cross-section on the plane is an ellipse, longer by 1 / cos along the ray; its extent along an axis.
  const float width = beam.width + beam.spread * distance;
  const float stretch = 1.0f / (cos_down * cos_down) - 1.0f;
  const float sin_squared = std::max(1e-12f, 1.0f - cos_down * cos_down);
  const float along_u = glm::dot(ray.direction, u_axis_), along_v = glm::dot(ray.direction, v_axis_);
  const vec3 seen = ground_radiance(point, width * std::sqrt(1.0f + stretch * along_u * along_u / sin_squared),
                                    width * std::sqrt(1.0f + stretch * along_v * along_v / sin_squared));
  if (presence >= 1.0f) return seen;
  return glm::mix(environment_.radiance(ray.direction, roughness), seen, presence);
}

}  // namespace meniscus
