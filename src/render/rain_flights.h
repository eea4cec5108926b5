/// Drops of rain in the air: where each will hit something, found when it comes in at the top.
#pragma once

#include <deque>
#include <functional>
#include <vector>

#include "meniscus/render.h"

namespace meniscus {

/// A drop on its way down.
struct Flight {
  enum class Target : std::uint8_t {
    nothing,  ///< it falls out of the region
    ground,   ///< cells
    plane,    ///< the scene's ground around them
    body,
    water,  ///< deep
  };
  RainDrop drop;
  double hit = 0;        ///< s
  vec3 point{0.0f};      ///< of the hit, m
  vec3 normal{0.0f};     ///< unit, of what is hit
  float fall = 0;        ///< m/s down
  std::size_t cell = 0;  ///< of the ground
  Target target = Target::nothing;
};

/// All drops in the air, by the tick of their hit.
class Flights {
 public:
  /// @param ground  cells that drops land on; may be null; must outlive this
  Flights(const Rain& rain, const WetGround* ground, double tick);

  /// What hits in tick `number`, the time after number * tick and not after (number + 1) * tick, in order of time.
  /// Drops come in, meet the scene where it has changed since, and the water.
  /// @param scene  without the mesh of the ground
  /// @param water  that can be marched; may be null
  std::vector<Flight> hits(std::int64_t number, const Scene& scene, const Surface* water);

  /// Calls with each drop that is still in the air.
  void each(FunctionRef<void(const Flight&)> call) const;
  std::size_t size() const;

 private:
  void come_in(double from, double until, const Scene& scene);
  void find_targets(std::span<Flight> flights, double from, const Scene& scene) const;
  void find_targets_of_piece(std::span<Flight> flights, double from, const Scene& scene) const;
  void fall_onto_ground(Flight& flight, double from) const;
  void meet_changed_scene(double now, const Scene& scene);
  void meet_water(double from, double until, const Surface& water, std::vector<Flight>& due);
  /// Of one list: where in it drops have met the water.
  /// @param height  m along up, above which no drop is looked at
  void meet_water(double from, double until, float height, const Bounds& box, const Surface& water,
                  std::vector<Flight>& list, std::vector<std::size_t>& met) const;
  void put(const Flight& flight);
  float height_of(vec3 point) const { return point[up_]; }

  const Rain& rain_;
  const WetGround* ground_;
  double tick_;
  int up_;
  double lead_ = 0;                                         ///< s that the slowest drop takes from the top down
  float highest_ = 0;                                       ///< m, of the ground's cells
  float slowest_ = std::numeric_limits<float>::infinity();  ///< m/s, of all flights so far
  std::int64_t next_ = 0;                                   ///< tick of the first list
  bool started_ = false;
  std::deque<std::vector<Flight>> lists_;  ///< one a tick
  std::vector<PlacedSolid> solids_;        ///< that targets were found with
};

}  // namespace meniscus
