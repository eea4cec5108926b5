/// Position based fluids [Macklin2013].
#pragma once

#include "sim/neighbours.h"

namespace meniscus {

/// Puts defaults in the place of what is not set: step, viscosity, vorticity.
void fill_pbf_defaults(FluidOptions& options);
/// The longest step, s, of options without gaps.
float longest_pbf_step(const FluidOptions& options);

/// What the loops over pairs need, as they need it.
struct PbfConstants {
  float h;
  float volume;       ///< m^3, of a particle at rest
  float per_lattice;  ///< m^3; times a sum of kernels: the relative density, 1 in a cubic lattice
  float solid;        ///< relative density of a support full of solid
  float relaxation;   ///< epsilon, 1/m^2                                                     [Macklin2013] eq. 11
  float apart;        ///< k of the artificial pressure, m^2                                  [Macklin2013] eq. 13
  float blend;        ///< c of XSPH                                                          [Macklin2013] eq. 17
};
PbfConstants pbf_constants(const FluidOptions& options);

/// The particles in sorted order; positions are those of the iterations, not those of the neighbours' grid.
///
/// Records are four floats a particle, those of a neighbour read at once, and one particle more, far away. No loop
/// reads what it writes of others.
struct PbfState {
  std::vector<float> place;                   ///< records x, y, z (m), 0
  std::vector<float> pressed;                 ///< records x, y, z (m), lambda (m^2); then with the curl's size (1/s)
  std::vector<float> velocity;                ///< records vx, vy, vz (m/s), 0
  std::vector<float> solid;                   ///< of the relative density, what walls add
  std::vector<float> wall_x, wall_y, wall_z;  ///< gradient of `solid`, 1/m
  std::vector<float> dx, dy, dz;              ///< m or m/s: what a loop found to add
  std::vector<float> curl_x, curl_y, curl_z;  ///< 1/s
  void resize(std::size_t size, bool vorticity);
  vec3 place_of(std::size_t i) const { return {place[4 * i], place[4 * i + 1], place[4 * i + 2]}; }
  vec3 velocity_of(std::size_t i) const { return {velocity[4 * i], velocity[4 * i + 1], velocity[4 * i + 2]}; }
  float lambda(std::size_t i) const { return pressed[4 * i + 3]; }
};

/// lambda = -C / (sum |grad C|^2 + epsilon) of C = rho / rho_0 - 1, where water is pressed; from `place` to `pressed`.
///                                                                                       [Macklin2013] eq. 1, 11
void pbf_lambda(const PbfConstants& constants, const Neighbours& neighbours, PbfState& state, std::size_t begin,
                std::size_t end);
/// The neighbours' part of the change of position, with the artificial pressure.               [Macklin2013] eq. 14
void pbf_change(const PbfConstants& constants, const Neighbours& neighbours, PbfState& state, std::size_t begin,
                std::size_t end);
/// XSPH's change of speed, and the curl if there is room for it.                               [Macklin2013] eq. 15, 17
void pbf_blend(const PbfConstants& constants, const Neighbours& neighbours, PbfState& state, std::size_t begin,
               std::size_t end);
/// The gradient of the size of the curl.
void pbf_curl_slope(const PbfConstants& constants, const Neighbours& neighbours, PbfState& state, std::size_t begin,
                    std::size_t end);

}  // namespace meniscus
