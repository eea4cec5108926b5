#include "render/inside_solids.h"

#include <algorithm>
#include <cmath>

namespace meniscus {
namespace {

/// Faces above a point beyond which a mesh is taken to be broken.
constexpr int kMostFaces = 64;

}  // namespace

InsideSolids::InsideSolids(const Scene& scene) : up_(scene.ground().up) {
  Ground nothing = scene.ground();
  nothing.visible = false;
  for (const PlacedSolid& solid : scene.solids()) {
    Body body{Scene(scene.environment(), nothing), {}};
    body.alone.set_solids({solid});
    body.bounds = body.alone.solid_bounds();
    bodies_.push_back(std::move(body));
  }
}

bool InsideSolids::holds(vec3 point) const {
  for (const Body& body : bodies_) {
    const Bounds& box = body.bounds;
    if (point.x < box.low.x || point.y < box.low.y || point.z < box.low.z || point.x > box.high.x ||
        point.y > box.high.y || point.z > box.high.z)
      continue;
    const vec3 extent = box.extent();
    const float grain = 1e-5f * std::max({extent.x, extent.y, extent.z});
    int faces = 0;
    float from = 0;
    for (; faces < kMostFaces; ++faces) {
      const float met = body.alone.distance({point, up_}, from);
      if (!std::isfinite(met)) break;
      from = met + grain;
    }
    if (faces % 2 == 1) return true;
  }
  return false;
}

}  // namespace meniscus
