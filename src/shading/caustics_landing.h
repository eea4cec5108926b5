/// Where the light that enters the water lands.
#pragma once

#include "shading/caustics_screen.h"

namespace meniscus {

/// How the solids are seen along the light in the water.
struct SceneMap {
  View view;           ///< orthographic
  Image<float> depth;  ///< m along the view from its plane; +infinity: nothing
  Image<vec3> normal;  ///< unit, of the flat face, towards the view; zero: nothing

  /// Whether something stands before `point` (of a surface with this normal) there: for all of the four pixels around
  /// it, and for any of them.
  struct Hidden {
    bool surely, perhaps;
  };
  Hidden hides(vec3 point, vec3 normal) const;
  /// m along the view by which a surface with this normal may be farther than its pixel shows.
  float bias(vec3 normal) const;
};

/// Looks at the solids from where the water begins: what stands above it is not in the way.
/// @param from  m along the view from its plane, of the pixel (x, y)
SceneMap see_solids(const View& view, const Scene& scene, FunctionRef<float(const Ray&)> from);

enum class LandingState : std::uint8_t {
  dry,     ///< no water
  lost,    ///< the light enters and meets no solid, or none enters
  landed,  ///< `point` and what follows are valid
};

/// One point of the screen: its light's way through the water.
struct Landing {
  vec3 from{0.0f};    ///< s of the paper, on the water, m
  vec3 point{0.0f};   ///< c of the paper, on a solid, m
  vec3 normal{0.0f};  ///< unit, of the solid's flat face, against the light
  vec3 passed{
      0.0f};        ///< of the light that arrives at s the part that arrives at c: T exp(-sigma_t l_c), or 0 in shadow
  float cos_i = 0;  ///< of the light with the water's normal
  float transmittance = 0;  ///< T of the paper
  float path = 0;           ///< l_c of the paper: in water, m
  LandingState state = LandingState::dry;
  bool left = false;  ///< the light leaves the water again before it lands: drops and spray
};

/// The light's loss in the water, 1/m: what is scattered goes mostly forward.
vec3 caustics_extinction(const Material& material);

/// @param map  for the iteration; null: every ray meets the scene by itself
/// @return     of the screen's size
Image<Landing> land(const VirtualScreen& screen, const Surface& surface, const LightSource& light, const Scene& scene,
                    const Material& material, const SceneMap* map, const CausticsOptions& options);

/// Eq. 3 of the paper as it stands, with the flux ratio of one triangle.
/// @param flux_ratio   F_c = S / S_c, the triangle's area on the water by that on the solid
/// @param reflectance  f_r
/// @param ambient      L_a
vec3 caustic_intensity(vec3 light, const Landing& landing, vec3 extinction, float flux_ratio, vec3 reflectance,
                       vec3 ambient);

}  // namespace meniscus
