#include "meniscus/sim.h"

#include <cmath>
#include <cstring>
#include <functional>

#include "obstacle_meshes.h"
#include "simulation_tank.h"

namespace meniscus {
namespace {

constexpr auto kBox = ObstacleShape::Kind::box;
constexpr auto kSphere = ObstacleShape::Kind::sphere;
constexpr auto kCylinder = ObstacleShape::Kind::cylinder;

TEST(Simulation, PlacesWaterOnALatticeHalfASpacingFromTheWalls) {
  const Simulation simulation(small_tank(0.14f));
  EXPECT_EQ(simulation.size(), 20u * 7 * 10);
  const Particles particles = simulation.particles();
  const Bounds bounds = particles.bounds();
  EXPECT_LT(glm::distance(bounds.low, vec3(0.01f)), 1e-6f);
  EXPECT_LT(glm::distance(bounds.high, vec3(0.39f, 0.13f, 0.19f)), 1e-6f);
  EXPECT_EQ(particles.spacing, 0.02f);
  EXPECT_EQ(particles.up, Axis::y);
  EXPECT_EQ(particles.time, 0.0);
  EXPECT_EQ(particles.find("velocity")->values, std::vector<float>(3 * simulation.size(), 0.0f));
  EXPECT_EQ(simulation.kinetic_energy(), 0);
  // 0.0112 m^3 of water, its middle 0.07 m over the floor.
  EXPECT_NEAR(simulation.potential_energy(), 1000 * 0.0112 * 9.81 * 0.07, 1e-3);
}

TEST(Simulation, LeavesObstaclesOutOfTheWater) {
  SimulationOptions options = small_tank(0.14f);
  options.obstacles = {obstacle_of(kBox, {0.08f, 0.3f, 0.08f}, {0.2f, 0.1f, 0.1f})};
  const Simulation simulation(options);
  EXPECT_EQ(simulation.size(), 20u * 7 * 10 - 4 * 7 * 4);  // a hole of the box's own volume
}

TEST(Simulation, KeepsBlocksApart) {
  SimulationOptions options = small_tank(0.14f);
  options.blocks.push_back({{0, 0, 0}, {0.4f, 0.14f, 0.2f}});              // the same again
  options.blocks.push_back({{0.105f, 0.105f, 0.1f}, {0.2f, 0.2f, 0.2f}});  // half in the water
  Simulation simulation(options);
  const Particles particles = simulation.particles();
  EXPECT_GT(particles.size(), 20u * 7 * 10);
  float least = 1;
  for (std::size_t i = 0; i < particles.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      least = std::min(least, glm::distance(particles.position(i), particles.position(j)));
  EXPECT_GE(least, 0.0179f);
}

TEST(Simulation, TurnsItsDefaultGravityToTheUpAxis) {
  SimulationOptions options = small_tank(0);
  options.up = Axis::z;
  options.blocks = {{{0.1f, 0.1f, 0.1f}, {0.2f, 0.2f, 0.2f}}};
  Simulation simulation(options);
  for (int i = 0; i < 10; ++i) simulation.step();
  const Bounds bounds = simulation.particles().bounds();
  EXPECT_LT(bounds.low.z, 0.108f);
  EXPECT_NEAR(bounds.low.y, 0.11f, 2e-3);
}

TEST(Simulation, TakesTheStepsThatComeNearestToATime) {
  SimulationOptions options = small_tank(0.04f);
  options.fluid.step = 0.003f;
  Simulation simulation(options);
  simulation.advance(0.04);
  EXPECT_EQ(simulation.steps(), 13u);
  EXPECT_NEAR(simulation.time(), 0.039, 1e-6);
  simulation.advance(0.001);
  EXPECT_EQ(simulation.steps(), 13u);
  simulation.advance(0.04, 3);
  EXPECT_EQ(simulation.steps(), 16u);
  EXPECT_THROW(simulation.advance(-1), Error);
  EXPECT_THROW(simulation.advance(std::nan("")), Error);
  EXPECT_EQ(simulation.steps(), 16u);
}

TEST(Simulation, LetsABoxFloatAsDeepAsItsDensitySays) {
  SimulationOptions options;
  options.fluid.spacing = 0.025f;
  options.tank = {{0, 0, 0}, {0.4f, 0.6f, 0.4f}};
  options.blocks = {{{0, 0, 0}, {0.4f, 0.2f, 0.4f}}};
  ObstacleOptions box = obstacle_of(kBox, {0.2f, 0.15f, 0.2f}, {0.2f, 0.24f, 0.2f});
  box.dynamic = true;
  options.obstacles = {box};
  Simulation simulation(options);
  const double volume = static_cast<double>(simulation.size()) * std::pow(0.025, 3);
  simulation.advance(1.2);
  double height = 0;
  for (int i = 0; i < 10; ++i) {
    simulation.advance(0.06);
    height += static_cast<double>(simulation.pose(0).position.y) / 10;
  }
  // The water's level is its volume and what the box displaces, over the floor.
  const double displaced = 0.5 * 0.2 * 0.15 * 0.2;
  const double level = (volume + displaced) / 0.16;
  const double sunk = (level - (height - 0.075)) / 0.15;
  EXPECT_NEAR(sunk, 0.5, 0.075);
  EXPECT_GT(std::abs(simulation.pose(0).rotation.w), 0.95f);
  expect_inside(simulation.particles(), options.tank);
}

TEST(Simulation, PushesWaterOutOfWhatAppearsInItWithoutAnExplosion) {
  SimulationOptions options = small_tank(0.14f);
  ObstacleOptions ball = obstacle_of(kSphere, vec3(0.1f), {0.2f, 0.07f, 0.1f});
  ball.appears = 0.15;
  options.obstacles = {ball};
  Simulation simulation(options);
  EXPECT_FALSE(simulation.present(0));
  EXPECT_EQ(simulation.size(), 20u * 7 * 10);
  simulation.advance(0.144);
  EXPECT_FALSE(simulation.present(0));
  float most = 0;
  for (int i = 0; i < 100; ++i) {
    simulation.step();
    most = std::max(most, fastest(simulation.particles()));
  }
  EXPECT_TRUE(simulation.present(0));
  EXPECT_LT(depth_in_ball(simulation.particles(), ball.pose.position, 0.05f), 0.002f);
  EXPECT_LT(most, 2.5f);  // what a fall of 0.3 m brings
  expect_inside(simulation.particles(), options.tank);
}

TEST(Simulation, LetsNoParticleIntoAnObstacleThatIsMoved) {
  SimulationOptions options = small_tank(0.14f);
  options.obstacles = {obstacle_of(kSphere, vec3(0.08f), {0.06f, 0.06f, 0.1f})};
  Simulation simulation(options);
  // As a mouse would, at 4 m/s, there and back, then across at once.
  Pose pose = options.obstacles[0].pose;
  const auto go = [&](float x) {
    pose.position.x = x;
    simulation.move(0, pose);
    simulation.step();
    ASSERT_EQ(simulation.pose(0).position.x, x);
    ASSERT_LT(depth_in_ball(simulation.particles(), pose.position, 0.04f), 0.002f) << x;
    expect_inside(simulation.particles(), options.tank);
  };
  for (int i = 1; i <= 24; ++i) go(0.06f + 0.0115f * float(i));
  for (int i = 23; i >= 0; --i) go(0.06f + 0.0115f * float(i));
  go(0.2f);
}

TEST(Simulation, SetsWhatGoesTooFarInAStepThereAnew) {
  SimulationOptions options = small_tank(0.14f);
  options.tank.high.x = 4;
  options.obstacles = {obstacle_of(kSphere, vec3(0.08f), {3.9f, 0.06f, 0.1f})};
  Simulation simulation(options);
  simulation.move(0, {{0.2f, 0.06f, 0.1f}, {1, 0, 0, 0}});
  simulation.step();
  EXPECT_EQ(simulation.pose(0).position.x, 0.2f);
  float most = 0;
  for (int i = 0; i < 60; ++i) {
    simulation.step();
    most = std::max(most, fastest(simulation.particles()));
  }
  EXPECT_LT(most, 2.5f);
  EXPECT_LT(depth_in_ball(simulation.particles(), simulation.pose(0).position, 0.04f), 0.002f);
}

TEST(Simulation, RunsAroundAMesh) {
  SimulationOptions options = small_tank(0.14f);
  ObstacleOptions mesh;
  mesh.shape = bumpy_mesh(12);
  for (vec3& p : mesh.shape.positions) p *= 0.15f;
  mesh.path = {{0, {{0.1f, 0.07f, 0.1f}, {1, 0, 0, 0}}}, {0.2, {{0.3f, 0.07f, 0.1f}, {0, 0, 1, 0}}}};
  options.obstacles = {mesh};
  Simulation simulation(options);
  for (int i = 0; i < 70; ++i) simulation.step();
  EXPECT_EQ(simulation.pose(0).position, vec3(0.3f, 0.07f, 0.1f));
  EXPECT_LT(depth_in_ball(simulation.particles(), simulation.pose(0).position, 0.045f), 0.002f);
  expect_inside(simulation.particles(), options.tank);
}

/// Everything that a simulation can be asked for at once.
Particles eventful(int threads) {
  const ThreadLimit limit(threads);
  SimulationOptions options = small_tank(0.1f);
  ObstacleOptions box = obstacle_of(kBox, {0.06f, 0.05f, 0.06f}, {0.1f, 0.15f, 0.1f});
  box.dynamic = true;
  ObstacleOptions post = obstacle_of(kCylinder, {0.05f, 0.2f, 0}, {0.3f, 0.1f, 0.1f});
  post.path = {{0, post.pose}, {0.1, {{0.25f, 0.1f, 0.12f}, {0, 0, 1, 0}}}};
  ObstacleOptions ball = obstacle_of(kSphere, vec3(0.06f), {0.2f, 0.05f, 0.05f});
  ball.appears = 0.03;
  ball.dynamic = true;
  options.obstacles = {box, post, ball};
  options.pours = {{0.01, 0.1, {0.2f, 0.25f, 0.1f}, {0.2f, -1, 0}, 0.03f}};
  options.stirs = {{0.02, 0.1, {0.2f, 0, 0.1f}, {0, 1, 0}, 0.1f, 1}};
  options.tilts = {{0, 0.2, {0, 0, 1}, 0.3f}};
  options.drags = {{0.05, 0.1, 0, {0.12f, 0.1f, 0.08f}}};
  Simulation simulation(options);
  for (int i = 0; i < 45; ++i) {
    simulation.step();
    if (i == 20) simulation.add(obstacle_of(kBox, vec3(0.04f), {0.35f, 0.05f, 0.15f}));
    if (i == 25) simulation.add_water({{0.3f, 0.2f, 0.1f}, {0.4f, 0.26f, 0.2f}});
    if (i > 30) simulation.move(3, {{0.35f, 0.05f, 0.15f - 0.002f * float(i - 30)}, {1, 0, 0, 0}});
  }
  Particles particles = simulation.particles();
  Attribute poses{"poses", 1, {}};
  for (std::size_t i = 0; i < simulation.obstacles(); ++i) {
    const Pose pose = simulation.pose(i);
    for (int axis = 0; axis < 3; ++axis) poses.values.push_back(pose.position[axis]);
    poses.values.insert(poses.values.end(), {pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z});
  }
  particles.attributes.push_back(poses);
  expect_inside(particles, options.tank);
  return particles;
}

TEST(Simulation, GivesTheSameBitsOnAnyNumberOfThreads) {
  const Particles one = eventful(1);
  const auto same = [](const std::vector<float>& a, const std::vector<float>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
  };
  for (const int threads : {1, 2, 3}) {
    const Particles other = eventful(threads);
    EXPECT_TRUE(same(one.x, other.x) && same(one.y, other.y) && same(one.z, other.z)) << threads;
    EXPECT_TRUE(same(one.attributes[0].values, other.attributes[0].values)) << threads;
    EXPECT_TRUE(same(one.attributes[1].values, other.attributes[1].values)) << threads;
  }
}

TEST(Simulation, RefusesWhatItCannotDoAndSaysWhy) {
  const float nan = std::nanf("");
  struct Case {
    const char* said;
    std::function<void(SimulationOptions&)> spoil;
  };
  const std::vector<Case> cases{
      {"spacing", [](auto& o) { o.fluid.spacing = 0; }},
      {"the tank has no room", [](auto& o) { o.tank.high.y = 0.01f; }},
      {"the tank has no room", [](auto& o) { o.tank.high.z = -1; }},
      {"tank's upper corner", [&](auto& o) { o.tank.high.x = nan; }},
      {"number of particles is out of range", [](auto& o) { o.most_particles = 0; }},
      {"reaches out of the tank",
       [](auto& o) {
         o.blocks.push_back({{0, 0, 0}, {0.5f, 0.1f, 0.1f}});
       }},
      {"reaches out of the tank",
       [](auto& o) {
         o.blocks.push_back({{0, -0.1f, 0}, {0.1f, 0.1f, 0.1f}});
       }},
      {"turned over",
       [](auto& o) {
         o.blocks.push_back({{0.2f, 0, 0}, {0.1f, 0.1f, 0.1f}});
       }},
      {"block of water is out of range",
       [&](auto& o) {
         o.blocks.push_back({{0, 0, 0}, {0.1f, nan, 0.1f}});
       }},
      {"more water than particles are allowed", [](auto& o) { o.most_particles = 100; }},
      {"more water than particles are allowed",
       [](auto& o) {
         o.blocks.push_back({{0, 0, 0}, {0.4f, 9e5f, 0.2f}});
       }},
      {"the diameter", [&](auto& o) { o.obstacles = {obstacle_of(kSphere, vec3(nan), {})}; }},
      {"place is out of range",
       [&](auto& o) {
         o.obstacles = {obstacle_of(kSphere, vec3(1), {nan, 0, 0})};
       }},
      {"not a unit quaternion",
       [](auto& o) { o.obstacles = {obstacle_of(kBox, vec3(1), {})}, o.obstacles[0].pose.rotation.w = 0; }},
      {"density of a dynamic",
       [](auto& o) {
         o.obstacles = {obstacle_of(kBox, vec3(1), {})}, o.obstacles[0].dynamic = true, o.obstacles[0].density = -5;
       }},
      {"cannot follow a path",
       [](auto& o) {
         o.obstacles = {obstacle_of(kBox, vec3(1), {})}, o.obstacles[0].dynamic = true, o.obstacles[0].path = {{}};
       }},
      {"do not rise",
       [](auto& o) {
         o.obstacles = {obstacle_of(kBox, vec3(1), {})}, o.obstacles[0].path = {{1, {}}, {1, {}}};
       }},
      {"mesh cannot be dynamic",
       [](auto& o) {
         o.obstacles = {{}}, o.obstacles[0].shape = box_triangles(vec3(1)), o.obstacles[0].dynamic = true;
       }},
      {"time when an obstacle appears",
       [](auto& o) { o.obstacles = {obstacle_of(kBox, vec3(1), {})}, o.obstacles[0].appears = std::nan(""); }},
      {"no such obstacle", [](auto& o) { o.drags = {{}}; }},
      {"a drag does not end",
       [](auto& o) {
         o.obstacles = {obstacle_of(kBox, vec3(0.1f), {})}, o.drags = {{2, 1, 0, {}}};
       }},
      {"outside of the tank",
       [](auto& o) {
         o.pours = {{0, 1, {1, 1, 1}, {0, -1, 0}, 0.01f}};
       }},
      {"blocks of water hold no particle (expected water that fills a cube of one spacing at least, found blocks "
       "thinner",
       [](auto& o) {
         o.blocks = {{o.tank.low, o.tank.low + 0.5f * o.fluid.spacing}};
       }},
      {"blocks that are taken by obstacles",
       [](auto& o) {
         ObstacleOptions all;
         all.shape.size = 3.0f * o.tank.extent();
         all.pose.position = o.tank.centre();
         o.obstacles = {all};
       }},
      {"speed of a jet",
       [](auto& o) {
         o.pours = {{0, 1, {0.1f, 0.1f, 0.1f}, {0, 0, 0}, 0.01f}};
       }},
      {"radius of a jet",
       [](auto& o) {
         o.pours = {{0, 1, {0.1f, 0.1f, 0.1f}, {0, 1, 0}, -1}};
       }},
      {"one layer of a jet",
       [](auto& o) {
         o.pours = {{0, 1, {0.1f, 0.1f, 0.1f}, {0, 1, 0}, 1e5f}};
       }},
      {"a jet does not end",
       [](auto& o) {
         o.pours = {{1, 0, {0.1f, 0.1f, 0.1f}, {0, 1, 0}, 0.01f}};
       }},
      {"axis of stirring",
       [](auto& o) {
         o.stirs = {{0, 1, {}, {0, 0, 0}, 0.1f, 1}};
       }},
      {"radius of stirring",
       [](auto& o) {
         o.stirs = {{0, 1, {}, {0, 1, 0}, 0, 1}};
       }},
      {"speed of stirring",
       [&](auto& o) {
         o.stirs = {{0, 1, {}, {0, 1, 0}, 1, nan}};
       }},
      {"axis of a tilt",
       [&](auto& o) {
         o.tilts = {{0, 1, {nan, 0, 0}, 1}};
       }},
      {"angle of a tilt",
       [](auto& o) {
         o.tilts = {{0, 1, {0, 0, 1}, 10}};
       }},
      {"a tilt does not end",
       [](auto& o) {
         o.tilts = {{0, std::nan(""), {0, 0, 1}, 1}};
       }},
  };
  for (const Case& spoilt : cases) {
    SimulationOptions options = small_tank();
    spoilt.spoil(options);
    try {
      Simulation simulation(options);
      ADD_FAILURE() << spoilt.said << ": was not refused";
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(spoilt.said), std::string::npos) << error.what();
    }
  }
  Simulation simulation(small_tank());
  EXPECT_THROW(simulation.pose(0), Error);
  EXPECT_THROW(simulation.present(0), Error);
  EXPECT_THROW(simulation.move(0, {}), Error);
}

}  // namespace
}  // namespace meniscus
