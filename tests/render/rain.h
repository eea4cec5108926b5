/// Small scenes in the rain.
#pragma once

#include <glm/gtc/matrix_transform.hpp>

#include "meniscus/render.h"

namespace meniscus {

/// Rain on a square of level ground without noise, y up.
inline RainSettings rain_on_square(float half_edge, float rate_mm_h = 100) {
  RainSettings settings;
  settings.ground.there = true;
  settings.ground.cells.low = vec2(-half_edge);
  settings.ground.cells.high = vec2(half_edge);
  settings.ground.cells.cell = 0.05f;
  settings.ground.cells.roughness = 0;
  settings.rain.rate_mm_h = rate_mm_h;
  settings.rain.low = vec2(-half_edge - 0.5f);
  settings.rain.high = vec2(half_edge + 0.5f);
  settings.rain.level = -0.01f;
  settings.rain.top = 5;
  settings.rain.share = 1;
  settings.rain.smallest_mm = 1;
  return settings;
}

/// Nothing but a plane just under the ground.
inline Scene empty_scene(float height = -0.001f) {
  Ground ground;
  ground.height = height;
  return Scene(Environment{EnvironmentOptions{}}, ground);
}

/// A box from `low` to `high`.
inline PlacedSolid box(vec3 low, vec3 high) { return {make_solid(box_mesh(low, high)), glm::mat4(1.0f), {}, false}; }

}  // namespace meniscus
