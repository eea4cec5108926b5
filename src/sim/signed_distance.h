/// Signed distances from closed meshes by Embree's point queries [Wald2014].
#pragma once

#include <embree3/rtcore.h>
#include <memory>

#include "sim/shape.h"
#include "sim/signed_distance_mesh.h"

namespace meniscus {

class MeshDistance {
 public:
  /// @throws Error as close_mesh(); limit_exceeded: no memory
  explicit MeshDistance(ClosedMesh mesh);
  /// The surface's nearest point, if it is within `limit` m.
  /// @return false if it is not
  bool nearest(vec3 point, float limit, NearestSurface& nearest) const;
  const ClosedMesh& mesh() const { return mesh_; }

 private:
  struct ReleaseScene {
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
  };
  ClosedMesh mesh_;
  std::unique_ptr<RTCSceneTy, ReleaseScene> scene_;
};

/// The point of a triangle that is nearest, and on which of its parts it lies: 0 its face, 1 .. 3 the edges from its
/// corners 0 .. 2, 4 .. 6 its corners.                                                         [Ericson2005] 5.1.5
struct TrianglePoint {
  vec3 point;
  int part = 0;
};
TrianglePoint nearest_on_triangle(vec3 point, vec3 a, vec3 b, vec3 c);

}  // namespace meniscus
