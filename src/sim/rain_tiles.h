/// Drops of the layers that are made near the eye only, by tiles of the plane.
#pragma once

#include <cstdint>
#include <vector>

#include "base/field_axes.h"
#include "meniscus/sim.h"
#include "sim/rain_thinning.h"

namespace meniscus {

/// Probabilities of at most i of a Poisson distribution, up to about 1000; the last is 1.
std::vector<double> poisson_below(double mean);

/// Where all drops are made at a time. A drop of the fall v is as high as h at s = h / v before it arrives; until
/// then the wind W carries it on and the eye of velocity V moves. What counts is the least distance of its place at the
/// level from eye + (W - V) s for all heights up to somewhat over the eye, so that the air before the eye is as full as
/// the ground.
struct RainEye {
  glm::dvec2 place{0.0};  ///< m
  glm::dvec2 sweep{0.0};  ///< m/s, W - V
  double height = 0;      ///< m above the level up to which drops are seen
  bool there = false;     ///< false: the eye is nowhere

  /// m from the drop that arrives at `at` to the eye, at the nearest that it gets.
  double distance(glm::dvec2 at, double fall) const;
  /// m, no less than the way that the eye's image sweeps over for a drop of the slowest fall.
  glm::dvec2 swept(double slowest) const;
};

/// The layers of drops that are made only near the eye. What a tile holds in a slot of time depends on the seed and on
/// their numbers only; whether it is looked into, on the eye.
class RainTiles {
 public:
  /// Slots are no longer than this, s: the eye hardly moves.
  static constexpr double kSlot = 1.0 / 256;

  /// @param per_area  drops that come down, 1/(m^2 s), of all layers
  /// @param sides     of the region, m
  /// @param whole     m from the eye within which all are made
  RainTiles(const RainSpectrum& spectrum, const RainThinning& thinning, int layers, double per_area, glm::dvec2 sides,
            double whole);

  bool empty() const { return layers_.empty(); }
  /// Drops that come down in the region around the eye, in no order; their weights are u.
  /// @param low, high  s from the start on
  /// @param eye        by the number of a slot of kSlot
  /// @throws Error     limit_exceeded
  void add(const RainOptions& options, const RainThinning& thinning, double low, double high,
           FunctionRef<RainEye(std::int64_t)> eye, std::vector<RainDrop>& drops) const;

 private:
  struct Layer {
    RainLayer drops;
    double tile;                ///< m
    int halvings;               ///< of kSlot
    double radius;              ///< m from the eye up to which some of its drops are made
    std::vector<double> below;  ///< probability of at most i drops in a tile and slot
  };
  struct Tile {
    std::size_t layer;
    std::int64_t a, b;
    std::uint64_t slot;
  };
  std::vector<Layer> layers_;
  double slowest_;  ///< m/s
};

}  // namespace meniscus
