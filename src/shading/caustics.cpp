#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "shading/caustics_field.h"
#include "shading/caustics_map.h"
#include "shading/caustics_options.h"
#include "shading/light_map.h"

namespace meniscus {
namespace {

/// All lights together.
class Caustics : public WaterLight {
 public:
  Caustics(std::vector<LightCast> casts, FieldLight field, std::vector<PointLight> lamps,
           std::shared_ptr<const WaterLight> sky)
      : casts_(std::move(casts)), field_(std::move(field)), lamps_(std::move(lamps)), sky_(std::move(sky)) {}

  Light at(vec3 point, vec3 normal) const override {
    Light light;
    if (field_.plane) light = field_.plane->at(point, normal);
    if (field_.walls) light.refracted += field_.walls->irradiance(point, normal);
    if (sky_) light.sky = sky_->at(point, normal).sky;
    // Lamps are asked for together: what is missing of each, weighted by its light.
    vec3 missing{0.0f};
    bool lamps = false;
    for (const LightCast& cast : casts_) {
      light.refracted += cast.refracted(point, normal);
      for (const UnbentLight& unbent : cast.unbent) {
        const float fraction = unbent.fraction(point);
        if (cast.light.sun)
          light.sun = vec3{fraction};
        else if (fraction < 1) {
          lamps = true;
          missing += (1.0f - fraction) * cast.light.irradiance(point) *
                     std::max(0.0f, glm::dot(normal, cast.light.towards(point)));
        }
      }
    }
    if (!lamps) return light;
    vec3 all{0.0f};
    for (const PointLight& lamp : lamps_) {
      const LightSource source{false, {}, lamp.position, lamp.intensity};
      all += source.irradiance(point) * std::max(0.0f, glm::dot(normal, source.towards(point)));
    }
    for (int c = 0; c < 3; ++c) light.lamps[c] = all[c] > 0 ? std::clamp(1.0f - missing[c] / all[c], 0.0f, 1.0f) : 1.0f;
    return light;
  }

 private:
  std::vector<LightCast> casts_;
  FieldLight field_;
  std::vector<PointLight> lamps_;
  std::shared_ptr<const WaterLight> sky_;
};

}  // namespace

std::shared_ptr<const WaterLight> caustics(const Surface& surface, const Scene& scene, const Material& material,
                                           const CausticsOptions& options, StageTimes* times, const Bounds& region) {
  require_caustics(options);
  const Bounds box = casting_box(surface, region);
  std::vector<LightCast> casts;
  FieldLight field;
  if (box.empty()) return std::make_shared<Caustics>(std::move(casts), std::move(field), scene.lamps(), nullptr);
  const std::vector<LightSource> lights = caustics_lights(scene, box, options.most_lights);
  // The sun by the water's heights; lamps, and what light does not pass, by triangles.
  const bool by_field = options.method != CausticsMethod::triangles && material.transparent;
  const bool walls = options.on_walls && (by_field || surface.height_field());
  for (const LightSource& light : lights) {
    if (light.sun && (by_field || walls)) {
      CausticsOptions asked = options;
      if (!by_field) asked.method = CausticsMethod::triangles;
      field = field_light(*FieldOf(surface, scene, box, times), light, scene, material, asked, times);
    }
    if (light.sun && by_field) continue;
    casts.push_back(cast_light(surface, light, box, scene, material, options, times));
    casts.back().screen = {};
  }
  std::shared_ptr<const WaterLight> sky;
  if (!field.plane) {
    const StageTimer timer(times, "caustics sky");
    sky = sky_shadow(surface, scene.environment(), scene.ground(), material, region, !scene.solid_bounds().empty());
  }
  return std::make_shared<Caustics>(std::move(casts), std::move(field), scene.lamps(), std::move(sky));
}

}  // namespace meniscus
