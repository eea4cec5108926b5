#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "sim/rigid_body.h"

namespace meniscus {
namespace {

constexpr int kIterations = 16;
constexpr float kFriction = 0.3f;
constexpr float kDrawnOut = 0.2f;      ///< of a depth, in one step
constexpr float kAllowed_rel = 1e-3f;  ///< of a body's radius: a depth that is let be

/// A point of body a that may reach the surface of body b.
struct Contact {
  int a = 0, b = -1;              ///< b: -1 is the tank
  vec3 normal{0.0f};              ///< unit, out of b
  vec3 arm_a{0.0f}, arm_b{0.0f};  ///< from the centres
  float gap = 0;                  ///< m; negative: inside
  vec3 tangents[2] = {};
  float mass = 0, tangent_masses[2] = {};  ///< kg, that an impulse along the normal and the tangents meets
  float impulse = 0, tangent_impulses[2] = {};
};

class Contacts {
 public:
  Contacts(std::span<RigidBody> bodies, float dt) : bodies_(bodies), dt_(dt) {
    for (const RigidBody& body : bodies) inertias_.push_back(inverse_inertia(body));
  }

  void with_tank(const Bounds& tank, Axis up) {
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      const RigidBody& body = bodies_[i];
      if (!body.moved_by_forces()) continue;
      const float margin = reach(body) + 1e-3f * body.shape->radius();
      for (int axis = 0; axis < 3; ++axis)
        for (const bool top : {false, true}) {
          if (top && axis == static_cast<int>(up)) continue;
          const float side = top ? -1.0f : 1.0f, wall = top ? tank.high[axis] : tank.low[axis];
          if ((body.pose.position[axis] - wall) * side - body.shape->radius() > margin) continue;
          vec3 normal(0.0f);
          normal[axis] = side;
          for (const vec3 touch : body.shape->touch_points()) {
            const vec3 point = world_from_body(body.pose, touch) - normal * body.shape->touch_radius();
            const float gap = (point[axis] - wall) * side;
            if (gap <= margin) add(static_cast<int>(i), -1, point, normal, gap);
          }
        }
    }
  }

  void with_each_other() {
    for (std::size_t i = 0; i < bodies_.size(); ++i)
      for (std::size_t j = 0; j < bodies_.size(); ++j) {
        const RigidBody &a = bodies_[i], &b = bodies_[j];
        if (i == j || !(a.moved_by_forces() || b.moved_by_forces())) continue;
        const float margin = reach(a) + reach(b) + 1e-3f * std::min(a.shape->radius(), b.shape->radius());
        if (glm::distance(a.pose.position, b.pose.position) > a.shape->radius() + b.shape->radius() + margin) continue;
        for (const vec3 touch : a.shape->touch_points()) {
          const vec3 centre = world_from_body(a.pose, touch);
          NearestSurface found;
          if (!b.shape->nearest_within(body_from_world(b.pose, centre), a.shape->touch_radius() + margin, found))
            continue;
          const vec3 normal = b.pose.rotation * found.normal;
          add(static_cast<int>(i), static_cast<int>(j), centre - normal * a.shape->touch_radius(), normal,
              found.distance - a.shape->touch_radius());
        }
      }
  }

  void solve() {
    for (int iteration = 0; iteration < kIterations; ++iteration)
      for (Contact& contact : contacts_) {
        // Friction first, within what the last round has pressed the bodies together with.
        for (int t = 0; t < 2; ++t) {
          const float most = kFriction * contact.impulse;
          const float wanted = contact.tangent_impulses[t] -
                               glm::dot(approach(contact), contact.tangents[t]) * contact.tangent_masses[t];
          const float impulse = std::clamp(wanted, -most, most);
          apply(contact, contact.tangents[t] * (impulse - contact.tangent_impulses[t]));
          contact.tangent_impulses[t] = impulse;
        }
        // The gap may be used up in this step, and no more.
        const float too_fast = -glm::dot(approach(contact), contact.normal) - std::max(contact.gap, 0.0f) / dt_;
        const float impulse = std::max(contact.impulse + too_fast * contact.mass, 0.0f);
        apply(contact, contact.normal * (impulse - contact.impulse));
        contact.impulse = impulse;
      }
  }

  /// By the deepest contact of each pair, without giving a speed.
  void draw_out() {
    for (std::size_t i = 0; i < contacts_.size();) {
      std::size_t deepest = i, end = i;
      for (; end < contacts_.size() && contacts_[end].a == contacts_[i].a && contacts_[end].b == contacts_[i].b; ++end)
        if (contacts_[end].gap < contacts_[deepest].gap) deepest = end;
      const Contact& contact = contacts_[deepest];
      i = end;
      RigidBody& a = bodies_[static_cast<std::size_t>(contact.a)];
      RigidBody* b = contact.b < 0 ? nullptr : &bodies_[static_cast<std::size_t>(contact.b)];
      const float depth = -contact.gap - kAllowed_rel * a.shape->radius();
      const float mobility = a.inverse_mass + (b ? b->inverse_mass : 0);
      if (!(depth > 0) || !(mobility > 0)) continue;
      const vec3 way = contact.normal * (kDrawnOut * depth / mobility);
      a.pose.position += way * a.inverse_mass;
      if (b) b->pose.position -= way * b->inverse_mass;
    }
  }

 private:
  /// How far a point of the body gets in this step, at most.
  float reach(const RigidBody& body) const {
    return (glm::length(body.motion.linear) + glm::length(body.motion.angular) * body.shape->radius()) * dt_;
  }

  float mass_along(const Contact& contact, vec3 direction) const {
    const auto mobility = [&](int i, vec3 arm) {
      const auto k = static_cast<std::size_t>(i);
      return bodies_[k].inverse_mass + glm::dot(direction, glm::cross(inertias_[k] * glm::cross(arm, direction), arm));
    };
    const float sum = mobility(contact.a, contact.arm_a) + (contact.b < 0 ? 0 : mobility(contact.b, contact.arm_b));
    return sum > 0 ? 1 / sum : 0;
  }

  void add(int a, int b, vec3 point, vec3 normal, float gap) {
    Contact contact;
    contact.a = a;
    contact.b = b;
    contact.normal = normal;
    contact.arm_a = point - bodies_[static_cast<std::size_t>(a)].pose.position;
    if (b >= 0) contact.arm_b = point - bodies_[static_cast<std::size_t>(b)].pose.position;
    contact.gap = gap;
    const vec3 other = std::abs(normal.x) < 0.6f ? vec3(1, 0, 0) : vec3(0, 1, 0);
    contact.tangents[0] = glm::normalize(glm::cross(normal, other));
    contact.tangents[1] = glm::cross(normal, contact.tangents[0]);
    contact.mass = mass_along(contact, normal);
    for (int t = 0; t < 2; ++t) contact.tangent_masses[t] = mass_along(contact, contact.tangents[t]);
    contacts_.push_back(contact);
  }

  /// Velocity of a's point against b's.
  vec3 approach(const Contact& contact) const {
    const Motion& a = bodies_[static_cast<std::size_t>(contact.a)].motion;
    vec3 velocity = a.linear + glm::cross(a.angular, contact.arm_a);
    if (contact.b >= 0) {
      const Motion& b = bodies_[static_cast<std::size_t>(contact.b)].motion;
      velocity -= b.linear + glm::cross(b.angular, contact.arm_b);
    }
    return velocity;
  }

  void apply(const Contact& contact, vec3 impulse) {
    const auto give = [&](int i, vec3 arm, vec3 amount) {
      const auto k = static_cast<std::size_t>(i);
      bodies_[k].motion.linear += amount * bodies_[k].inverse_mass;
      bodies_[k].motion.angular += inertias_[k] * glm::cross(arm, amount);
    };
    give(contact.a, contact.arm_a, impulse);
    if (contact.b >= 0) give(contact.b, contact.arm_b, -impulse);
  }

  std::span<RigidBody> bodies_;
  float dt_;
  std::vector<glm::mat3> inertias_;  ///< inverse, world space
  std::vector<Contact> contacts_;
};

}  // namespace

void resolve_contacts(std::span<RigidBody> bodies, const Bounds& tank, Axis up, float dt) {
  Contacts contacts(bodies, dt);
  contacts.with_tank(tank, up);
  contacts.with_each_other();
  contacts.solve();
  contacts.draw_out();
}

}  // namespace meniscus
