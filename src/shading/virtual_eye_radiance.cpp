#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "shading/schlick.h"
#include "shading/virtual_eye.h"

namespace meniscus {
namespace {

/// A surface that leans more than this from the water's plane (its cosine) is a side of the water: the maps are not
/// made for it.
constexpr float kSide = 0.1f;
constexpr float kEndless = 1e30f;

/// What a look shows through clear air.
vec3 in_air(const EyeLook& look, vec3 environment) {
  const vec3 behind = look.still + (1.0f - look.still_alpha) * environment;
  return look.object + (1.0f - look.object_alpha) * behind;
}

/// What it shows through water.
/// @param most  m of water on the way at most
vec3 in_water(const EyeLook& look, vec3 environment, float most, const Material& material, vec3 light) {
  vec3 seen{0.0f};
  if (look.object_alpha < 1.0f) {
    const vec3 behind = look.still + (1.0f - look.still_alpha) * environment;
    const float path = std::min({look.still_distance, most, kEndless});
    seen = (1.0f - look.object_alpha) * through_medium(behind, path, material, light);
  }
  if (look.object_alpha > 0) {
    const vec3 shown = look.object / look.object_alpha;
    seen += look.object_alpha * through_medium(shown, look.object_distance, material, light);
  }
  return seen;
}

/// The rays of one kind of many samples, and what lies along them.
struct Looks {
  std::vector<Ray> rays;
  std::vector<EyeLook> looks;
  std::vector<std::uint32_t> of;  ///< index of each ray's sample
  float width = 0, spread = 0;    ///< sums over the rays

  void clear() {
    rays.clear();
    of.clear();
    width = spread = 0;
  }
  void add(std::uint32_t sample, const Ray& ray, Beam beam) {
    rays.push_back(ray);
    of.push_back(sample);
    width += beam.width;
    spread += beam.spread;
  }
  void look(const EyeSide& side) {
    looks.resize(rays.size());
    if (rays.empty()) return;
    const float count = static_cast<float>(rays.size());
    side.look(rays, {width / count, spread / count}, looks);
  }
};

/// One piece of the picture.
class Piece {
 public:
  Piece(std::span<const Sample> samples, std::span<const Material> materials, const VirtualEyes& eyes,
        const Scene& scene, std::span<vec3> seen)
      : samples_(samples),
        materials_(materials),
        eyes_(eyes),
        scene_(scene),
        environment_(scene.environment()),
        seen_(seen) {}

  void from_air() {
    thread_local std::vector<Refraction> refractions;
    thread_local Looks through, mirrored;
    thread_local std::vector<Mirror> mirrors;
    refractions.resize(samples_.size());
    mirrors.resize(samples_.size());
    through.clear();
    mirrored.clear();
    for (std::uint32_t i = 0; i < samples_.size(); ++i) {
      const Sample& sample = samples_[i];
      seen_[i] = vec3{0.0f};
      if (is_side(sample)) {
        seen_[i] = transparent_radiance(sample, scene_, material(i));
        continue;
      }
      const Refraction& refraction = refractions[i] = refraction_of(sample, material(i));
      if (refraction.reflectance < 1.0f)
        through.add(i, {refraction.point, refraction.direction}, refraction.beam(sample, 0));
      if (refraction.reflectance > 0) {
        mirrors[i] = mirror_of(sample, material(i));
        mirrored.add(i, mirrors[i].ray, mirrors[i].beam);
      }
    }
    through.look(eyes_.refracted());
    for (std::size_t k = 0; k < through.of.size(); ++k) {
      const std::uint32_t i = through.of[k];
      const EyeLook& look = through.looks[k];
      // Where nothing is met the thickness tells how much water there is.
      float most = kEndless;
      vec3 beyond{0.0f};
      if (look.still_alpha < 1.0f) beyond = environment_.radiance(through.rays[k].direction);
      if (!(look.still_alpha > 0)) most = refractions[i].water_path(samples_[i], kEndless);
      seen_[i] = in_water(look, beyond, most, material(i), light_of(i));
    }
    mirrored.look(eyes_.reflected());
    for (std::size_t k = 0; k < mirrored.of.size(); ++k) {
      const std::uint32_t i = mirrored.of[k];
      const EyeLook& look = mirrored.looks[k];
      vec3 sky{0.0f};
      if (look.object_alpha < 1.0f && look.still_alpha < 1.0f)
        sky = environment_.radiance(mirrors[i].ray.direction, mirrors[i].roughness);
      const vec3 image = in_air(look, sky) + mirrored_sun(samples_[i], mirrors[i], scene_);
      seen_[i] = glm::mix(seen_[i], image, refractions[i].reflectance);
    }
  }

  void from_water() {
    thread_local Looks outside, mirrored;
    thread_local std::vector<float> reflectances, distances;
    thread_local std::vector<Ray> rays;
    outside.clear();
    mirrored.clear();
    reflectances.resize(samples_.size());
    distances.resize(samples_.size());
    rays.clear();
    for (const Sample& sample : samples_) rays.push_back(sample.ray);
    scene_.distances(rays, distances);
    for (std::uint32_t i = 0; i < samples_.size(); ++i) {
      const Sample& sample = samples_[i];
      const vec3 direction = sample.ray.direction;
      seen_[i] = vec3{0.0f};
      reflectances[i] = 0;
      if (is_side(sample)) {
        seen_[i] = window_radiance(sample, scene_, material(i));
        continue;
      }
      // A solid may be nearer than the surface.
      if (distances[i] <= sample.depth) {
        seen_[i] = deep_radiance(sample.ray, sample.beam, scene_, material(i));
        continue;
      }
      const vec3 point = sample.ray.origin + sample.depth * direction;
      const float eta = 1.0f / material(i).ior;
      const formulas::Interface interface = interface_of(-glm::dot(direction, sample.normal), eta, sample.fresnel);
      reflectances[i] = interface.reflectance;
      const Beam beam{sample.beam.width + sample.beam.spread * sample.depth, sample.beam.spread};
      if (interface.reflectance > 0)
        mirrored.add(i, {point, glm::normalize(formulas::mirrored(direction, sample.normal))}, beam);
      if (interface.cos_t > 0)
        outside.add(i, {point, formulas::refracted(direction, sample.normal, eta, interface.cos_t)}, beam);
    }
    mirrored.look(eyes_.reflected());
    for (std::size_t k = 0; k < mirrored.of.size(); ++k) {
      const std::uint32_t i = mirrored.of[k];
      const vec3 beyond = environment_.radiance(mirrored.rays[k].direction);
      seen_[i] = in_water(mirrored.looks[k], beyond, kEndless, material(i), light_of(i));
    }
    outside.look(eyes_.refracted());
    for (std::size_t k = 0; k < outside.of.size(); ++k) {
      const std::uint32_t i = outside.of[k];
      const vec3 direction = outside.rays[k].direction;
      vec3 sky = environment_.radiance(direction, std::min(1.0f, material(i).roughness));
      sky = in_air(outside.looks[k], sky);
      sky += glare(environment_, direction, 0.25f * samples_[i].normal_variance);
      seen_[i] = glm::mix(sky, seen_[i], reflectances[i]);
    }
    for (const Looks* looks : {&outside, &mirrored})
      for (const std::uint32_t i : looks->of)
        if (reflectances[i] >= 0) {  // once
          seen_[i] = through_medium(seen_[i], samples_[i].depth, material(i), light_of(i));
          reflectances[i] = -1;
        }
  }

 private:
  const Material& material(std::size_t i) const { return materials_[materials_.size() == 1 ? 0 : i]; }
  bool is_side(const Sample& sample) const {
    return !eyes_.sides_too() && glm::dot(sample.normal, eyes_.plane().normal) < kSide;
  }
  /// Light in turbid water.
  vec3 light_of(std::size_t i) const {
    if (material(i).scattering == vec3{0.0f}) return vec3{0.0f};
    return diffuse_light(environment_, samples_[i].normal, 0.5f);
  }

  std::span<const Sample> samples_;
  std::span<const Material> materials_;
  const VirtualEyes& eyes_;
  const Scene& scene_;
  const Environment& environment_;
  std::span<vec3> seen_;
};

}  // namespace

void virtual_eye_radiance(std::span<const Sample> samples, std::span<const Material> materials, const VirtualEyes& eyes,
                          const Scene& scene, bool eye_in_water, std::span<vec3> seen) {
  if (samples.empty()) return;
  Piece piece(samples, materials, eyes, scene, seen);
  if (eye_in_water)
    piece.from_water();
  else
    piece.from_air();
}

}  // namespace meniscus
