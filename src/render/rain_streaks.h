/// Drops in the air as the streaks that an open shutter sees.
#pragma once

#include <vector>

#include "render/rain_flights.h"

namespace meniscus {

/// Adds the streaks of the drops near the view's eye; they fade out towards settings.streak_reach.
void add_streaks(const Rain& rain, const Flights& flights, const RainSettings& settings, double time, const View& view,
                 std::vector<WaterPiece>& pieces);

}  // namespace meniscus
