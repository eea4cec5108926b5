/// The sky that the scene's tests share.
#pragma once

#include "meniscus/scene.h"

namespace meniscus {

inline const Environment& test_sky() {
  static const Environment environment{EnvironmentOptions{}};
  return environment;
}

/// A scene of these solids alone, without ground.
inline Scene scene_of(std::vector<PlacedSolid> solids) {
  Ground ground;
  ground.visible = false;
  Scene scene(test_sky(), ground);
  scene.set_solids(std::move(solids));
  return scene;
}

}  // namespace meniscus
