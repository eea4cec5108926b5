/// What a drop that hits something makes: its droplets with all their numbers drawn.
#pragma once

#include <vector>

#include "meniscus/sim.h"

namespace meniscus {

inline constexpr int kMostDroplets = 22;     ///< of a splash, by table 1; a crown-cone has one more
inline constexpr float kSinkTime = 0.04f;    ///< s in which a pile goes back once its droplet has left
inline constexpr float kLandFade = 0.03f;    ///< s in which a landed droplet sinks in
inline constexpr float kSpreadTime = 0.01f;  ///< s in which a disk spreads

inline constexpr float kConeWidth = 0.9f;  ///< half a diagonal of the cone's base, over the drop's diameter

/// Part of the drop's velocity along the surface that all its droplets take over.
inline constexpr float kCarried = 0.25f;
/// And that a crown does: deep water holds it.
inline constexpr float kCarriedByCrown = 0.08f;

/// Part of the drop's volume that flies away from the place; 0 where nothing does.
float flying_share(SplashKind kind, Wetness wetness);

/// m^3 of a droplet, from its radius as it is kept.
double volume_of(const Droplet& droplet);

/// Appends the droplets of an impact; all random numbers come from (options.seed, impact.id).
/// @param impact  valid, with a unit normal
/// @return        the splash, its `first` behind what was there; kind none: nothing has been appended
Splash make_splash(const Impact& impact, const SplashOptions& options, std::vector<Droplet>& droplets);

}  // namespace meniscus
