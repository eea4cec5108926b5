#include "sim/rigid_body.h"

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>

namespace meniscus {

RigidBody make_rigid_body(const Shape& shape, const Pose& pose, float density) {
  RigidBody body{&shape, pose, {}, 0, vec3(0.0f)};
  const float mass = density * shape.volume();
  body.inverse_mass = 1 / mass;
  body.inverse_inertia = 1.0f / (mass * shape.inertia_rel());
  return body;
}

glm::mat3 inverse_inertia(const RigidBody& body) {
  const glm::mat3 turn = glm::mat3_cast(body.pose.rotation);
  const vec3 d = body.inverse_inertia;
  return glm::mat3(turn[0] * d.x, turn[1] * d.y, turn[2] * d.z) * glm::transpose(turn);
}

vec3 angular_momentum(const RigidBody& body) {
  if (!body.moved_by_forces()) return vec3(0.0f);
  const vec3 own = glm::conjugate(body.pose.rotation) * body.motion.angular;
  return body.pose.rotation * (own / body.inverse_inertia);
}

double kinetic_energy(const RigidBody& body) {
  if (!body.moved_by_forces()) return 0;
  return 0.5 * (static_cast<double>(glm::dot(body.motion.linear, body.motion.linear)) / body.inverse_mass +
                static_cast<double>(glm::dot(body.motion.angular, angular_momentum(body))));
}

vec3 velocity_at(const RigidBody& body, vec3 point) {
  return body.motion.linear + glm::cross(body.motion.angular, point - body.pose.position);
}

void push(RigidBody& body, const Impulse& impulse) {
  if (!body.moved_by_forces()) return;
  body.motion.linear += impulse.linear * body.inverse_mass;
  body.motion.angular += inverse_inertia(body) * impulse.angular;
}

void drift(RigidBody& body, float dt) {
  if (!body.moved_by_forces()) {
    body.pose = moved(body.pose, body.motion, dt);
    return;
  }
  // It turns as it would half-way, which keeps the energy to second order.
  const vec3 momentum = angular_momentum(body);
  RigidBody half = body;
  half.pose = moved(body.pose, body.motion, dt / 2);
  body.motion.angular = inverse_inertia(half) * momentum;
  body.pose = moved(body.pose, body.motion, dt);
  body.motion.angular = inverse_inertia(body) * momentum;
}

}  // namespace meniscus
