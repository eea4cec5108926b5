/// What the gusts do, by time: gusts are the same everywhere, so that one table serves all drops.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <vector>

#include "meniscus/sim.h"

namespace meniscus {

/// The displacement by the mean wind and its gusts, and the velocity of the gusts, at equal steps of time; in between
/// by cubics with both, which are off by a few micrometres at most. Parts of the table are made when they are first
/// asked for, by any thread; what they hold depends on the wind and the time only.
class GustTable {
 public:
  /// @param wind     with gusts
  /// @param calm     the same without them
  /// @param options  of the wind
  /// @param start    s; from somewhat before it on, for thousands of s, times are in the table. Others take longer.
  GustTable(const Wind& wind, const Wind& calm, const WindOptions& options, double start);
  ~GustTable();
  GustTable(const GustTable&) = delete;
  GustTable& operator=(const GustTable&) = delete;

  glm::dvec3 displacement(double time) const;  ///< m, from the start on; of mean wind too
  glm::dvec3 gust(double time) const;          ///< m/s, without the mean wind
  double chord() const { return apart_; }      ///< s, of the shortest chords
  struct Corner {
    double time;
    glm::dvec3 displacement;
  };
  /// Adds the corners between two times of a chain that stands off the displacement by 4 cm at most.
  void add_corners(double from, double until, std::vector<Corner>& corners) const;

 private:
  static constexpr int kSteps = 128;    ///< of a chunk
  static constexpr int kChunks = 8192;  ///< that there may be
  static constexpr int kBefore = 512;   ///< of them before the start
  struct Knot {
    glm::dvec3 displacement, velocity;
  };
  struct Chunk {
    std::array<Knot, kSteps + 1> knots;
    std::vector<Corner> corners;  ///< the first at its beginning
  };
  struct Span {
    const Knot* knot;  ///< that it begins with; null: not in the table
    double part;       ///< of the step that has gone by
  };
  Span span(double time) const;
  Knot knot(double time) const;
  double steps_at(double time) const;
  const Chunk& chunk(std::size_t number) const;
  std::vector<Corner> corners(std::span<const Knot> knots, double first) const;

  Wind wind_;
  glm::dvec3 mean_, calm_;  ///< m/s, of calm wind: everywhere, and at 0
  double start_, step_;     ///< s
  double apart_;            ///< s between corners out of the table
  std::unique_ptr<std::atomic<const Chunk*>[]> chunks_;
};

}  // namespace meniscus
