#include "shading/caustics_landing.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "meniscus/formulas/optics.h"
#include "shading/image_space.h"

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Water that is seen to be this much thinner than the way down to the solid is a drop or a sheet above it.
constexpr float kThin = 0.6f;
/// Depths below this part of the box's diagonal are not asked whether they are thin.
constexpr float kShallow = 0.02f;
/// A surface hides another when it stands this many pixels of the map before it.
constexpr float kBias = 1.5f;

/// Finds landings one point at a time; holds what they share.
class Lander {
 public:
  Lander(const VirtualScreen& screen, const Surface& surface, const LightSource& light, const Scene& scene,
         const Material& material, const SceneMap* map, const CausticsOptions& options)
      : screen_(screen),
        light_(light),
        scene_(scene),
        material_(material),
        map_(map),
        options_(options),
        extinction_(caustics_extinction(material)),
        solids_(!scene.solid_bounds().empty()) {
    const Bounds box = surface.bounds();
    shallow_ = kShallow * glm::length(box.extent());
    // Surfaces that know no thickness say nothing: then no drop can be told from the pool.
    if (!options.single_interface && !surface.can_march())
      thin_known_ =
          std::any_of(screen.seen.thickness.begin(), screen.seen.thickness.end(), [](float t) { return t > 0; });
  }

  LightLanding land(int x, int y) const {
    LightLanding landing;
    landing.state = LandingState::lost;
    landing.covered = screen_.seen.coverage(x, y);
    landing.from = landing.exit = screen_.point(x, y);
    const vec3 normal = glm::normalize(screen_.seen.normal(x, y));
    const vec3 to_light = light_.towards(landing.from);
    landing.cos_i = glm::dot(normal, to_light);
    if (!(landing.cos_i > 0) || !material_.transparent) return landing;

    // Snell and Fresnel.
    const formulas::Interface interface = formulas::fresnel(landing.cos_i, material_.ior);
    landing.transmittance = 1.0f - std::min(1.0f, interface.reflectance * material_.specular);
    landing.direction = formulas::refracted(-to_light, normal, material_.ior, interface.cos_t);
    if (solids_ &&
        (light_.sun ? scene_.shadowed(landing.from, to_light) : scene_.blocked(landing.from, light_.position)))
      landing.transmittance = 0;
    if (!meet({landing.from, landing.direction}, landing)) return landing;
    landing.path = glm::length(landing.point - landing.from);

    // A drop in the air: the light leaves it at its far side and goes on as it came.
    if (thin_known_) {
      const float down = glm::dot(landing.from - landing.point, screen_.up);
      const float steepness = std::abs(glm::dot(screen_.ray(x, y).direction, screen_.up));
      const float thickness = screen_.seen.thickness(x, y);
      if (down > shallow_ && steepness > 0.05f && thickness < kThin * down / steepness) {
        landing.way = 1;
        landing.direction = -to_light;
        if (!meet({landing.from, -to_light}, landing)) return landing;
        landing.later = landing.transmittance;
        landing.path = thickness;
      }
    }
    landing.passed = landing.transmittance * landing.later * formulas::beer_lambert(extinction_, landing.path);
    landing.state = LandingState::landed;
    return landing;
  }

 private:
  /// Point and normal of what the ray meets first.
  bool meet(const Ray& ray, LightLanding& landing) const {
    if (map_ && meet_in_map(ray, landing)) return true;
    const SolidHit hit = scene_.hit(ray);
    if (!hit.found()) return false;
    landing.point = ray.origin + hit.distance * ray.direction;
    landing.normal = hit.face_normal;
    return true;
  }

  /// Fails where the iteration does not come to its end in the picture.
  bool meet_in_map(const Ray& ray, LightLanding& landing) const {
    const vec3 start = map_->view.project(ray.origin);
    const ImageSpaceHit hit = image_space_hit(
        {map_->view, &map_->depth}, ray, {start.x, start.y},
        options_.threshold > 0 ? options_.threshold : 0.5f * map_->view.pixel_size(0.0f), options_.iterations);
    if (!hit.met || !hit.in_picture) return false;
    const vec3 normal = map_->normal(std::clamp(static_cast<int>(hit.picture.x), 0, map_->normal.width() - 1),
                                     std::clamp(static_cast<int>(hit.picture.y), 0, map_->normal.height() - 1));
    if (!(glm::dot(normal, ray.direction) < 0)) return false;
    landing.point = hit.point;
    landing.normal = normal;
    return true;
  }

  const VirtualScreen& screen_;
  const LightSource& light_;
  const Scene& scene_;
  const Material& material_;
  const SceneMap* map_;
  const CausticsOptions& options_;
  vec3 extinction_;
  bool solids_, thin_known_ = false;
  float shallow_ = 0;
};

}  // namespace

SceneMap::Hidden SceneMap::hides(vec3 point, vec3 face) const {
  const vec3 at = view.project(point);
  const float x = std::clamp(at.x - 0.5f, 0.0f, static_cast<float>(depth.width()) - 1.001f);
  const float y = std::clamp(at.y - 0.5f, 0.0f, static_cast<float>(depth.height()) - 1.001f);
  const int i = static_cast<int>(x), j = static_cast<int>(y);
  const int i1 = std::min(i + 1, depth.width() - 1), j1 = std::min(j + 1, depth.height() - 1);
  const float a = depth(i, j), b = depth(i1, j), c = depth(i, j1), d = depth(i1, j1);
  const float before = at.z - bias(face);
  return {before > std::max({a, b, c, d}), before > std::min({a, b, c, d})};
}

float SceneMap::bias(vec3 face) const {
  const float c = std::clamp(-glm::dot(face, view.forward), 0.1f, 1.0f);
  return kBias * view.pixel_size(0.0f) * (1.0f + std::sqrt(1.0f - c * c) / c);
}

SceneMap see_solids(const View& view, const Scene& scene, FunctionRef<float(const Ray&)> from) {
  SceneMap map{view, Image<float>(view.width, view.height, kInfinity), Image<vec3>(view.width, view.height)};
  parallel_for(static_cast<std::size_t>(view.height), 8, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
      for (int x = 0; x < view.width; ++x) {
        const Ray ray = view.ray({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
        const SolidHit hit = scene.hit(ray, {}, std::max(0.0f, from(ray)));
        if (!hit.found()) continue;
        map.depth(x, y) = hit.distance;
        map.normal(x, y) = hit.face_normal;
      }
  });
  return map;
}

vec3 caustics_extinction(const Material& material) { return material.extinction + 0.35f * material.scattering; }

Image<LightLanding> land(const VirtualScreen& screen, const Surface& surface, const LightSource& light,
                         const Scene& scene, const Material& material, const SceneMap* map,
                         const CausticsOptions& options) {
  const Lander lander(screen, surface, light, scene, material, map, options);
  Image<LightLanding> landings(screen.width, screen.height);
  parallel_for(static_cast<std::size_t>(screen.height), 8, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
      for (int x = 0; x < screen.width; ++x)
        if (screen.is_wet(x, y)) landings(x, y) = lander.land(x, y);
  });
  if (surface.can_march() && !options.single_interface && material.transparent)
    follow(screen, surface, scene, material, landings);
  return landings;
}

vec3 caustic_intensity(vec3 light, const LightLanding& landing, vec3 extinction, float flux_ratio, vec3 reflectance,
                       vec3 ambient) {
  return light * landing.cos_i * landing.transmittance * formulas::beer_lambert(extinction, landing.path) * flux_ratio *
             reflectance +
         ambient;
}

}  // namespace meniscus
