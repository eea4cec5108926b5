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
  dry,      ///< no water
  lost,     ///< the light enters and meets no solid, or none enters
  trapped,  ///< the light enters and does not come out of the water again: it is not followed further
  landed,   ///< `point` and what follows are valid
};

/// One point of the screen: its light's way through the water.
struct LightLanding {
  vec3 from{0.0f};       ///< s of the paper, on the water, m
  vec3 point{0.0f};      ///< c of the paper, on a solid, m
  vec3 normal{0.0f};     ///< unit, of the solid's flat face, against the light
  vec3 direction{0.0f};  ///< unit, of the light as it arrives
  /// Of the light that arrives at s the part that arrives at c: T exp(-sigma_t l_c), or 0 in shadow; of light that
  /// leaves the water, times `later`.
  vec3 passed{0.0f};
  vec3 exit{0.0f};          ///< where the light first leaves the water, m; `from` if it does not
  float cos_i = 0;          ///< of the light with the water's normal
  float transmittance = 0;  ///< T of the paper
  float later = 1;          ///< what interfaces after the first leave of the light
  float path = 0;           ///< l_c of the paper: in water, m
  float covered = 1;        ///< part of the point's square that has water
  LandingState state = LandingState::dry;
  /// 0: by one interface; else one number for one kind of way: out, mirrored and in again in this order.
  std::uint16_t way = 0;
};

/// The light's loss in the water, 1/m: what is scattered goes mostly forward.
vec3 caustics_extinction(const Material& material);

/// @param map  for the iteration; null: every ray meets the scene by itself
/// @return     of the screen's size
Image<LightLanding> land(const VirtualScreen& screen, const Surface& surface, const LightSource& light,
                         const Scene& scene, const Material& material, const SceneMap* map,
                         const CausticsOptions& options);

/// Follows light that leaves the water before it lands: out at the far side or mirrored there once, through the air
/// into the next water or onto a solid. What has met its last interface goes on straight; light that would be mirrored
/// twice is trapped. Ways in which the water ends within about a spacing of the solid stay as they are.
/// (caustics_follow.cpp)
/// @param surface  one that can be marched
void follow(const VirtualScreen& screen, const Surface& surface, const Scene& scene, const Material& material,
            Image<LightLanding>& landings);

/// Eq. 3 of the paper as it stands, with the flux ratio of one triangle.
/// @param flux_ratio   F_c = S / S_c, the triangle's area on the water by that on the solid
/// @param reflectance  f_r
/// @param ambient      L_a
vec3 caustic_intensity(vec3 light, const LightLanding& landing, vec3 extinction, float flux_ratio, vec3 reflectance,
                       vec3 ambient);

}  // namespace meniscus
