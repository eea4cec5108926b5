/// What Surroundings are made of.
#pragma once

#include <array>
#include <vector>

#include "meniscus/shading.h"
#include "scene/direction_map.h"

namespace meniscus {

struct Surroundings::Parts {
  static constexpr int kLevels = 4;
  /// Radians by which each level is blurred.
  static constexpr std::array<float, kLevels> kBlurs{0.0f, 0.12f, 0.35f, 0.9f};

  std::array<DirectionMap, kLevels> levels;
  vec3 mean{0.0f};
  vec3 sun_direction{0, 1, 0};  ///< unit, towards the sun
  vec3 sun_irradiance{0.0f};    ///< on what faces it; zero where a solid hides it from the centre
  std::vector<PointLight> lamps;

  /// Surroundings::radiance().
  vec3 radiance(vec3 direction, float cone) const {
    if (!(cone > 0)) return levels[0].at(direction);
    std::size_t k = 1;
    while (k + 1 < kLevels && cone > kBlurs[k]) ++k;
    const float t = (cone - kBlurs[k - 1]) / (kBlurs[k] - kBlurs[k - 1]);
    if (t >= 1) return levels[k].at(direction);
    return (1.0f - t) * levels[k - 1].at(direction) + t * levels[k].at(direction);
  }
};

}  // namespace meniscus
