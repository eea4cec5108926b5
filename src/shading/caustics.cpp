#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "shading/caustics_map.h"
#include "shading/light_map.h"

namespace meniscus {
namespace {

constexpr int kLargestScreen = 1 << 12;

void require(bool valid, const char* name, double value, const char* expected) {
  if (!valid)
    throw Error(ErrorCode::invalid_argument, {fmt::format("caustics cannot be drawn with this {}", name),
                                              expected,
                                              fmt::format("{}", value),
                                              {},
                                              {},
                                              {},
                                              {}});
}

void require_options(const CausticsOptions& options) {
  require(options.screen_width >= 0 && options.screen_width <= kLargestScreen, "screen width", options.screen_width,
          "0 .. 4096 px");
  require(options.screen_height >= 0 && options.screen_height <= kLargestScreen, "screen height", options.screen_height,
          "0 .. 4096 px");
  require(options.screen_width != 1 && options.screen_height != 1, "screen", 1, "at least 2 px a side");
  require(options.iterations >= 1 && options.iterations <= 256, "number of iterations", options.iterations, "1 .. 256");
  require(options.threshold >= 0 && std::isfinite(options.threshold), "threshold",
          static_cast<double>(options.threshold), "a length >= 0 m");
  require(
      options.map_size >= 0 && options.map_size <= kLargestScreen && (options.map_size == 0 || options.map_size > 15),
      "map size", options.map_size, "0, or 16 .. 4096 texels");
  require(options.most_lights >= 0, "number of lights", options.most_lights, ">= 0");
}

/// All lights together.
class Caustics : public WaterLight {
 public:
  Caustics(std::vector<LightCast> casts, std::vector<PointLight> lamps, std::shared_ptr<const WaterLight> sky)
      : casts_(std::move(casts)), lamps_(std::move(lamps)), sky_(std::move(sky)) {}

  Light at(vec3 point, vec3 normal) const override {
    Light light;
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
  std::vector<PointLight> lamps_;
  std::shared_ptr<const WaterLight> sky_;
};

}  // namespace

std::shared_ptr<const WaterLight> caustics(const Surface& surface, const Scene& scene, const Material& material,
                                           const CausticsOptions& options, StageTimes* times, const Bounds& region) {
  require_options(options);
  const Bounds box = casting_box(surface, region);
  std::vector<LightCast> casts;
  if (box.empty()) return std::make_shared<Caustics>(std::move(casts), scene.lamps(), nullptr);
  for (const LightSource& light : caustics_lights(scene, box, options.most_lights)) {
    casts.push_back(cast_light(surface, light, box, scene, material, options, times));
    casts.back().screen = {};
  }
  std::shared_ptr<const WaterLight> sky;
  {
    const StageTimer timer(times, "caustics sky");
    sky = sky_shadow(surface, scene.environment(), scene.ground(), material, region, !scene.solid_bounds().empty());
  }
  return std::make_shared<Caustics>(std::move(casts), scene.lamps(), std::move(sky));
}

}  // namespace meniscus
