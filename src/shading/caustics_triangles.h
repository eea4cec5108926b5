/// From landings to what is drawn: caustics triangles, and shards where neighbours do not belong together.
#pragma once

#include "shading/caustics_landing.h"
#include "shading/caustics_raster.h"

namespace meniscus {

/// What became of the light of one screen; powers in W (of the sun: irradiance times area), summed over channels.
struct LightBalance {
  double entered = 0;  ///< met the water, after Fresnel reflection and solids before it
  double absorbed = 0;
  double mirrored = 0;  ///< by later interfaces, out of the way that is followed
  double trapped = 0;   ///< not followed further in the water
  double drawn = 0;     ///< in polygons of the map
  double hidden = 0;    ///< landed behind what the map's view sees first
  double grazing = 0;   ///< landed where the map's view looks along or from behind
  double lost = 0;      ///< met no solid
  std::size_t triangles = 0, shards = 0;

  void add(const LightBalance& other);
};

/// Polygons in lists of a fixed number of screen rows, so that they can be made and drawn by any number of threads.
using PolygonLists = std::vector<std::vector<LightPolygon>>;

/// Caustics triangles in pixels of an orthographic view, by what of the solids they land on.
struct TrianglesOfView {
  PolygonLists seen;    ///< the first that the view meets
  PolygonLists behind;  ///< others
  bool any_behind = false;
};

/// @param solids  what the view sees
TrianglesOfView caustics_triangles(const VirtualScreen& screen, const LightSource& light,
                                   const Image<LightLanding>& landings, const View& view, const SceneMap& solids,
                                   LightBalance* balance = nullptr);

/// Least cosine between a receiver's normal and the direction against the view at which light is drawn there.
constexpr float kGrazingCosine = 0.2f;

}  // namespace meniscus
