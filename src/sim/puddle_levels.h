/// How high water stands in and just around the puddles of wet ground.
#pragma once

#include <vector>

#include "base/field_axes.h"
#include "meniscus/sim.h"

namespace meniscus {

/// Water of this depth, m, is a puddle with a surface of its own; less is a film on the ground.
constexpr double kPuddle = 1e-3;

/// Levels between the middles of cells. A puddle's level goes on for a few cells around it, under the ground, so that
/// the shore is where level water meets the ground and not the edge of a cell. Owns what it needs: later changes of the
/// ground do not matter.
class PuddleLevels {
 public:
  explicit PuddleLevels(const WetGround& ground);
  /// m along up, bilinear over the cells that have a level; minus infinity where there is none. Held beyond the
  /// outermost middles.
  float level(vec2 place) const;
  /// m along up, of the ground, bilinear. Held alike.
  float bed(vec2 place) const;
  /// One a cell, minus infinity far from puddles.
  const std::vector<float>& cells() const { return levels_; }
  bool empty() const { return empty_; }

 private:
  struct Corners {
    std::size_t cell[4];
    float weight[4];
  };
  Corners around(vec2 place) const;

  vec2 first_{0.0f};  ///< middle of the first cell
  float cell_;
  int width_, height_;
  std::vector<float> levels_, beds_;
  bool empty_ = true;
};

}  // namespace meniscus
