/// Clear daylight sky [Preetham1999], overcast sky [CIE2003], with a hazy lower half.
#pragma once

#include "meniscus/base.h"

namespace meniscus {

/// Radiance of the sky without the sun, and the sun's irradiance. Directions have z up.
class Sky {
 public:
  /// @param sun    unit; below the horizon the sky is that of the last light and the sun gives none
  /// @param cover  0 clear .. 1 overcast; between, both mixed
  explicit Sky(vec3 sun, float cover = 0);
  /// Linear radiance from a unit direction. Below the horizon: the haze of the horizon that turns into the colour
  /// of a ground of albedo 0.3 further down.
  vec3 radiance(vec3 direction) const;
  /// On a surface that faces the sun.
  vec3 sun_irradiance() const { return sun_irradiance_; }

 private:
  struct Perez {
    float a, b, c, d, e, zenith;
    float at(float cos_theta, float gamma, float cos_gamma) const;
  };
  vec3 unscaled(vec3 direction) const;
  /// Of the upper half, clear and overcast mixed.
  vec3 above(vec3 direction) const;

  vec3 sun_;
  float cover_ = 0;
  vec3 overcast_zenith_{0.0f};  ///< radiance of the overcast sky's zenith
  Perez luminance_, x_, y_;
  vec3 scale_{1.0f};
  vec3 ground_{0.0f};
  vec3 sun_irradiance_{0.0f};
};

}  // namespace meniscus
