/// The reference of the caustics: photons, one by one, without any neighbours.
#pragma once

#include "shading/caustics_map.h"

namespace meniscus {

/// What the texels of the first map of `cast` show when light is carried by photons that start in a regular grid
/// `finer` times as fine as its screen, meet the solids by exact rays, and are counted where they land. Smoothed as the
/// map is.
/// @param cast  with its screen
/// @param single_interface  as in CausticsOptions
/// @return      W/m^2 across the map's direction, of the map's size
Image<vec3> photon_map(const Surface& surface, const LightCast& cast, const Scene& scene, const Material& material,
                       int finer, bool single_interface = false);

}  // namespace meniscus
