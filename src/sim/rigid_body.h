/// Rigid bodies that forces move, and their contacts with walls and with each other.
#pragma once

#include <glm/mat3x3.hpp>
#include <limits>
#include <span>

#include "sim/boundary.h"
#include "sim/pose.h"
#include "sim/shape.h"

namespace meniscus {

/// A body as its contacts meet it: forces move it where inverse_mass > 0, else it goes its own way.
struct RigidBody {
  const Shape* shape = nullptr;
  Pose pose;
  Motion motion;
  float inverse_mass = 0;      ///< 1/kg
  vec3 inverse_inertia{0.0f};  ///< 1/(kg m^2), of the principal axes, which are the body's own

  bool moved_by_forces() const { return inverse_mass > 0; }
};

/// A body of this shape and density, kg/m^3, at rest.
RigidBody make_rigid_body(const Shape& shape, const Pose& pose, float density);

/// World space.
glm::mat3 inverse_inertia(const RigidBody& body);
vec3 angular_momentum(const RigidBody& body);  ///< N m s, about its centre
double kinetic_energy(const RigidBody& body);  ///< J
vec3 velocity_at(const RigidBody& body, vec3 point);

/// Adds to the motion what an impulse does.
void push(RigidBody& body, const Impulse& impulse);
/// Moves on for dt s; the angular momentum is kept, whatever the axis.
void drift(RigidBody& body, float dt);

/// Changes the motions so that within dt s no body enters another or the tank's walls and floor: inelastic contacts
/// with friction, each point of a body's surface against the other's distances. What is already inside is drawn out a
/// little.                                                              [Catto2005]: sequential impulses
/// @param tank  m; without a ceiling
void resolve_contacts(std::span<RigidBody> bodies, const Bounds& tank, Axis up, float dt);

}  // namespace meniscus
