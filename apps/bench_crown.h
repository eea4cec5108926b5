/// The water crown as the benches draw it: clear water over a chequered ground, shaded by its thickness.
#pragma once

#include "meniscus/render.h"

namespace meniscus::apps {

/// How a crown's frame is shaded: one refraction at the surface, the far side guessed from the thickness, one
/// reflection.                                                                                  [Xiao2017] 3.4
class CrownLook {
 public:
  CrownLook();
  /// Linear radiance of what a surface has seen.
  Image<vec3> shaded(const View& view, const SurfaceBuffers& water, StageTimes* times = nullptr) const;
  const Material& material() const { return material_; }
  const Scene& scene() const { return scene_; }

 private:
  Material material_;
  Scene scene_;
};

/// The options that its surface is made by: all defaults.
RaycastOptions crown_options(const Particles& crown);

}  // namespace meniscus::apps
