/// The light on the ground around the water as a picture taken from the sun.
#pragma once

#include "meniscus/scene.h"
#include "meniscus/shading.h"

namespace meniscus {

/// Fractions of sun and sky light by position across the sun's rays; one outside.
class LightMap : public WaterLight {
 public:
  struct Fractions {
    vec3 sun;
    vec3 sky;
  };
  /// @param view   orthographic, along the sun's rays; of the texels' size
  /// @param up     unit
  /// @param level  of the texels' size: height of the water along `up`, m, linear between texels; points above it are
  ///               in full light. Empty: none are
  /// @param soft   m under the level over which the full light becomes the texels', > 0
  LightMap(const View& view, Image<Fractions> texels, vec3 up, Image<float> level, float soft);
  Light at(vec3 point, vec3 normal) const override;

 private:
  /// Position in texels: x = x_axis_ . point + origin_.x, likewise y.
  vec3 x_axis_, y_axis_;
  vec2 origin_;
  Image<Fractions> texels_;
  vec3 up_;
  Image<float> level_;
  float soft_;
};

/// Only what the water takes away of the sky's light, as soft_shadow() has it, in coarse texels; the sun's part is one.
std::shared_ptr<const WaterLight> sky_shadow(const Surface& surface, const Environment& environment,
                                             const Ground& ground, const Material& material, const Bounds& region,
                                             bool on_bodies);

/// Blurs by three box filters, which come close to a Gaussian; beyond the edge the edge's value goes on.
void blur(Image<vec3>& image, float sigma_px);
void blur(Image<float>& image, float sigma_px);
/// By a Gaussian whatever its width; beyond the edge there is nothing.
void blur_finely(Image<vec3>& image, float sigma_px);
void blur_finely(Image<float>& image, float sigma_px);

}  // namespace meniscus
