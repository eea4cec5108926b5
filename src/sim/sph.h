/// Smoothed particles with a gas pressure [Muller2003].
///
/// Unlike there, the density is summed with the kernel whose gradient the pressure takes, the spiky one. With poly6 the
/// forces have no potential and water at rest boils: measured in a tank of 15 spacings 80 mm/s at a speed of sound of
/// 6.7 m/s, against less than 5 mm/s. And the pressure's gradient has both pressures whole [Monaghan1992] 3.3, as half
/// of their sum makes half of the force.
///
/// Densities are kept relative to the rest density, so the mass of a particle appears only in what bodies feel.
#pragma once

#include "sim/neighbours.h"

namespace meniscus {

/// Puts defaults in the place of what is not set: step, stiffness, viscosity, surface tension.
void fill_sph_defaults(FluidOptions& options);
/// The longest stable step, s, of options without gaps.
float longest_sph_step(const FluidOptions& options);

/// What the loops over pairs need, as they need it.
struct SphConstants {
  float h;
  float volume;       ///< m^3, of a particle at rest
  float per_lattice;  ///< m^3; times a sum of kernels: the relative density, 1 in a cubic lattice
  float solid;        ///< relative density of a support full of solid
  float stiffness;    ///< m^2/s^2
  float kinematic;    ///< viscosity over rest density, m^2/s
  float tension;      ///< surface tension over rest density, m^3/s^2
};
SphConstants sph_constants(const FluidOptions& options);

/// The particles in sorted order.
struct SphState {
  /// Eight floats a particle, those of a neighbour read at once: x, y, z (m), rest density over density, vx, vy, vz
  /// (m/s), 0; and one particle more, far away.
  std::vector<float> records;
  std::vector<float> solid;             ///< part of the support within walls
  std::vector<float> ax, ay, az;        ///< m/s^2, of the forces between particles
  std::vector<float> nx, ny, nz, bend;  ///< with surface tension: gradient (1/m) and laplacian (1/m^2) of the colour
  static constexpr int kStride = 8;
  void resize(std::size_t size, bool tension);
  vec3 position(std::size_t i) const { return {records[8 * i], records[8 * i + 1], records[8 * i + 2]}; }
  float inverse_density(std::size_t i) const { return records[8 * i + 3]; }
  vec3 velocity(std::size_t i) const { return {records[8 * i + 4], records[8 * i + 5], records[8 * i + 6]}; }
};

/// p / rho^2 in units of rest_density = 1, from the inverse relative density; never negative.
inline float pressure_over_density2(float stiffness, float inverse_density) {
  return stiffness * std::max(inverse_density - inverse_density * inverse_density, 0.0f);
}

/// rho / rho_0 = solid + sum of spiky over the neighbours and the particle itself [Muller2003] eq. 3, and its record
/// but for the velocity.
void sph_density(const SphConstants& constants, const Neighbours& neighbours, SphState& state, std::size_t begin,
                 std::size_t end);
/// Pressure and viscosity between particles, and the colour field's sums.
void sph_forces(const SphConstants& constants, const Neighbours& neighbours, SphState& state, std::size_t begin,
                std::size_t end);

}  // namespace meniscus
