/// What Rain works out once.
#pragma once

#include <algorithm>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "base/field_axes.h"
#include "meniscus/sim.h"
#include "sim/gust_table.h"
#include "sim/rain_spectrum.h"
#include "sim/rain_thinning.h"
#include "sim/rain_tiles.h"

namespace meniscus {

/// Drops come in slots of time, numbered from the start of the rain on; what a slot holds depends on the seed and its
/// number only.
struct Rain::Parts {
  RainSpectrum spectrum;
  FieldAxes axes;
  double slot = 0;                              ///< s
  std::vector<double> number_below = {};        ///< probability of at most i drops in a slot
  std::optional<Wind> calm = {};                ///< the wind without gusts
  std::unique_ptr<const GustTable> gusts = {};  ///< null: none
  double rise = 0;                              ///< m/s of uniform wind upwards
  double step_length = 0;                       ///< m, of a way through a field
  std::vector<RainDrop> single = {};            ///< beside the rain, in order of time
  // With an eye.
  std::optional<RainThinning> thinning = {};
  std::optional<RainLayer> wide = {};   ///< the drops that are made over the whole region
  std::optional<RainTiles> tiles = {};  ///< those that are made near the eye
  double kept = 1;                      ///< part of the share of the drops that is made, with the eye over the middle

  const Wind& steady(const Wind& wind) const { return calm ? *calm : wind; }
  /// How fast a drop comes down in uniform wind, m/s.
  double down(const RainDrop& drop) const {
    const double fall = fall_speed(drop.diameter);
    return std::max(fall - rise, 0.1 * fall);
  }
  /// Drops of the slots over the whole region after `low` and not after `high`, in order of time; with an eye their
  /// weights are u.
  std::vector<RainDrop> from_slots(const Rain& rain, double low, double high) const;
  /// Drops that are made around the eye, likewise.
  std::vector<RainDrop> around_eye(const Rain& rain, double low, double high) const;
  /// By the number of a slot of the tiles.
  RainEye eye(const Rain& rain, std::int64_t slot) const;
};

/// The order of the drops.
inline bool earlier(const RainDrop& a, const RainDrop& b) { return a.time != b.time ? a.time < b.time : a.id < b.id; }

/// The wind at a drop less its fall, m/s: as fast as it would go after a while, and not slower downwards than a tenth
/// of its fall, so that it does come down.
glm::dvec3 drop_velocity(vec3 wind, double fall, const FieldAxes& axes);

}  // namespace meniscus
