/// Walls as half spaces of solid: which particles are near them, what they add to a particle's sums, and what is done
/// back to the bodies whose walls they are.
///
/// The solid counts as water of rest density that fills everything beyond a wall; the kernels' integrals over it are
/// known in closed form (formulas/fluids.h). So there is no layer of wall particles to be seen through the water.
#pragma once

#include <glm/vec3.hpp>

#include "sim/neighbours.h"

namespace meniscus {

/// Distance that no particle goes below, in spacings. Water at rest is held farther away by its pressure.
constexpr float kContact_rel = 0.25f;
/// Distance at which walls begin to push by themselves, in spacings.
constexpr float kBarrier_rel = 0.55f;

/// The walls around each particle that has any.
class NearWalls {
 public:
  /// @param h  walls farther than this are left out
  void find(const Boundary& boundary, const Neighbours& neighbours, float h);
  std::span<const Wall> of(std::size_t sorted) const {
    return {walls_[sorted / Neighbours::kPiece].data() + first_[sorted], count_[sorted]};
  }
  /// One number for each of these walls, which the solver keeps there.
  float* kept(std::size_t sorted) { return kept_[sorted / Neighbours::kPiece].data() + first_[sorted]; }
  const float* kept(std::size_t sorted) const { return kept_[sorted / Neighbours::kPiece].data() + first_[sorted]; }

 private:
  std::vector<std::vector<Wall>> walls_;
  std::vector<std::vector<float>> kept_;
  std::vector<std::uint32_t> first_;
  std::vector<std::uint8_t> count_;
};

/// How far several walls count where the solids behind them overlap.
struct WallShares {
  float solid = 0;                     ///< part of poly6 inside of any solid, 0 .. 1
  float weight[Boundary::kMostWalls];  ///< of each wall's gradients: the slope of `solid` by its own part
};
/// @param distance  of the particle now; walls.size() values, m
WallShares wall_shares(std::span<const Wall> walls, const float* distance, float h);

/// How hard a wall pushes by itself, 1/m, to be multiplied by the square of the speed of sound; zero beyond
/// kBarrier_rel spacings. It carries the half of the pressure that the water across the wall would have had, as it is
/// in none of the particles' energies: the wall's push stays the slope of a potential, and water comes to rest.
inline float wall_barrier(float distance, float spacing) {
  if (distance >= kBarrier_rel * spacing) return 0.0f;
  const float depth = 1.0f - distance / (kBarrier_rel * spacing);
  return depth * depth / spacing;
}

/// A unit vector that depends on the number alone: parts particles that are in one point.
vec3 some_direction(std::uint32_t number);

/// Impulses on bodies by pieces of particles, summed in their order.
class ImpulseSums {
 public:
  void clear(std::size_t pieces);
  /// @param impulse  on the body, N s, at `point`
  void add(std::size_t piece, const Boundary& boundary, int body, vec3 impulse, vec3 point);
  void add_to(std::span<Impulse> impulses) const;

 private:
  struct OfBody {
    int body;
    glm::dvec3 linear{0.0}, angular{0.0};
  };
  std::vector<std::vector<OfBody>> sums_;
};

}  // namespace meniscus
