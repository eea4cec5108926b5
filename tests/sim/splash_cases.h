/// Drops that fall on all there is, for the tests of splashes.
#pragma once

#include <vector>

#include "base/random.h"
#include "meniscus/sim.h"
#include "sim/splash_make.h"

namespace meniscus {

inline constexpr GroundMaterial kMaterials[] = {GroundMaterial::concrete, GroundMaterial::asphalt,
                                                GroundMaterial::steel};
inline constexpr Wetness kWetnesses[] = {Wetness::dry, Wetness::wet, Wetness::puddle_3mm, Wetness::puddle_5mm,
                                         Wetness::puddle_10mm};
inline constexpr float kDiameters[] = {0.001f, 0.002f, 0.004f};  ///< m; small, medium, large

inline Impact impact_on(GroundMaterial material, Wetness wetness, std::uint64_t id = 1, float diameter = 0.002f) {
  Impact impact;
  impact.id = id;
  impact.velocity = {0, -6.5f, 0};
  impact.diameter = diameter;
  impact.material = material;
  impact.wetness = wetness;
  return impact;
}

struct MadeSplash {
  Splash splash;
  std::vector<Droplet> droplets;
};
inline MadeSplash made(const Impact& impact, const SplashOptions& options = {}) {
  MadeSplash m;
  m.splash = make_splash(impact, options, m.droplets);
  return m;
}

/// Impacts of all kinds, here and there within `size` m, from all sides, on slopes too, in the second before 0 s.
inline std::vector<Impact> all_kinds_of_impacts(std::size_t count, float size, bool level_ground = false) {
  std::vector<Impact> impacts;
  Draws draws(7);
  for (std::size_t i = 0; i < count; ++i) {
    Impact impact =
        impact_on(kMaterials[draws.bits() % 3], kWetnesses[draws.bits() % 5], 1000 + i, kDiameters[draws.bits() % 3]);
    const auto any = [&](double low, double high) { return static_cast<float>(draws.between(low, high)); };
    impact.time = -draws.uniform();
    impact.point = {any(-size, size), any(-0.2, 0.2), any(-size, size)};
    impact.velocity = {any(-4, 4), any(-8, -3), any(-4, 4)};
    impact.wind = {any(-4, 4), 0, any(-4, 4)};
    if (!level_ground) impact.normal = {any(-0.7, 0.7), 1, any(-0.7, 0.7)};
    impacts.push_back(impact);
  }
  return impacts;
}

}  // namespace meniscus
