#include "sim/obstacles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <random>

#include "obstacle_meshes.h"

namespace meniscus {
namespace {

const Bounds kTank{{0, 0, 0}, {2, 1, 1}};
constexpr float kReach = 0.05f;

ObstacleOptions ball(vec3 position, float diameter = 0.2f) {
  ObstacleOptions options;
  options.shape.kind = ObstacleShape::Kind::sphere;
  options.shape.size = vec3(diameter);
  options.pose.position = position;
  return options;
}

TEST(Boundary, IsFloorAndFourWallsWithoutACeiling) {
  const Obstacles obstacles(kTank, Axis::y, kReach);
  Wall walls[Boundary::kMostWalls];
  EXPECT_EQ(obstacles.walls_near({1, 0.5f, 0.5f}, kReach, walls), 0);
  EXPECT_EQ(obstacles.walls_near({1, 0.99f, 0.5f}, kReach, walls), 0);
  EXPECT_EQ(obstacles.walls_near({1, 77, 0.5f}, kReach, walls), 0);
  ASSERT_EQ(obstacles.walls_near({1.98f, 77, -0.01f}, kReach, walls), 2);
  EXPECT_NEAR(walls[0].distance, 0.02f, 1e-6);
  EXPECT_EQ(walls[0].normal, vec3(-1, 0, 0));
  EXPECT_NEAR(walls[1].distance, -0.01f, 1e-6);
  EXPECT_EQ(walls[1].normal, vec3(0, 0, 1));
  EXPECT_EQ(walls[0].body, -1);
  ASSERT_EQ(obstacles.walls_near({0.01f, 0.02f, 0.5f}, kReach, walls), 2);
}

TEST(Boundary, StandsUpAlongAnyAxis) {
  const Obstacles obstacles(kTank, Axis::z, kReach);
  Wall walls[Boundary::kMostWalls];
  EXPECT_EQ(obstacles.walls_near({1, 0.5f, 0.99f}, kReach, walls), 0);
  EXPECT_EQ(obstacles.walls_near({1, 0.99f, 0.5f}, kReach, walls), 1);
  ASSERT_EQ(obstacles.walls_near({1, 0.5f, 0.01f}, kReach, walls), 1);
  EXPECT_EQ(walls[0].normal, vec3(0, 0, 1));
}

TEST(Boundary, MeetsEachObstacleThatIsNearAndNoOther) {
  Obstacles obstacles(kTank, Axis::y, kReach);
  std::mt19937 random(7);
  std::uniform_real_distribution<float> part(0, 1);
  const auto anywhere = [&] {
    const float x = 2 * part(random), y = part(random), z = part(random);
    return vec3(x, y, z);
  };
  for (int i = 0; i < 40; ++i) {
    ObstacleOptions options = ball(anywhere(), 0.05f + 0.1f * part(random));
    if (i % 3 == 1) {
      options.shape.kind = ObstacleShape::Kind::box;
      options.shape.size = {0.1f, 0.2f, 0.05f};
      options.pose.rotation = glm::angleAxis(float(i), glm::normalize(vec3(1, 2, 3)));
    }
    if (i % 3 == 2) {
      options.shape.kind = ObstacleShape::Kind::cylinder;
      options.shape.size = {0.1f, 0.15f, 0};
      options.pose.rotation = glm::angleAxis(float(i), glm::normalize(vec3(3, 1, 2)));
    }
    options.appears = i % 10 == 9 ? 5 : 0;  // not there yet
    obstacles.add(options, 0);
  }
  obstacles.appear(0);
  int met = 0;
  for (int k = 0; k < 4000; ++k) {
    const vec3 point = anywhere();
    for (const float reach : {0.02f, kReach, 3 * kReach}) {
      std::vector<Wall> expected;
      for (int axis = 0; axis < 3; ++axis) {
        if (point[axis] <= reach) expected.push_back({point[axis], vec3(0.0f), vec3(0.0f), -1});
        if (axis != 1 && kTank.high[axis] - point[axis] <= reach)
          expected.push_back({kTank.high[axis] - point[axis], vec3(0.0f), vec3(0.0f), -1});
      }
      for (std::size_t i = 0; i < obstacles.bodies(); ++i) {
        if (!obstacles[i].present) continue;
        const Pose& pose = obstacles[i].body.pose;
        const NearestSurface own = obstacles[i].shape->nearest(body_from_world(pose, point));
        if (own.distance <= reach)
          expected.push_back({own.distance, pose.rotation * own.normal, vec3(0.0f), static_cast<int>(i)});
      }
      std::sort(expected.begin(), expected.end(), [](const Wall& a, const Wall& b) { return a.distance < b.distance; });
      if (expected.size() > Boundary::kMostWalls) expected.resize(Boundary::kMostWalls);
      Wall walls[Boundary::kMostWalls];
      const int count = obstacles.walls_near(point, reach, walls);
      ASSERT_EQ(static_cast<std::size_t>(count), expected.size());
      std::vector<Wall> found(walls, walls + count);
      std::sort(found.begin(), found.end(), [](const Wall& a, const Wall& b) { return a.distance < b.distance; });
      for (std::size_t i = 0; i < found.size(); ++i) {
        const Wall& wall = expected[i];
        ASSERT_NEAR(found[i].distance, wall.distance, 1e-6);
        ASSERT_EQ(found[i].body, wall.body);
        if (wall.body >= 0) {
          ASSERT_LT(glm::distance(found[i].normal, wall.normal), 1e-3f);
          ++met;
        }
      }
    }
  }
  EXPECT_GT(met, 1000);
}

TEST(Boundary, MovesAsTheObstacleDoesWithinTheStep) {
  Obstacles obstacles(kTank, Axis::y, kReach);
  ObstacleOptions paddle;
  paddle.shape.size = {0.4f, 0.4f, 0.02f};
  paddle.pose.position = {1, 0.5f, 0.5f};
  obstacles.add(paddle, 0);
  obstacles.appear(0);
  constexpr float dt = 0.004f;
  const Pose end{{1.002f, 0.5f, 0.5f}, glm::angleAxis(0.01f, vec3(0, 1, 0))};
  obstacles.lead(0, end);
  obstacles.advance(0, dt, dt, vec3(0.0f));
  const vec3 point{1.1f, 0.5f, 0.5f};
  Wall walls[Boundary::kMostWalls];
  ASSERT_EQ(obstacles.walls_near(point, kReach, walls), 1);
  EXPECT_LT(glm::distance(walls[0].velocity, vec3(0.5f, 0, -0.098f * 2.5f)), 1e-3f);
  obstacles.advance(dt, dt, dt, vec3(0.0f));  // there, and still
  ASSERT_EQ(obstacles.walls_near(point, kReach, walls), 1);
  EXPECT_EQ(walls[0].velocity, vec3(0.0f));
  obstacles.lead(0, paddle.pose);
  obstacles.limit_speed(0.2f);
  obstacles.advance(0, dt, dt, vec3(0.0f));
  ASSERT_EQ(obstacles.walls_near(point, kReach, walls), 1);
  EXPECT_NEAR(glm::length(walls[0].velocity), 0.2f, 1e-6);
}

TEST(Boundary, OfAnObstacleThatGrowsComesFromInsideAtItsSpeed) {
  Obstacles obstacles(kTank, Axis::y, kReach);
  obstacles.add(ball({1, 0.5f, 0.5f}), 0);
  obstacles.appear(0);
  obstacles.grow(0, 0.03f, 2);
  Wall walls[Boundary::kMostWalls];
  for (const float inset : {0.03f, 0.02f, 0.01f, 0.0f, 0.0f}) {
    ASSERT_EQ(obstacles.walls_near({1.09f, 0.5f, 0.5f}, kReach, walls), 1);
    EXPECT_NEAR(walls[0].distance, -0.01f + inset, 1e-6);
    EXPECT_NEAR(walls[0].velocity.x, inset > 0 ? 2 : 0, 1e-5);
    obstacles.advance(0, 0.005f, 0.005f, vec3(0.0f));
  }
}

TEST(Obstacles, GetWhatTheWaterGives) {
  Obstacles obstacles(kTank, Axis::y, kReach);
  ObstacleOptions options = ball({1, 0.5f, 0.5f});
  obstacles.add(options, 0);
  options.pose.position.x = 0.5f;
  options.dynamic = true;
  options.density = 700;
  obstacles.add(options, 0);
  obstacles.appear(0);
  const std::vector<Impulse> impulses{{{5, 5, 5}, {1, 1, 1}}, {{0.3f, 0.2f, 0.1f}, {0.01f, 0, 0}}};
  obstacles.take(impulses);
  obstacles.take(impulses);
  obstacles.advance(0, 1e-4f, 1e-4f, vec3(0.0f));
  EXPECT_EQ(obstacles[0].body.motion.linear, vec3(0.0f));
  const float mass = 700 * 4.18879e-3f;
  EXPECT_LT(glm::distance(obstacles[1].body.motion.linear, 2.0f * impulses[1].linear / mass), 1e-4f);
  EXPECT_NEAR(obstacles[1].body.motion.angular.x, 0.02f / (0.4f * mass * 0.01f), 1e-2);
  const vec3 before = obstacles[1].body.motion.linear;
  obstacles.advance(0, 1e-4f, 1e-4f, vec3(0.0f));
  EXPECT_LT(glm::distance(obstacles[1].body.motion.linear, before), 1e-4f);  // given once
}

TEST(Obstacles, AreHeldWhileTheyAreLedAndThenLetGo) {
  Obstacles obstacles(kTank, Axis::y, kReach);
  ObstacleOptions options = ball({1, 0.5f, 0.5f});
  options.dynamic = true;
  obstacles.add(options, 0);
  obstacles.appear(0);
  constexpr float dt = 0.01f;
  for (int i = 1; i <= 5; ++i) {
    obstacles.lead(0, {{1 + 0.01f * float(i), 0.5f, 0.5f}, {1, 0, 0, 0}});
    obstacles.take(std::vector<Impulse>{{{9, 9, 9}, {9, 9, 9}}});
    obstacles.advance(0, dt, dt, {0, -9.81f, 0});
    EXPECT_EQ(obstacles[0].body.pose.position, vec3(1 + 0.01f * float(i), 0.5f, 0.5f));
    EXPECT_NEAR(obstacles[0].body.motion.linear.x, 1, 1e-4);
  }
  obstacles.advance(0, dt, dt, {0, -9.81f, 0});
  EXPECT_LT(glm::distance(obstacles[0].body.motion.linear, {0, -0.0981f, 0}), 1e-4f);
}

TEST(Boundary, SaysThatABoxMayTouchWhereverAPointOfItHasWalls) {
  for (const int count : {3, 40}) {
    Obstacles obstacles(kTank, Axis::y, kReach);
    std::mt19937 random(11);
    std::uniform_real_distribution<float> part(0, 1);
    const auto within = [&](const Bounds& box) {
      const float x = part(random), y = part(random), z = part(random);
      return box.low + box.extent() * vec3(x, y, z);
    };
    // All in one half of the tank.
    for (int i = 0; i < count; ++i) obstacles.add(ball(within({{0, 0, 0}, {0.8f, 1, 1}}), 0.1f), i == 2 ? 5 : 0);
    obstacles.appear(0);
    int touched = 0, free = 0;
    for (int n = 0; n < 2000; ++n) {
      const vec3 low = within(kTank);
      const Bounds box{low, low + 0.1f * vec3(part(random))};
      const bool may = obstacles.may_touch(box, kReach);
      bool does = false;
      for (int k = 0; k < 20 && !does; ++k) {
        Wall walls[Boundary::kMostWalls];
        does = obstacles.walls_near(within(box), kReach, walls) > 0;
      }
      EXPECT_TRUE(may || !does) << n;
      touched += does;
      free += !may;
    }
    EXPECT_GT(touched, 200);
    EXPECT_GT(free, 200);
  }
}

TEST(Obstacles, GoToTheirPlaceInAnyNumberOfParts) {
  for (const int parts : {1, 4}) {
    Obstacles obstacles(kTank, Axis::y, kReach);
    obstacles.add(ball({1, 0.5f, 0.5f}), 0);
    obstacles.appear(0);
    obstacles.lead(0, {{1.2f, 0.5f, 0.5f}, {1, 0, 0, 0}});
    for (int part = 0; part < parts; ++part) {
      obstacles.advance(0, 0.1f / float(parts), 0.1f * float(parts - part) / float(parts), vec3(0.0f));
      EXPECT_NEAR(obstacles[0].body.pose.position.x, 1 + 0.2f * float(part + 1) / float(parts), 1e-5);
      EXPECT_NEAR(obstacles[0].body.motion.linear.x, 2, 1e-3);
    }
    EXPECT_EQ(obstacles[0].body.pose.position.x, 1.2f);
  }
}

}  // namespace
}  // namespace meniscus
