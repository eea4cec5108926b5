/// Where rigid bodies are: poses, what lies between two of them, and how fast a body goes from one to the other.
#pragma once

#include <span>

#include "meniscus/sim.h"

namespace meniscus {

vec3 world_from_body(const Pose& pose, vec3 point);
vec3 body_from_world(const Pose& pose, vec3 point);

/// The straight way between two poses, turning by the shorter arc at an even rate; `part` in [0, 1].
Pose between(const Pose& a, const Pose& b, float part);

/// A pose on a scripted path: the position a cubic through the keys whose slopes are those of their neighbours, at rest
/// at both ends, the rotation by slerp; still before the first key and after the last.
/// @param path  not empty; rising times
Pose pose_on(std::span<const PoseKey> path, double time);

/// How a rigid body moves: the velocity of its point p is linear + cross(angular, p - position).
struct Motion {
  vec3 linear{0.0f};   ///< m/s, of its origin
  vec3 angular{0.0f};  ///< rad/s, world
};
/// The even motion that leads from one pose to the other in dt s.
Motion motion_between(const Pose& a, const Pose& b, float dt);
/// The pose after dt s of an even motion.
Pose moved(const Pose& pose, const Motion& motion, float dt);

/// 0 at 0, 1 at 1, at rest and without a jerk at both ends.
double smooth_step(double t);

}  // namespace meniscus
