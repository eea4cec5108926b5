/// Everything solid in the tank: its walls and the obstacles, where they are and how they go on.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "sim/boundary.h"
#include "sim/obstacle_grid.h"
#include "sim/rigid_body.h"

namespace meniscus {

struct Obstacle {
  std::shared_ptr<const Shape> shape;
  std::vector<PoseKey> path;
  double appears = 0;
  bool dynamic = false;
  bool present = false;
  bool held = false;           ///< a dynamic one, in this step
  RigidBody body;              ///< where it is at the end of the step, how it moves within it, and its mass
  std::optional<Pose> target;  ///< where it is led to in the next step
  float inset = 0;             ///< m; the water meets a surface so far inside of the shape's own ...
  float growth = 0;            ///< m/s; ... while it grows to its size
  Impulse impulse;             ///< of the water, not yet given
};

class Obstacles final : public Boundary {
 public:
  /// @param tank   m; walls on four sides, without a ceiling
  /// @param reach  m, that walls_near() is called with, at most; farther costs more
  Obstacles(const Bounds& tank, Axis up, float reach);

  /// @throws Error invalid_argument
  std::size_t add(const ObstacleOptions& options, double time);
  const Obstacle& operator[](std::size_t i) const { return obstacles_[i]; }
  /// Those whose time has come are there from now on; which ones.
  std::vector<std::size_t> appear(double time);
  /// A surface that grows from `inset` m inside to its place at `growth` m/s.
  void grow(std::size_t i, float inset, float growth);
  /// In the next step it moves to this pose, and if it has a path, leaves it.
  void lead(std::size_t i, const Pose& pose);
  /// Puts it there at once, and at rest.
  void put(std::size_t i, const Pose& pose);
  /// Where scripts and led motions bring it by then.
  Pose pose_at(std::size_t i, double time) const;
  /// How far the fastest point of an obstacle gets from `time` on in dt s, m.
  float way_of(std::size_t i, double time, float dt) const;

  /// Moves all from `time` on by dt s: the scripted and led ones on their way, from where they are to where they shall
  /// be by `time` + span (span >= dt: a part of a step), the dynamic ones by the water's impulses, gravity and
  /// contacts.
  void advance(double time, float dt, float span, vec3 gravity);
  /// What the water has done to them, for the next step.
  void take(std::span<const Impulse> impulses);
  /// The water does not meet a wall faster than this, m/s.
  void limit_speed(float most) { most_speed_ = most; }

  /// The water meets the surfaces of obstacles so far inside of them, m.
  void set_skin(float skin) { skin_ = skin; }

  /// The nearest surface of one obstacle, world space, its inset and skin left out. @return false: farther than reach
  bool nearest(std::size_t i, vec3 point, float reach, NearestSurface& nearest) const;
  /// The least distance from an obstacle that is there, or from walls and floor; infinity: farther than reach.
  float clearance(vec3 point, float reach) const;
  Bounds bounds(std::size_t i) const;

  int walls_near(vec3 point, float reach, Wall (&walls)[kMostWalls]) const override;
  bool may_touch(const Bounds& box, float reach) const override;
  std::size_t bodies() const override { return obstacles_.size(); }
  vec3 centre(std::size_t body) const override { return obstacles_[body].body.pose.position; }

  const Bounds& tank() const { return tank_; }
  Axis up() const { return up_; }

 private:
  void add_wall(const Obstacle& obstacle, int index, vec3 point, float reach, Wall (&walls)[kMostWalls],
                int& count) const;
  void move_dynamic(float dt, vec3 gravity);
  void rebuild();

  Bounds tank_;
  Axis up_;
  float reach_;
  float skin_ = 0;
  float most_speed_ = std::numeric_limits<float>::infinity();
  std::vector<Obstacle> obstacles_;
  ObstacleGrid grid_;
  std::vector<Bounds> boxes_;  ///< of those that are there, with reach_; where there are many, the box around all
};

}  // namespace meniscus
