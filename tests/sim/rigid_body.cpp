#include "sim/rigid_body.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <numbers>

namespace meniscus {
namespace {

constexpr float kStep = 0.003f;
constexpr vec3 kGravity{0, -9.81f, 0};
const Bounds kTank{{0, 0, 0}, {1, 1, 1}};

std::unique_ptr<const Shape> shape_of(ObstacleShape::Kind kind, vec3 size) { return make_shape({kind, size, {}, {}}); }

void step(std::span<RigidBody> bodies, const Bounds& tank = kTank) {
  for (RigidBody& body : bodies)
    if (body.moved_by_forces()) body.motion.linear += kGravity * kStep;
  resolve_contacts(bodies, tank, Axis::y, kStep);
  for (RigidBody& body : bodies) drift(body, kStep);
}

RigidBody unmoved(const Shape& shape, vec3 position) {
  RigidBody body;
  body.shape = &shape;
  body.pose.position = position;
  return body;
}

/// The lowest of the body's touching points over the floor.
float lowest(const RigidBody& body) {
  float least = 1e9f;
  for (const vec3 touch : body.shape->touch_points())
    least = std::min(least, world_from_body(body.pose, touch).y - body.shape->touch_radius());
  return least;
}

TEST(RigidBody, HasTheMomentsOfManySmallMasses) {
  for (const auto kind : {ObstacleShape::Kind::box, ObstacleShape::Kind::sphere, ObstacleShape::Kind::cylinder}) {
    const auto shape = shape_of(kind, {0.6f, 1.0f, 0.4f});
    const Bounds bounds = shape->bounds();
    const vec3 extent = bounds.extent();
    constexpr int n = 60;
    double inside = 0;
    glm::dvec3 moments(0.0);
    for (int k = 0; k < n; ++k)
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
          const vec3 p = bounds.low + extent * (vec3(i, j, k) + 0.5f) / float(n);
          if (shape->nearest(p).distance > 0) continue;
          inside += 1;
          moments += glm::dvec3(p.y * p.y + p.z * p.z, p.z * p.z + p.x * p.x, p.x * p.x + p.y * p.y);
        }
    const double volume = inside / (n * n * n) * double(extent.x) * double(extent.y) * double(extent.z);
    EXPECT_NEAR(shape->volume() / volume, 1, 0.01);
    const RigidBody body = make_rigid_body(*shape, {}, 700);
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(1 / body.inverse_inertia[i] / (700 * volume * moments[i] / inside), 1, 0.01) << int(kind);
  }
}

TEST(RigidBody, KeepsItsMomentumAndAlmostItsEnergyWhenItTumbles) {
  const auto box = shape_of(ObstacleShape::Kind::box, {0.1f, 0.3f, 0.5f});
  RigidBody body = make_rigid_body(*box, {}, 500);
  body.motion.angular = {0.05f, 6, 0.05f};  // about the middle axis, which is not stable
  const vec3 before = angular_momentum(body);
  const double energy = kinetic_energy(body);
  vec3 least(1e9f), most(-1e9f);
  for (int i = 0; i < 2000; ++i) {
    drift(body, kStep);
    const vec3 own = glm::conjugate(body.pose.rotation) * body.motion.angular;
    least = glm::min(least, own);
    most = glm::max(most, own);
  }
  EXPECT_LT(glm::distance(angular_momentum(body), before), 1e-3f * glm::length(before));
  EXPECT_NEAR(kinetic_energy(body) / energy, 1, 0.005);
  EXPECT_LT(least.y, -4);  // it turns over
}

TEST(RigidBody, TakesAnImpulseAsItsMassAndMomentsSay) {
  const auto sphere = shape_of(ObstacleShape::Kind::sphere, vec3(0.2f));
  RigidBody body = make_rigid_body(*sphere, {}, 1000);
  const float mass = 1000 * sphere->volume();
  push(body, {{1, 0, 0}, {0, 0, 0.1f}});
  EXPECT_NEAR(body.motion.linear.x, 1 / mass, 1e-5);
  EXPECT_NEAR(body.motion.angular.z, 0.1f / (0.4f * mass * 0.01f), 1e-3);
}

TEST(RigidBody, FallsAsAStoneDoes) {
  const auto sphere = shape_of(ObstacleShape::Kind::sphere, vec3(0.2f));
  RigidBody body = make_rigid_body(*sphere, {{0.5f, 30, 0.5f}, {1, 0, 0, 0}}, 1000);
  for (int i = 0; i < 500; ++i) step({&body, 1});
  EXPECT_NEAR(30 - body.pose.position.y, 0.5 * 9.81 * 1.5 * 1.5, 0.03);
}

TEST(RigidBodyContact, LetsBodiesComeToRestOnTheFloorWithoutJitter) {
  for (const auto kind : {ObstacleShape::Kind::box, ObstacleShape::Kind::sphere, ObstacleShape::Kind::cylinder})
    for (const float turn : {0.0f, 0.4f}) {
      const auto shape = shape_of(kind, {0.2f, 0.25f, 0.3f});
      RigidBody body =
          make_rigid_body(*shape, {{0.5f, 0.5f, 0.5f}, glm::angleAxis(turn, glm::normalize(vec3(1, 0.2f, 0.5f)))}, 800);
      float deepest = 0;
      for (int i = 0; i < 1500; ++i) {
        step({&body, 1});
        body.motion.angular *= 0.998f;  // a cylinder on its side rolls
        deepest = std::min(deepest, lowest(body));
      }
      EXPECT_GT(deepest, -0.002f) << int(kind) << " " << turn;
      EXPECT_LT(lowest(body), 0.002f);
      const Pose then = body.pose;
      for (int i = 0; i < 100; ++i) step({&body, 1});
      EXPECT_LT(std::abs(body.pose.position.y - then.position.y), 1e-4f) << int(kind) << " " << turn;
      if (kind == ObstacleShape::Kind::box) {
        EXPECT_LT(glm::distance(body.pose.position, then.position), 1e-4f);
      }
    }
}

TEST(RigidBodyContact, StopsAFastBodyAtEachWall) {
  const auto box = shape_of(ObstacleShape::Kind::box, vec3(0.1f));
  for (const vec3 way : {vec3(1, 0, 0), vec3(-1, 0, 0), vec3(0, 0, 1), vec3(0, 0, -1), vec3(0, -1, 0)}) {
    RigidBody body = make_rigid_body(*box, {vec3(0.5f), {1, 0, 0, 0}}, 800);
    body.motion.linear = way * 100.0f;
    body.motion.angular = {3, 4, 5};
    for (int i = 0; i < 300; ++i) {
      step({&body, 1});
      for (const vec3 touch : box->touch_points()) {
        const vec3 p = world_from_body(body.pose, touch);
        ASSERT_TRUE(p.x > -0.01f && p.x < 1.01f && p.z > -0.01f && p.z < 1.01f && p.y > -0.01f);
      }
    }
  }
}

TEST(RigidBodyContact, LetsBodiesFallOnEachOtherAndNotThroughEachOther) {
  const auto box = shape_of(ObstacleShape::Kind::box, vec3(0.2f));
  const auto ball = shape_of(ObstacleShape::Kind::sphere, vec3(0.2f));
  const auto post = shape_of(ObstacleShape::Kind::cylinder, {0.3f, 0.3f, 0});
  std::vector<RigidBody> bodies{unmoved(*post, {0.5f, 0.15f, 0.5f}),
                                make_rigid_body(*box, {{0.5f, 0.5f, 0.5f}, {1, 0, 0, 0}}, 500),
                                make_rigid_body(*box, {{0.52f, 0.8f, 0.5f}, {1, 0, 0, 0}}, 800),
                                make_rigid_body(*ball, {{0.45f, 1.1f, 0.52f}, {1, 0, 0, 0}}, 2000)};
  for (int i = 0; i < 1500; ++i) {
    step(bodies);
    for (std::size_t a = 0; a < bodies.size(); ++a)
      for (std::size_t b = 0; b < bodies.size(); ++b) {
        if (a == b) continue;
        for (const vec3 touch : bodies[a].shape->touch_points()) {
          const vec3 p = body_from_world(bodies[b].pose, world_from_body(bodies[a].pose, touch));
          ASSERT_GT(bodies[b].shape->nearest(p).distance - bodies[a].shape->touch_radius(), -0.01f) << a << " in " << b;
        }
      }
  }
  EXPECT_NEAR(bodies[1].pose.position.y, 0.4f, 0.01f);  // on the post
  EXPECT_NEAR(bodies[2].pose.position.y, 0.6f, 0.01f);  // on the box
  EXPECT_EQ(bodies[0].pose.position, vec3(0.5f, 0.15f, 0.5f));
}

TEST(RigidBodyContact, GivesAnObstacleThatMovesThePushOfItsSpeed) {
  const auto box = shape_of(ObstacleShape::Kind::box, vec3(0.2f));
  std::vector<RigidBody> bodies{unmoved(*box, {0.2f, 0.1f, 0.5f}),
                                make_rigid_body(*box, {{0.41f, 0.101f, 0.5f}, {1, 0, 0, 0}}, 500)};
  bodies[0].motion.linear = {0.5f, 0, 0};
  for (int i = 0; i < 200; ++i) {
    step(bodies);
    ASSERT_GT(bodies[1].pose.position.x - bodies[0].pose.position.x, 0.199f);
  }
  EXPECT_NEAR(bodies[1].pose.position.x, 0.5 + 0.2, 0.01);
}

TEST(RigidBodyContact, HoldsBackSlidingByFriction) {
  const auto box = shape_of(ObstacleShape::Kind::box, vec3(0.1f));
  RigidBody body = make_rigid_body(*box, {{1, 0.05f, 0.5f}, {1, 0, 0, 0}}, 800);
  body.motion.linear = {1, 0, 0};
  for (int i = 0; i < 200; ++i) step({&body, 1}, {{0, 0, 0}, {10, 1, 1}});
  // Friction of 0.3 stops 1 m/s within v^2 / (2 mu g) = 0.17 m.
  EXPECT_NEAR(body.pose.position.x - 1, 1 / (2 * 0.3 * 9.81), 0.02);
  EXPECT_NEAR(glm::length(body.motion.linear), 0, 1e-3);
}

TEST(Pose, OnAPathIsThereAtEachKeyAndGoesSmoothly) {
  const glm::quat quarter = glm::angleAxis(std::numbers::pi_v<float> / 2, vec3(0, 1, 0));
  const std::vector<PoseKey> path{
      {1, {{0, 0, 0}, {1, 0, 0, 0}}}, {2, {{1, 0, 0}, quarter}}, {4, {{1, 2, 0}, quarter * quarter}}};
  for (const PoseKey& key : path) {
    EXPECT_LT(glm::distance(pose_on(path, key.time).position, key.pose.position), 1e-6f);
    EXPECT_GT(std::abs(glm::dot(pose_on(path, key.time).rotation, key.pose.rotation)), 0.9999f);
  }
  EXPECT_EQ(pose_on(path, -5).position, vec3(0.0f));
  EXPECT_EQ(pose_on(path, 9).position, vec3(1, 2, 0));
  // No jump in the velocity anywhere.
  vec3 last(0.0f);
  for (double t = 0.9; t < 4.1; t += 0.001) {
    const vec3 velocity = (pose_on(path, t + 0.001).position - pose_on(path, t).position) / 0.001f;
    ASSERT_LT(glm::distance(velocity, last), 0.03f) << t;
    last = velocity;
  }
}

TEST(Pose, IsReachedByTheMotionTowardsIt) {
  const Pose a{{1, 2, 3}, glm::angleAxis(0.3f, glm::normalize(vec3(1, 1, 0)))};
  const Pose b{{1.1f, 2, 2.9f}, glm::angleAxis(0.8f, glm::normalize(vec3(1, 0, 1)))};
  const Pose there = moved(a, motion_between(a, b, 0.01f), 0.01f);
  EXPECT_LT(glm::distance(there.position, b.position), 1e-6f);
  EXPECT_GT(std::abs(glm::dot(there.rotation, b.rotation)), 0.999999f);
  // A hair's turn is not lost.
  const Pose c{a.position, glm::normalize(glm::quat(1.0f, 1e-5f, 0.0f, 0.0f) * a.rotation)};
  EXPECT_NEAR(motion_between(a, c, 0.01f).angular.x, 2e-3f, 1e-4f);
}

}  // namespace
}  // namespace meniscus
