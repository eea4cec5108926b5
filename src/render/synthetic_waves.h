/// The standing waves of a made-up tank.
#pragma once

#include "meniscus/render.h"

namespace meniscus {

constexpr double kGravity = 9.81;  ///< m/s^2

/// One standing wave between walls: height over the still level a cos(kx x) cos(kz z) cos(omega t + phase).
struct StandingWave {
  double amplitude = 0;   ///< m
  double kx = 0, kz = 0;  ///< 1/m; whole multiples of pi / side
  double k = 0;           ///< length of (kx, kz)
  double omega = 0;       ///< 1/s
  double phase = 0;
};

/// @throws Error  invalid_argument, as synthetic_waves()
void check_waves(const WavesOptions& options);
/// The waves that are superposed, longest first; amplitudes sum up to options.height.
std::vector<StandingWave> standing_waves(const WavesOptions& options);
/// Height of the surface over the still level, m.
double waves_height(const std::vector<StandingWave>& waves, double x, double z, double time);

}  // namespace meniscus
