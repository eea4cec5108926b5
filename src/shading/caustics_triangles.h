/// From landings to what is drawn: caustics triangles, and shards where neighbours do not belong together.
#pragma once

#include "shading/caustics_landing.h"
#include "shading/caustics_raster.h"

namespace meniscus {

/// What became of the light of one screen; powers in W (of the sun: irradiance times area), summed over channels.
struct LightBalance {
  double entered = 0;  ///< met the water, after Fresnel reflection and solids before it
  double absorbed = 0;
  double drawn = 0;   ///< in polygons of the map
  double hidden = 0;  ///< landed where the map's view does not see, or that it sees at a grazing angle
  double lost = 0;    ///< met no solid
  std::size_t triangles = 0, shards = 0;

  void add(const LightBalance& other);
};

/// Caustics triangles as polygons of `view` (orthographic), in its pixels, in lists of a fixed number of screen rows.
/// @param solids  what the view sees; landings that it does not see are left out
std::vector<std::vector<LightPolygon>> caustics_triangles(const VirtualScreen& screen, const LightSource& light,
                                                          const Image<Landing>& landings, const View& view,
                                                          const SceneMap& solids, LightBalance* balance = nullptr);

/// Least cosine between a receiver's normal and the direction against the view at which light is drawn there.
constexpr float kGrazingCosine = 0.1f;

}  // namespace meniscus
