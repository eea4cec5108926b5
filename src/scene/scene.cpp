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

/// Everything that a scene holds; shared by its copies, copied before it is changed.
struct Scene::Parts {
  Environment environment;
  Ground ground;
  Tank tank;
  std::vector<PlacedSolid> solids;
  std::vector<PointLight> lamps;
  std::shared_ptr<const WaterLight> water_light;
  vec3 u_axis{0}, v_axis{0};  ///< along the ground's squares
};

Scene::Scene(Environment environment, Ground ground) {
  const float length = glm::length(ground.up);
  if (!(length > 1e-12f) || !std::isfinite(length))
    throw Error(ErrorCode::invalid_argument, "the ground's up direction has no length");
  ground.up /= length;
  const UpFrame frame = up_frame(ground.up);
  parts_ = std::make_shared<Parts>(Parts{std::move(environment), ground, {}, {}, {}, {}, frame.east, frame.north});
}

void Scene::set_water_light(std::shared_ptr<const WaterLight> light) {
  auto changed = std::make_shared<Parts>(*parts_);
  changed->water_light = std::move(light);
  parts_ = std::move(changed);
}
void Scene::set_solids(std::vector<PlacedSolid> solids) {
  auto changed = std::make_shared<Parts>(*parts_);
  changed->solids = std::move(solids);
  parts_ = std::move(changed);
}
void Scene::set_tank(const Tank& tank) {
  auto changed = std::make_shared<Parts>(*parts_);
  changed->tank = tank;
  parts_ = std::move(changed);
}
void Scene::set_lamps(std::vector<PointLight> lamps) {
  auto changed = std::make_shared<Parts>(*parts_);
  changed->lamps = std::move(lamps);
  parts_ = std::move(changed);
}
const Environment& Scene::environment() const { return parts_->environment; }
const Ground& Scene::ground() const { return parts_->ground; }
const Tank& Scene::tank() const { return parts_->tank; }
const std::vector<PointLight>& Scene::lamps() const { return parts_->lamps; }
Bounds Scene::solid_bounds() const { return {}; }

float Scene::ground_distance(const Ray& ray) const {
  const Ground& ground = parts_->ground;
  const float down = -glm::dot(ray.direction, ground.up);
  if (!ground.visible || !(down > 1e-7f)) return kInfinity;
  return std::max(0.0f, (glm::dot(ray.origin, ground.up) - ground.height) / down);
}

SolidHit Scene::hit(const Ray& ray, Beam beam, float from, float limit) const {
  const Ground& ground = parts_->ground;
  SolidHit hit;
  const float distance = ground_distance(ray);
  if (!(distance < kInfinity) || distance < from || distance > limit) return hit;

  // How much of the ground is left of the haze.
  const vec3 point = ray.origin + distance * ray.direction;
  const float cos_down = -glm::dot(ray.direction, ground.up);
  float presence = smooth(cos_down / kHorizonHaze);
  if (ground.fade_radius > 0) {
    const vec3 offset = point - ground.centre;
    const float along = glm::dot(offset, ground.up);
    const float from_centre = std::sqrt(std::max(0.0f, glm::dot(offset, offset) - along * along));
    presence *= 1.0f - smooth((from_centre / ground.fade_radius - 0.15f) / 0.85f);
  }
  if (!(presence > 0)) return hit;
  hit.distance = distance;
  hit.normal = hit.face_normal = ground.up;
  hit.presence = presence;
  hit.albedo = ground.albedo;
  if (ground.square > 0) {
    // The beam's cross-section on the plane is an ellipse, longer by 1 / cos along the ray; its extent along an axis.
    const float width = beam.width + beam.spread * distance;
    const float stretch = 1.0f / (cos_down * cos_down) - 1.0f;
    const float sin_squared = std::max(1e-12f, 1.0f - cos_down * cos_down);
    const float along_u = glm::dot(ray.direction, parts_->u_axis), along_v = glm::dot(ray.direction, parts_->v_axis);
    const float scale = 1.0f / ground.square;
    const vec2 on_plane{glm::dot(point, parts_->u_axis) * scale, glm::dot(point, parts_->v_axis) * scale};
    const vec2 extent{width * std::sqrt(1.0f + stretch * along_u * along_u / sin_squared),
                      width * std::sqrt(1.0f + stretch * along_v * along_v / sin_squared)};
    hit.albedo = glm::mix(ground.second_albedo, ground.albedo, chequer_fraction(on_plane, extent * scale));
  }
  return hit;
}

float Scene::distance(const Ray& ray, float from) const { return hit(ray, {}, from).distance; }
bool Scene::blocked(vec3, vec3) const { return false; }
bool Scene::shadowed(vec3, vec3) const { return false; }

vec3 Scene::irradiance(vec3 point, vec3 normal, vec3) const {
  const Environment& environment = parts_->environment;
  WaterLight::Light light;
  if (parts_->water_light) light = parts_->water_light->at(point, normal);
  const float facing = std::max(0.0f, glm::dot(normal, environment.sun_direction()));
  return light.sun * environment.sun_irradiance() * facing + light.sky * environment.irradiance(normal) +
         light.refracted;
}

vec3 Scene::lit(const SolidHit& hit, const Ray& ray, Beam) const {
  constexpr float kPerPi = 1.0f / std::numbers::pi_v<float>;
  return hit.albedo * kPerPi * irradiance(ray.origin + hit.distance * ray.direction, hit.normal, hit.face_normal);
}

vec3 Scene::radiance(const Ray& ray, float footprint) const { return radiance(ray, Beam{0.0f, footprint}); }

vec3 Scene::radiance(const Ray& ray, Beam beam, float roughness) const {
  const SolidHit found = hit(ray, beam);
  if (!found.found()) return parts_->environment.radiance(ray.direction, roughness);
  const vec3 seen = lit(found, ray, beam);
  if (found.presence >= 1.0f) return seen;
  return glm::mix(parts_->environment.radiance(ray.direction, roughness), seen, found.presence);
}

SceneBuffers Scene::see(const View& view, std::span<const vec2> points, StageTimes* times) const {
  const StageTimer timer(times, "scene");
  const int width = points.empty() ? view.width : static_cast<int>(points.size());
  const int height = points.empty() ? view.height : 1;
  SceneBuffers seen{Image<vec3>(width, height), Image<float>(width, height, kInfinity), Image<vec3>(width, height),
                    Image<vec3>(width, height)};
  const bool orthographic = view.projection == Projection::orthographic;
  const Beam beam = orthographic ? Beam{view.pixel_size(1.0f), 0.0f} : Beam{0.0f, view.pixel_size(1.0f)};
  parallel_for(seen.depth.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t row = static_cast<std::size_t>(width);
      const Ray ray = view.ray(
          points.empty() ? vec2{static_cast<float>(i % row) + 0.5f, static_cast<float>(i / row) + 0.5f} : points[i]);
      const SolidHit found = hit(ray, beam);
      seen.radiance[i] = radiance(ray, beam);
      if (!found.found()) continue;
      seen.depth[i] = found.distance;
      seen.normal[i] = found.normal;
      seen.albedo[i] = found.albedo;
    }
  });
  return seen;
}

GlassPane Scene::glass(const Ray&, float) const { return {}; }

}  // namespace meniscus
