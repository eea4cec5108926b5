/// What the ground's materials do to water on them. Where the numbers are from: docs/rain.md.
#pragma once

#include <array>

#include "meniscus/sim.h"

namespace meniscus {

struct GroundTraits {
  double capacity;    ///< m of water that it soaks up                                            [Kidd1978]
  double roughness;   ///< m, standard deviation of its heights
  double resistance;  ///< K of laminar sheet flow: friction factor K / Re                         [Woolhiser1975]
  double friction;    ///< Darcy-Weisbach's friction factor of turbulent sheet flow
};

/// By GroundMaterial.
inline constexpr std::array<GroundTraits, 3> kGroundTraits{GroundTraits{0.0005, 0.0003, 50, 0.06},
                                                           GroundTraits{0.0008, 0.001, 100, 0.08},
                                                           GroundTraits{0.0, 0.00002, 24, 0.04}};

constexpr const GroundTraits& traits_of(GroundMaterial material) {
  return kGroundTraits[static_cast<std::size_t>(material)];
}

/// Water that surface tension and roughness hold on a cell: it does not flow, m.
inline constexpr double kHeldFilm = 0.0002;

/// Below this depth, drops stand apart on steel, m.
inline constexpr double kLeastFilm = 0.00002;

inline constexpr double kGroundGravity = 9.81;  ///< m/s^2
inline constexpr double kStillDepth = 1e-8;     ///< m: less over the film does not flow
inline constexpr double kStillLevel = 1e-9;     ///< m: levels that differ by less are equal, ...
inline constexpr double kStillFlow = 1e-10;     ///< m^2/s: ... where no more than this flows

/// No more water than this is taken at once, m.
inline constexpr double kMostWater = 1000;

}  // namespace meniscus
