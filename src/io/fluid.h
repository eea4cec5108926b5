/// Fluid against boundaries, where the attributes that a known program writes tell them apart.
#pragma once

#include <string>

#include "meniscus/base.h"

namespace meniscus::io {

/// Which particles are the fluid, and by what.
struct FluidChoice {
  std::vector<std::uint8_t> is_fluid;  ///< one a particle, 0 or 1; at least one is 1
  std::string reason;                  ///< "their Type (DualSPHysics) is not 3 (fluid)", of those that are left out
};

/// None: nothing tells, or all particles are alike. Known are
///   DualSPHysics  Type: 0 fixed, 1 moving, 2 floating, 3 fluid
///   DualSPHysics  Mk, where there is no Type: below 10 fluids, from 10 boundaries
///   GPUSPH        Part type, beside Part id or Part flags: 0 fluid, 1 boundary, 2 vertex, 3 test point
///   PySPH         tag, beside gid and pid: 0 real, 1 of another process, 2 ghost
/// @param boundaries_only  set where everything is a boundary
std::optional<FluidChoice> choose_fluid(const Particles& particles, bool& boundaries_only);

}  // namespace meniscus::io
