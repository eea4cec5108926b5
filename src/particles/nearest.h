/// The nearest particles of a few query particles, without knowing beforehand how far to look.
#pragma once

#include <cstdint>
#include <vector>

#include "meniscus/base.h"

namespace meniscus {

/// One neighbour: offset from the query particle and its squared length, in the index's unit of length.
struct Neighbour {
  glm::dvec3 offset;
  double distance2;
};

/// Particles in Morton order: every cube of the octree over them is one contiguous run, so that a search can
/// begin at whatever scale the particles around the query have, be it micrometres or kilometres.
///
/// Beyond `limit` particles only those of some cubes (blocks) are kept, chosen by a hash of where they are; a
/// query whose surroundings reach out of its block then has no answer. Memory while building: 8 bytes a particle and
/// 32 a kept one; afterwards 20 a kept one.
class NearestIndex {
 public:
  /// @param frame  cube corner and edge are taken from it; particles outside count as lying on its border,
  ///               which costs speed but no exactness. Not empty.
  NearestIndex(const Particles& particles, const Bounds& frame, std::size_t limit);

  /// m: neighbours are given in this unit, so that squares neither over- nor underflow.
  double unit() const { return 1 / units_per_metre_; }

  /// Kept particles.
  std::size_t size() const { return points_.size(); }

  /// m
  vec3 position(std::uint32_t particle) const { return points_[particle]; }

  /// About `count` particles to ask about: by a hash of their positions, so that their order does not matter.
  /// All of them where there are no more. Never empty unless the index is.
  std::vector<std::uint32_t> sample(std::size_t count) const;

  /// The `count` particles nearest to particle `query` of the index, itself included, nearest first; all where
  /// there are fewer. Empty if they cannot be told at a bounded cost: the particle lies alone beside a large
  /// body, or its surroundings reach out of its block.
  std::vector<Neighbour> nearest(std::uint32_t query, std::size_t count) const;

 private:
  struct Run {
    std::size_t begin, end;
  };
  Run run_of(std::uint64_t first_key, int level) const;
  /// Whether all particles within `radius` of `place` (both in units) are kept.
  bool complete_within(glm::dvec3 place, double radius) const;

  glm::dvec3 corner_{0.0};
  double units_per_metre_ = 1;
  int block_level_ = 0;         ///< 0: everything is kept
  std::vector<bool> complete_;  ///< for each block in Morton order: all of its particles are kept
  std::vector<std::uint64_t> keys_;
  std::vector<vec3> points_;
};

}  // namespace meniscus
