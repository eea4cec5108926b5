// The panes of a glass tank, seen through.
#include "meniscus/formulas.h"
#include "scene/scene_parts.h"

namespace meniscus {

GlassPane Scene::glass(const Ray& ray, float distance) const {
  GlassPane result;
  if (!parts_->body) return result;
  const TankBody::Panes crossed = parts_->body->panes(ray, distance);
  // From the eye on: each pane's mirror image comes through those before it.
  for (int k = 0; k < crossed.count; ++k) {
    const TankBody::Pane& pane = crossed.panes[static_cast<std::size_t>(k)];
    const vec3 point = ray.origin + pane.distance * ray.direction;
    const Ray mirror{point + parts_->clearance(point) * pane.normal, formulas::mirrored(ray.direction, pane.normal)};
    result.added += result.transmittance * pane.reflectance * radiance(mirror, Beam{});
    result.transmittance *= pane.transmittance;
  }
  return result;
}

}  // namespace meniscus
