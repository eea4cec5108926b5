/// A picture of all directions by longitude and latitude.
#pragma once

#include "meniscus/base.h"

namespace meniscus {

/// Directions have z up. The picture's centre lies towards +y, its upper edge is +z.
class Equirectangular {
 public:
  Equirectangular() = default;
  explicit Equirectangular(Image<vec3> picture);
  /// Interpolated radiance.
  vec3 at(vec3 direction) const;
  bool empty() const { return picture_.empty(); }

  /// What was taken out of the map as the sun.
  struct Sun {
    bool found = false;
    vec3 direction{0, 0, 1};
    vec3 irradiance{0.0f};  ///< on a surface that faces it
  };
  /// Finds a sun: a spot within 6 degrees of the brightest pixel that gives at least a twentieth of all light and is
  /// 20 times as bright as the ring around it. It is replaced by the ring's radiance.
  Sun take_sun();

 private:
  vec3 direction_of(int x, int y) const;
  Image<vec3> picture_;
};

}  // namespace meniscus
