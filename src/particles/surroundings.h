/// What the neighbours of one particle say about the water that a particle stands for.
#pragma once

#include <span>

#include "particles/nearest.h"

namespace meniscus {

/// The water around one particle.
struct Surroundings {
  double spacing = 0;    ///< m: cube root of the volume of water per particle; 0: unknown
  double dimension = 0;  ///< 1 along a thread, 2 in a sheet of one layer, 3 in a body and at its surface
  double flatness = 0;   ///< smallest variance of the particles as a part of the largest: 0 flat, 1 as round as a ball
};

/// Sums over particles from which their second moments follow; in units that keep squares from overflowing.
struct Moments {
  double n = 0;
  glm::dvec3 sum{0.0};
  glm::dvec3 square{0.0};  ///< sums of xx, yy, zz
  glm::dvec3 mixed{0.0};   ///< sums of xy, xz, yz

  void add(glm::dvec3 p) {
    n += 1;
    sum += p;
    square += p * p;
    mixed += glm::dvec3(p.x * p.y, p.x * p.z, p.y * p.z);
  }
};

/// Volume per particle from the second moments of some particles that lie together.
///
/// Let every particle stand for a cube of edge s. The union of the n cubes has the covariance of the particles
/// plus s^2/12 along each axis, and a box of that covariance (eigenvalues l) has the edges sqrt(12 l + s^2).
/// Its volume is that of the n cubes:
///   n s^3 = c sqrt((12 l1 + s^2) (12 l2 + s^2) (12 l3 + s^2)),
/// with c near 1, as neighbourhoods are a little rounder than boxes. This one equation holds inside a body, at its
/// surface (where half of the ball is empty), in sheets of any number of layers and any slant, and along a
/// thread: it is exact for any number of particles in a row and for a box of them.
///
/// @return  unknown (0) for fewer than two particles and for particles in one point
Surroundings surroundings_of(const Moments& moments);

/// The same for the nearest particles of one.
/// @param nearest  as NearestIndex::nearest gives them; cut where a gap shows that the rest is other water, and
///                 to the first few where those lie in a flat or thin piece, so that its bends do not count
Surroundings surroundings_of(std::span<const Neighbour> nearest);

}  // namespace meniscus
