/// The light that one source casts through the water, as maps.
#pragma once

#include "shading/caustics_triangles.h"

namespace meniscus {

/// Irradiance across the direction of an orthographic view, on what that view sees and on what lies behind it.
class CausticsMap {
 public:
  /// @param seen    power on the first solid of each texel of `view`, W
  /// @param behind  on others; may be empty
  /// @param solids  along the same direction
  CausticsMap(const View& view, Image<vec3> seen, Image<vec3> behind, SceneMap solids);

  /// Irradiance on a surface.
  vec3 irradiance(vec3 point, vec3 normal) const;
  /// Cosine at which the view sees a surface.
  float facing(vec3 normal) const { return -glm::dot(normal, view_.forward); }

  const View& view() const { return view_; }
  const SceneMap& solids() const { return solids_; }
  /// W/m^2 across the view's direction.
  const Image<vec3>& texels() const { return seen_; }
  /// Power on all texels, W.
  vec3 power() const;

 private:
  View view_;
  Image<vec3> seen_, behind_;
  SceneMap solids_;
  vec2 first_{0.0f};  ///< of the texels' corner in the picture of the solids, px
  float scale_ = 1;   ///< pixels of that picture to a texel
};

/// Where the light of one source arrives unbent: not behind points of the water that its caustics are drawn from.
class UnbentLight {
 public:
  /// @param view      from the light
  /// @param depth     of the water along the view, m; +infinity: none
  /// @param coverage  part of each pixel that has water
  UnbentLight(const View& view, Image<float> depth, Image<float> coverage);
  /// The fraction that arrives, [0, 1]: what the water leaves free of the pixels around, by a cubic B-spline, so that
  /// its border is as soft as that of the caustics.
  float fraction(vec3 point) const;

 private:
  /// Of the 4 x 4 pixels around the square between pixel centres (x, y) and (x + 1, y + 1).
  struct Around {
    float nearest = std::numeric_limits<float>::infinity();      ///< water, m
    float closed_from = std::numeric_limits<float>::infinity();  ///< all light is gone from here on, m
  };
  View view_;
  Image<float> depth_, coverage_;
  Image<Around> around_;
};

/// All that one light casts, with what it was made from.
struct LightCast {
  LightSource light;
  VirtualScreen screen;
  Image<LightLanding> landings;     ///< empty unless they were asked for
  std::vector<CausticsMap> maps;    ///< the first along the light in flat water, others along the horizon
  std::vector<UnbentLight> unbent;  ///< one
  float spacing = 0;                ///< m between neighbouring points of the screen, about
  float smooth_px = 0;              ///< standard deviation of the smoothing of the first map, texels
  LightBalance balance;             ///< of the first map

  /// Irradiance of bent light.
  vec3 refracted(vec3 point, vec3 normal) const;
};

/// @param keep  keep screen and landings
LightCast cast_light(const Surface& surface, const LightSource& light, const Bounds& box, const Scene& scene,
                     const Material& material, const CausticsOptions& options, StageTimes* times = nullptr,
                     bool keep = false);

/// The water that casts: what of it is in the region, or all of it.
Bounds casting_box(const Surface& surface, const Bounds& region);

}  // namespace meniscus
