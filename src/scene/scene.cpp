#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "scene/direction_map.h"
#include "scene/scene_parts.h"

namespace meniscus {
namespace {

float largest(vec3 v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

}  // namespace

Scene::Scene(Environment environment, Ground ground) {
  const float length = glm::length(ground.up);
  if (!(length > 1e-12f) || !std::isfinite(length))
    throw Error(ErrorCode::invalid_argument, "the ground's up direction has no length");
  ground.up /= length;
  const UpFrame frame = up_frame(ground.up);
  auto parts = std::make_shared<Parts>(Parts{.environment = std::move(environment), .ground = ground});
  parts->u_axis = frame.east;
  parts->v_axis = frame.north;
  parts->aim_at_sun();
  parts_ = std::move(parts);
}

void Scene::set_water_light(std::shared_ptr<const WaterLight> light) {
  auto changed = std::make_shared<Parts>(*parts_);
  changed->water_light = std::move(light);
  parts_ = std::move(changed);
}

void Scene::set_solids(std::vector<PlacedSolid> solids) {
  auto changed = std::make_shared<Parts>(*parts_);
  changed->placed = solids;
  changed->solids = solids.empty() ? nullptr : std::make_shared<const PlacedSolids>(std::move(solids));
  changed->grain = changed->sun_path.grain =
      changed->solids ? 1e-5f * largest(changed->solids->bounds().extent()) : 0.0f;
  parts_ = std::move(changed);
}

void Scene::set_tank(const Tank& tank) {
  auto changed = std::make_shared<Parts>(*parts_);
  changed->tank = tank;
  changed->body = tank.style == TankStyle::none ? nullptr : std::make_shared<const TankBody>(tank);
  for (int axis = 0; axis < 3; ++axis)
    changed->sun_path.through_pane[axis] =
        changed->body ? changed->body->pane(std::abs(changed->sun_path.direction[axis])).transmittance : vec3{1.0f};
  parts_ = std::move(changed);
}

void Scene::set_lamps(std::vector<PointLight> lamps) {
  const auto finite = [](vec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); };
  for (const PointLight& lamp : lamps)
    if (!finite(lamp.position) || !finite(lamp.intensity) || lamp.intensity.x < 0 || lamp.intensity.y < 0 ||
        lamp.intensity.z < 0)
      throw Error(ErrorCode::invalid_argument, "a lamp's place or intensity is not finite, or it takes light away");
  auto changed = std::make_shared<Parts>(*parts_);
  changed->lamps = std::move(lamps);
  parts_ = std::move(changed);
}

void Scene::set_ground_cover(std::shared_ptr<const GroundCover> cover) {
  auto changed = std::make_shared<Parts>(*parts_);
  changed->cover = std::move(cover);
  parts_ = std::move(changed);
}

const Environment& Scene::environment() const { return parts_->environment; }
const Ground& Scene::ground() const { return parts_->ground; }
const Tank& Scene::tank() const { return parts_->tank; }
const std::vector<PointLight>& Scene::lamps() const { return parts_->lamps; }
const std::vector<PlacedSolid>& Scene::solids() const { return parts_->placed; }

Bounds Scene::solid_bounds() const {
  Bounds box;
  if (parts_->solids) box.add(parts_->solids->bounds());
  if (parts_->body) box.add(parts_->body->bounds());
  return box;
}

}  // namespace meniscus
