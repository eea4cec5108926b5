/// Shapes of obstacles as signed distances, in the body's own space.
#pragma once

#include <memory>
#include <vector>

#include "meniscus/sim.h"

namespace meniscus {

/// The surface as a point meets it.
struct NearestSurface {
  float distance = 0;    ///< m; negative inside
  vec3 normal{0, 1, 0};  ///< unit; out of the body, along the way to or from the surface's nearest point
};

class Shape {
 public:
  virtual ~Shape() = default;
  /// Exact up to rounding, at any place.
  virtual NearestSurface nearest(vec3 point) const = 0;
  /// The same if the surface's distance is at most `reach` m or the point is inside, else nothing: cheaper.
  virtual bool nearest_within(vec3 point, float reach, NearestSurface& nearest) const;

  const Bounds& bounds() const { return bounds_; }
  float radius() const { return radius_; }  ///< m, of a sphere around the origin that holds all of it
  /// Points spread over the surface, each the centre of a ball of touch_radius() inside it: what touches other bodies.
  const std::vector<vec3>& touch_points() const { return touch_points_; }
  float touch_radius() const { return touch_radius_; }
  float volume() const { return volume_; }           ///< m^3
  vec3 inertia_rel() const { return inertia_rel_; }  ///< principal moments for 1 kg, m^2; of boxes, spheres, cylinders

 protected:
  Bounds bounds_;
  float radius_ = 0, touch_radius_ = 0, volume_ = 0;
  std::vector<vec3> touch_points_;
  vec3 inertia_rel_{0.0f};
};

/// @throws Error  invalid_argument: a size that is not positive and finite; a mesh that is not closed, whose triangles
///                are not turned alike or that holds no volume, with the place where
std::unique_ptr<const Shape> make_shape(const ObstacleShape& shape);
/// Of Kind::mesh.
std::unique_ptr<const Shape> make_mesh_shape(const ObstacleShape& shape);

}  // namespace meniscus
