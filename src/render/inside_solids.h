/// Whether a point lies inside one of a scene's solid bodies.
#pragma once

#include <vector>

#include "meniscus/scene.h"

namespace meniscus {

/// Closed meshes are told by how often an upright ray leaves them; one that is open at the top has no inside.
class InsideSolids {
 public:
  explicit InsideSolids(const Scene& scene);
  bool empty() const { return bodies_.empty(); }
  bool holds(vec3 point) const;

 private:
  struct Body {
    Scene alone;  ///< nothing but this body
    Bounds bounds;
  };
  std::vector<Body> bodies_;
  vec3 up_;
};

}  // namespace meniscus
