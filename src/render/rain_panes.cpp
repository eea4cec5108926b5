#include "render/rain_panes.h"

#include <algorithm>

namespace meniscus {

std::vector<PlacedSolid> glass_panes(const Tank& tank) {
  std::vector<PlacedSolid> panes;
  if (tank.style != TankStyle::glass || tank.inside.empty()) return panes;
  const vec3 extent = tank.inside.extent();
  const float thickness = tank.thickness > 0 ? tank.thickness : 0.01f * std::max({extent.x, extent.y, extent.z});
  const Bounds outside = tank.inside.grown(thickness);
  for (int axis = 0; axis < 3; ++axis) {
    if (tank.up[axis] > 0.5f) continue;
    for (const bool high : {false, true}) {
      // From floor to rim, the corners with it.
      Bounds pane = outside;
      for (int other = 0; other < 3; ++other)
        if (tank.up[other] > 0.5f) pane.low[other] = tank.inside.low[other], pane.high[other] = tank.inside.high[other];
      (high ? pane.low : pane.high)[axis] = high ? tank.inside.high[axis] : tank.inside.low[axis];
      panes.push_back({make_solid(box_mesh(pane.low, pane.high)), glm::mat4(1.0f), {}, false});
    }
  }
  return panes;
}

Scene with_solids(const Scene& scene, const std::vector<PlacedSolid>& more) {
  Scene all = scene;
  std::vector<PlacedSolid> solids = scene.solids();
  solids.insert(solids.end(), more.begin(), more.end());
  all.set_solids(std::move(solids));
  return all;
}

}  // namespace meniscus
