// Bodies in water with either solver: which sink, which fall over.
#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "simulation_tank.h"

namespace meniscus {
namespace {

class BodiesInWater : public testing::TestWithParam<Solver> {};

TEST_P(BodiesInWater, SinkToTheFloorWhereTheyAreHeavy) {
  SimulationOptions options = small_tank(0.2f);
  options.fluid.solver = GetParam();
  ObstacleOptions ball = obstacle_of(ObstacleShape::Kind::sphere, vec3(0.1f), {0.204f, 0.19f, 0.1f});
  ball.dynamic = true;
  ball.density = 2000;
  options.obstacles = {ball};
  Simulation simulation(options);
  simulation.advance(0.9);
  // No layer of water stays under a ball of five spacings.
  EXPECT_NEAR(simulation.pose(0).position.y, 0.05f, 0.002f);
  simulation.advance(0.1);
  EXPECT_NEAR(simulation.pose(0).position.y, 0.05f, 0.002f);
  EXPECT_LT(depth_in_ball(simulation.particles(), simulation.pose(0).position, 0.05f), 0.01f);
}

/// How far a floating cylinder three times as long as wide leans, degrees, seconds after it was let go at `start`.
float lean_of_a_cylinder(Solver solver, float start_deg, double seconds) {
  SimulationOptions options;
  options.fluid.solver = solver;
  options.fluid.spacing = 0.03f;
  options.tank = {{0, 0, 0}, {0.6f, 1, 0.3f}};
  options.blocks = {{{0, 0, 0}, {0.6f, 0.36f, 0.3f}}};
  ObstacleOptions cylinder = obstacle_of(ObstacleShape::Kind::cylinder, {0.15f, 0.45f, 0.15f}, {0.3f, 0.4f, 0.15f});
  cylinder.pose.rotation = glm::angleAxis(glm::radians(start_deg), vec3(0, 0, 1));
  cylinder.dynamic = true;
  cylinder.density = 500;
  options.obstacles = {cylinder};
  Simulation simulation(options);
  simulation.advance(seconds);
  const vec3 axis = simulation.pose(0).rotation * vec3(0, 1, 0);
  return glm::degrees(std::acos(std::min(axis.y, 1.0f)));
}

TEST_P(BodiesInWater, FallOverWhereTheyAreSlender) {
  // Upright a slender cylinder is in an equilibrium, but not a stable one: with diameter d, length l and half of the
  // density of water its metacentre is d^2 / (8 l) above the centre of what it displaces, its own centre l / 4.
  EXPECT_LT(lean_of_a_cylinder(GetParam(), 0, 0.3), 1);
  EXPECT_GT(lean_of_a_cylinder(GetParam(), 2, 0.3), 2.5f);
  EXPECT_NEAR(lean_of_a_cylinder(GetParam(), 2, 2), 90, 6);
}

INSTANTIATE_TEST_SUITE_P(Each, BodiesInWater, testing::Values(Solver::sph, Solver::pbf),
                         [](const auto& of) { return of.param == Solver::sph ? "Sph" : "Pbf"; });

}  // namespace
}  // namespace meniscus
