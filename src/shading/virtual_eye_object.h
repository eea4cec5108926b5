/// An object's own virtual eyes.                                                          [Cords2008] 2.1
#pragma once

#include <optional>

#include "meniscus/shading.h"
#include "shading/approximating_plane.h"

namespace meniscus {

/// A ray of a map of one object.
struct MapRay {
  Ray ray;          ///< in the world: unit direction, from the place where it seems to come from
  float from = 0;   ///< m along it to the plane
  float scale = 1;  ///< m along it for one metre in the map
};

/// Rays from one virtual eye, for each direction in which a map is looked up.
class VirtualEye {
 public:
  /// The eye below the plane that sees the object's part on the eye's own side.             [Cords2008] eq. 1
  static VirtualEye reflected(const ApproximatingPlane& plane, vec3 eye);
  /// The one that sees the part behind the plane.                                           [Cords2008] eq. 2, 3
  /// @param ratio  index of refraction on the eye's side over that behind the plane
  static VirtualEye refracted(const ApproximatingPlane& plane, vec3 eye, const WaterObject& object, float ratio,
                              const VirtualEyeOptions& options);
  /// The same of a plane without an object: exact where it is seen at `a`.
  static VirtualEye refracted(const ApproximatingPlane& plane, vec3 eye, vec3 a, float ratio,
                              const VirtualEyeOptions& options);

  /// @param direction  unit, in which the map is looked up; nothing if no such ray leaves the plane
  std::optional<MapRay> ray(vec3 direction) const;
  vec3 position() const { return position_; }
  const ApproximatingPlane& plane() const { return plane_; }
  /// Factor of the object's length along its axis, and the point that stays where it is.    [Cords2008] fig. 3
  float scale() const { return scale_; }
  /// Factor of its width, so that it goes on at the surface as wide as it is above.
  float scale_across() const { return across_; }
  vec3 pivot() const { return pivot_; }

 private:
  ApproximatingPlane plane_;
  vec3 eye_{0.0f}, position_{0.0f};
  float ratio_ = 1;
  bool reflected_ = false, per_point_ = false;
  float scale_ = 1, across_ = 1;  ///< along the axis and across it
  vec3 pivot_{0.0f}, axis_{0, 1, 0};
};

/// The point of the plane and of the object that is nearest to the eye: where the straight line between the eye's
/// projection onto the plane and the cut of the object's main axis with the plane meets the object's bounding box. For
/// an object that does not stand through the plane: the nearest point of the line to its box, as seen along the normal.
vec3 nearest_point(const ApproximatingPlane& plane, vec3 eye, const WaterObject& object);

}  // namespace meniscus
