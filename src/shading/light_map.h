/// The light on the ground around the water as a picture taken from the sun.
#pragma once

#include "meniscus/scene.h"

namespace meniscus {

/// Fractions of sun and sky light by position across the sun's rays; one outside.
class LightMap : public GroundLight {
 public:
  struct Texel {
    vec3 sun{1.0f};
    vec3 sky{1.0f};
  };
  /// @param view  orthographic, along the sun's rays; of the texels' size
  LightMap(const View& view, Image<Texel> texels);
  vec3 sun(vec3 point) const override;
  vec3 sky(vec3 point) const override;

 private:
  vec3 at(vec3 point, vec3 Texel::*part) const;

  View view_;
  Image<Texel> texels_;
};

/// Blurs by three box filters, which come close to a Gaussian; beyond the edge the edge's value goes on.
void blur(Image<vec3>& image, float sigma_px);
void blur(Image<float>& image, float sigma_px);

}  // namespace meniscus
