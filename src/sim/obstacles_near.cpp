#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/vector_relational.hpp>

#include "sim/obstacles.h"

namespace meniscus {
namespace {

/// Keeps the nearest walls where there are more than fit.
void keep(const Wall& wall, Wall (&walls)[Boundary::kMostWalls], int& count) {
  if (count < Boundary::kMostWalls) {
    walls[count++] = wall;
    return;
  }
  Wall* farthest =
      std::max_element(walls, walls + count, [](const Wall& a, const Wall& b) { return a.distance < b.distance; });
  if (wall.distance < farthest->distance) *farthest = wall;
}

}  // namespace

int Obstacles::walls_near(vec3 point, float reach, Wall (&walls)[kMostWalls]) const {
  int count = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const float above = point[axis] - tank_.low[axis], below = tank_.high[axis] - point[axis];
    if (above <= reach) {
      walls[count] = {above, vec3(0.0f), vec3(0.0f), -1};
      walls[count++].normal[axis] = 1;
    }
    if (below <= reach && axis != static_cast<int>(up_)) {
      walls[count] = {below, vec3(0.0f), vec3(0.0f), -1};
      walls[count++].normal[axis] = -1;
    }
  }
  if (reach <= reach_) {
    for (const int i : grid_.at(point))
      add_wall(obstacles_[static_cast<std::size_t>(i)], i, point, reach, walls, count);
  } else {
    for (std::size_t i = 0; i < obstacles_.size(); ++i)
      if (obstacles_[i].present) add_wall(obstacles_[i], static_cast<int>(i), point, reach, walls, count);
  }
  if (count == kMostWalls)
    std::stable_sort(walls, walls + count, [](const Wall& a, const Wall& b) { return a.distance < b.distance; });
  return count;
}

bool Obstacles::may_touch(const Bounds& box, float reach) const {
  for (int axis = 0; axis < 3; ++axis) {
    if (box.low[axis] - tank_.low[axis] <= reach) return true;
    if (tank_.high[axis] - box.high[axis] <= reach && axis != static_cast<int>(up_)) return true;
  }
  if (reach > reach_) return true;
  const auto touches = [&](const Bounds& other) {
    return glm::all(glm::lessThanEqual(box.low, other.high)) && glm::all(glm::lessThanEqual(other.low, box.high));
  };
  return std::any_of(boxes_.begin(), boxes_.end(), touches);
}

void Obstacles::add_wall(const Obstacle& obstacle, int index, vec3 point, float reach, Wall (&walls)[kMostWalls],
                         int& count) const {
  const float radius = obstacle.shape->radius() + reach;
  const vec3 way = point - obstacle.body.pose.position;
  if (glm::dot(way, way) > radius * radius) return;
  NearestSurface found;
  const float inside = obstacle.inset + skin_;
  const vec3 own = glm::conjugate(obstacle.body.pose.rotation) * way;
  if (!obstacle.shape->nearest_within(own, reach - inside, found)) return;
  Wall wall;
  wall.distance = found.distance + inside;
  wall.normal = obstacle.body.pose.rotation * found.normal;
  wall.velocity = velocity_at(obstacle.body, point) + wall.normal * obstacle.growth;
  const float speed = glm::length(wall.velocity);
  if (speed > most_speed_) wall.velocity *= most_speed_ / speed;
  wall.body = index;
  keep(wall, walls, count);
}

bool Obstacles::nearest(std::size_t i, vec3 point, float reach, NearestSurface& nearest) const {
  const Pose& pose = obstacles_[i].body.pose;
  if (!obstacles_[i].shape->nearest_within(body_from_world(pose, point), reach, nearest)) return false;
  nearest.normal = pose.rotation * nearest.normal;
  return true;
}

float Obstacles::clearance(vec3 point, float reach) const {
  Wall walls[kMostWalls];
  const int count = walls_near(point, reach, walls);
  float least = std::numeric_limits<float>::infinity();
  for (int i = 0; i < count; ++i) least = std::min(least, walls[i].distance);
  return least;
}

}  // namespace meniscus
