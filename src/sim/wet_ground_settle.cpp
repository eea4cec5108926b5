/// The ground's water at rest.
#include <algorithm>

#include "meniscus/sim.h"
#include "sim/ground_constants.h"
#include "sim/hollows.h"

namespace meniscus {

void WetGround::settle() {
  // Water stands on the film that its cell holds. What a cell still soaks up or holds, passing water leaves there.
  std::vector<double> ground(size()), room(size()), water(size());
  for (std::size_t c = 0; c < size(); ++c) {
    const double held = std::min(depth_[c], kHeldFilm);
    ground[c] = static_cast<double>(bed_[c]) - static_cast<double>(options_.level) + kHeldFilm;
    room[c] = (kHeldFilm - held) + (capacity(c) - soaked_[c]);
    water[c] = depth_[c] - held;
    depth_[c] = held;
  }
  const double drained = settle_in_hollows(width_, height_, ground, room, water);
  for (std::size_t c = 0; c < size(); ++c) depth_[c] += soak(c, water[c]);
  const double cell = options_.cell;
  drained_ += drained * cell * cell;
  std::fill(along_a_.begin(), along_a_.end(), 0.0);
  std::fill(along_b_.begin(), along_b_.end(), 0.0);
  stir_all();
}

}  // namespace meniscus
