#include "sim/pose.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

namespace meniscus {

vec3 world_from_body(const Pose& pose, vec3 point) { return pose.rotation * point + pose.position; }

vec3 body_from_world(const Pose& pose, vec3 point) { return glm::conjugate(pose.rotation) * (point - pose.position); }

Pose between(const Pose& a, const Pose& b, float part) {
  return {a.position + (b.position - a.position) * part, glm::normalize(glm::slerp(a.rotation, b.rotation, part))};
}

Pose pose_on(std::span<const PoseKey> path, double time) {
  if (time <= path.front().time) return path.front().pose;
  if (time >= path.back().time) return path.back().pose;
  const auto after =
      std::upper_bound(path.begin(), path.end(), time, [](double t, const PoseKey& key) { return t < key.time; });
  const std::size_t i = static_cast<std::size_t>(after - path.begin()) - 1;
  const PoseKey &a = path[i], &b = path[i + 1];
  const double length = b.time - a.time;
  const auto t = static_cast<float>((time - a.time) / length);

  // Slopes at the two keys, per length of this piece; nothing at the ends of the path.
  const auto slope = [&](std::size_t key) {
    if (key == 0 || key + 1 == path.size()) return vec3(0.0f);
    const PoseKey &before = path[key - 1], &next = path[key + 1];
    return (next.pose.position - before.pose.position) * static_cast<float>(length / (next.time - before.time));
  };
  const float t2 = t * t, t3 = t2 * t;
  const vec3 position = (2 * t3 - 3 * t2 + 1) * a.pose.position + (t3 - 2 * t2 + t) * slope(i) +
                        (3 * t2 - 2 * t3) * b.pose.position + (t3 - t2) * slope(i + 1);
  // A path of two keys starts and ends at rest in its turning as well.
  const float turned = path.size() == 2 ? 3 * t2 - 2 * t3 : t;
  return {position, glm::normalize(glm::slerp(a.pose.rotation, b.pose.rotation, turned))};
}

Motion motion_between(const Pose& a, const Pose& b, float dt) {
  if (!(dt > 0)) return {};
  glm::quat turn = b.rotation * glm::conjugate(a.rotation);
  if (turn.w < 0) turn = -turn;
  const vec3 axis{turn.x, turn.y, turn.z};
  const float sine = glm::length(axis);
  const vec3 angle = sine > 1e-6f ? axis * (2 * std::atan2(sine, turn.w) / sine) : axis * 2.0f;
  return {(b.position - a.position) / dt, angle / dt};
}

Pose moved(const Pose& pose, const Motion& motion, float dt) {
  const vec3 angle = motion.angular * dt;
  const float size = glm::length(angle);
  const glm::quat turn =
      size > 1e-6f ? glm::angleAxis(size, angle / size) : glm::quat(1.0f, angle.x / 2, angle.y / 2, angle.z / 2);
  return {pose.position + motion.linear * dt, glm::normalize(turn * pose.rotation)};
}

double smooth_step(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * t * (10 + t * (6 * t - 15));
}

}  // namespace meniscus
