#include "sim/obstacles.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>

#include "sim/obstacle_check.h"

namespace meniscus {
namespace {

// What air and small eddies take from a floating body's motion, 1/s.
constexpr float kLinearDamping = 0.05f;
constexpr float kAngularDamping = 0.2f;

}  // namespace

Obstacles::Obstacles(const Bounds& tank, Axis up, float reach) : tank_(tank), up_(up), reach_(reach) {}

std::size_t Obstacles::add(const ObstacleOptions& options, double time) {
  check_obstacle(options);
  Obstacle obstacle;
  obstacle.shape = make_shape(options.shape);
  obstacle.path = options.path;
  obstacle.appears = options.appears;
  obstacle.dynamic = options.dynamic;
  const Pose start = options.path.empty() ? options.pose : pose_on(options.path, time);
  obstacle.body = {obstacle.shape.get(), {start.position, glm::normalize(start.rotation)}, {}, 0, vec3(0.0f)};
  if (options.dynamic) obstacle.body = make_rigid_body(*obstacle.shape, obstacle.body.pose, options.density);
  obstacles_.push_back(std::move(obstacle));
  return obstacles_.size() - 1;
}

std::vector<std::size_t> Obstacles::appear(double time) {
  std::vector<std::size_t> appeared;
  for (std::size_t i = 0; i < obstacles_.size(); ++i)
    if (!obstacles_[i].present && obstacles_[i].appears <= time) {
      obstacles_[i].present = true;
      obstacles_[i].body.pose = pose_at(i, time);
      appeared.push_back(i);
    }
  if (!appeared.empty()) rebuild();
  return appeared;
}

void Obstacles::grow(std::size_t i, float inset, float growth) {
  obstacles_[i].inset = std::max(inset, 0.0f);
  obstacles_[i].growth = growth;
}

void Obstacles::lead(std::size_t i, const Pose& pose) {
  obstacles_[i].path.clear();
  obstacles_[i].target = {pose.position, glm::normalize(pose.rotation)};
}

void Obstacles::put(std::size_t i, const Pose& pose) {
  obstacles_[i].path.clear();
  obstacles_[i].target.reset();
  obstacles_[i].body.pose = {pose.position, glm::normalize(pose.rotation)};
  obstacles_[i].body.motion = {};
  obstacles_[i].impulse = {};
  rebuild();
}

Pose Obstacles::pose_at(std::size_t i, double time) const {
  const Obstacle& obstacle = obstacles_[i];
  if (obstacle.target) return *obstacle.target;
  if (!obstacle.path.empty()) {
    const Pose pose = pose_on(obstacle.path, time);
    return {pose.position, glm::normalize(pose.rotation)};
  }
  return obstacle.body.pose;
}

float Obstacles::way_of(std::size_t i, double time, float dt) const {
  const Obstacle& obstacle = obstacles_[i];
  const Motion motion = obstacle.body.moved_by_forces() && !obstacle.target
                            ? obstacle.body.motion
                            : motion_between(obstacle.body.pose, pose_at(i, time + static_cast<double>(dt)), dt);
  return (glm::length(motion.linear) + glm::length(motion.angular) * obstacle.shape->radius()) * dt;
}

void Obstacles::advance(double time, float dt, float span, vec3 gravity) {
  std::vector<Pose> ends;
  for (std::size_t i = 0; i < obstacles_.size(); ++i) {
    Obstacle& obstacle = obstacles_[i];
    if (obstacle.held && !obstacle.target) obstacle.body.motion = {};  // let go
    obstacle.held = obstacle.dynamic && obstacle.target;
    Pose end = obstacle.body.pose;
    if (obstacle.target) {
      end = between(end, *obstacle.target, std::min(dt / span, 1.0f));
      if (dt >= span) end = *obstacle.target;
    } else if (!obstacle.path.empty()) {
      end = pose_at(i, time + static_cast<double>(dt));
    }
    if (!obstacle.dynamic || obstacle.held) obstacle.body.motion = motion_between(obstacle.body.pose, end, dt);
    ends.push_back(end);
  }
  move_dynamic(dt, gravity);
  for (std::size_t i = 0; i < obstacles_.size(); ++i) {
    Obstacle& obstacle = obstacles_[i];
    if (!obstacle.dynamic || obstacle.held) obstacle.body.pose = ends[i];
    if (dt >= span) {
      if (obstacle.held) obstacle.impulse = {};
      obstacle.target.reset();
    }
    obstacle.inset = std::max(obstacle.inset - obstacle.growth * dt, 0.0f);
    if (obstacle.inset == 0) obstacle.growth = 0;
  }
  rebuild();
}

void Obstacles::move_dynamic(float dt, vec3 gravity) {
  std::vector<std::size_t> who;
  std::vector<RigidBody> bodies;
  for (std::size_t i = 0; i < obstacles_.size(); ++i) {
    Obstacle& obstacle = obstacles_[i];
    if (!obstacle.present) continue;
    RigidBody body = obstacle.body;
    if (obstacle.held) {
      body.inverse_mass = 0;
      body.inverse_inertia = vec3(0.0f);
    } else if (obstacle.dynamic) {
      push(body, obstacle.impulse);
      obstacle.impulse = {};
      body.motion.linear = (body.motion.linear + gravity * dt) * std::exp(-kLinearDamping * dt);
      body.motion.angular *= std::exp(-kAngularDamping * dt);
    }
    who.push_back(i);
    bodies.push_back(body);
  }
  if (std::none_of(bodies.begin(), bodies.end(), [](const RigidBody& body) { return body.moved_by_forces(); })) return;
  resolve_contacts(bodies, tank_, up_, dt);
  for (std::size_t k = 0; k < who.size(); ++k)
    if (bodies[k].moved_by_forces()) {
      drift(bodies[k], dt);
      obstacles_[who[k]].body = bodies[k];
    }
}

void Obstacles::take(std::span<const Impulse> impulses) {
  for (std::size_t i = 0; i < obstacles_.size(); ++i)
    if (obstacles_[i].dynamic && obstacles_[i].present && !obstacles_[i].held) {
      obstacles_[i].impulse.linear += impulses[i].linear;
      obstacles_[i].impulse.angular += impulses[i].angular;
    }
}

Bounds Obstacles::bounds(std::size_t i) const {
  const Obstacle& obstacle = obstacles_[i];
  const Bounds own = obstacle.shape->bounds();
  const glm::mat3 turn = glm::mat3_cast(obstacle.body.pose.rotation);
  const vec3 half = own.extent() * 0.5f;
  const vec3 spread = glm::abs(turn[0]) * half.x + glm::abs(turn[1]) * half.y + glm::abs(turn[2]) * half.z;
  const vec3 centre = world_from_body(obstacle.body.pose, own.centre());
  return {centre - spread, centre + spread};
}

void Obstacles::rebuild() {
  std::vector<Bounds> boxes(obstacles_.size());
  for (std::size_t i = 0; i < obstacles_.size(); ++i)
    if (obstacles_[i].present) boxes[i] = bounds(i).grown(reach_ * 1.0001f);
  grid_.build(boxes);
  std::erase_if(boxes, [](const Bounds& box) { return box.empty(); });
  constexpr std::size_t kMostBoxes = 16;
  if (boxes.size() > kMostBoxes) {
    Bounds around;
    for (const Bounds& box : boxes) {
      around.add(box.low);
      around.add(box.high);
    }
    boxes = {around};
  }
  boxes_ = std::move(boxes);
}

}  // namespace meniscus
