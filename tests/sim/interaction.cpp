#include "sim/interaction.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <numbers>

#include "simulation_tank.h"

namespace meniscus {
namespace {

constexpr float kSpacing = 0.02f;
const Bounds kTank{{0, 0, 0}, {0.4f, 0.3f, 0.2f}};

/// A jet whose water goes on as it came, for `seconds`.
Fluid free_jet(const Pour& pour, double seconds, const Obstacles& obstacles, std::size_t most = 100'000) {
  const Jet jet(pour, kSpacing);
  Fluid fluid;
  constexpr double dt = 0.003;
  for (double time = 0; time < seconds; time += dt) {
    for (std::size_t i = 0; i < fluid.size(); ++i) {
      fluid.x[i] += static_cast<float>(dt) * fluid.vx[i];
      fluid.y[i] += static_cast<float>(dt) * fluid.vy[i];
      fluid.z[i] += static_cast<float>(dt) * fluid.vz[i];
    }
    jet.emit(fluid, time, dt, obstacles, most);
  }
  return fluid;
}

TEST(Jet, BringsTheFluxOfItsDisc) {
  const Obstacles nothing(kTank, Axis::y, 2 * kSpacing);
  for (const float radius : {0.004f, 0.011f, 0.02f, 0.033f, 0.05f})
    for (const float speed : {0.3f, 1.0f, 7.0f}) {
      const Pour pour{0.1, 1.9, {0.2f, 0.25f, 0.1f}, vec3(0, -1, 0) * speed, radius};
      const Fluid fluid = free_jet(pour, 2, nothing);
      const double area = std::numbers::pi * double(radius) * double(radius);
      const double expected = area * double(speed) * 1.8 / std::pow(double(kSpacing), 3);
      // One layer is more or less by chance.
      const double layer = std::ceil(area / (double(kSpacing) * double(kSpacing)));
      EXPECT_NEAR(static_cast<double>(fluid.size()), expected, 0.6 * layer + 1e-3 * expected) << radius << " " << speed;
    }
}

TEST(Jet, KeepsItsParticlesASpacingApart) {
  const Obstacles nothing(kTank, Axis::y, 2 * kSpacing);
  const vec3 velocity = glm::normalize(vec3(0.5f, -1, 0.3f)) * 2.0f;
  const Fluid fluid = free_jet({0, 0.15, {0.2f, 0.25f, 0.1f}, velocity, 0.03f}, 0.2, nothing);
  ASSERT_GT(fluid.size(), 50u);
  float least = 1;
  for (std::size_t i = 0; i < fluid.size(); ++i) {
    const vec3 p{fluid.x[i], fluid.y[i], fluid.z[i]};
    for (std::size_t j = 0; j < i; ++j) least = std::min(least, glm::distance(p, {fluid.x[j], fluid.y[j], fluid.z[j]}));
    // All on the way from the disc.
    const vec3 arm = p - vec3(0.2f, 0.25f, 0.1f), along = velocity / 2.0f;
    EXPECT_GE(glm::dot(arm, along), 0);
    EXPECT_LT(glm::length(arm - along * glm::dot(arm, along)), 0.03f + kSpacing / 2);
  }
  EXPECT_GT(least, 0.99f * kSpacing);
}

TEST(Jet, StopsAtTheMostParticlesAndWhereItsMouthIsBlocked) {
  Obstacles obstacles(kTank, Axis::y, 2 * kSpacing);
  const Pour pour{0, 1, {0.2f, 0.25f, 0.1f}, {0, -1, 0}, 0.03f};
  EXPECT_EQ(free_jet(pour, 1, obstacles, 37).size(), 37u);
  // Its water does not leave: only one layer fits.
  const Jet jet(pour, kSpacing);
  Fluid fluid;
  for (double time = 0; time < 1; time += 0.003) {
    jet.emit(fluid, time, 0.003, obstacles, 100'000);
    for (float& vy : fluid.vy) vy = 0;
  }
  EXPECT_LE(fluid.size(), 16u);
  // A stone lies on it.
  obstacles.add(obstacle_of(ObstacleShape::Kind::sphere, vec3(0.1f), {0.2f, 0.25f, 0.1f}), 0);
  obstacles.appear(0);
  EXPECT_EQ(free_jet(pour, 1, obstacles).size(), 0u);
}

TEST(Jet, PoursIntoTheTankByItsFlux) {
  SimulationOptions options = small_tank(0.04f);
  options.pours = {{0.05, 0.55, {0.2f, 0.22f, 0.1f}, {0, -1, 0}, 0.045f}};
  Simulation simulation(options);
  const std::size_t before = simulation.size();
  simulation.advance(0.6);
  const double expected = std::numbers::pi * 0.045 * 0.045 * 0.5 / std::pow(0.02, 3);
  EXPECT_NEAR(static_cast<double>(simulation.size() - before) / expected, 1, 0.02);
  expect_inside(simulation.particles(), options.tank);
}

TEST(Tilt, TurnsGravityAgainstTheTankBySineSquared) {
  const std::vector<Tilt> tilts{{1, 5, {0, 0, 2}, 0.4f}};
  const vec3 gravity{0, -10, 0};
  EXPECT_EQ(tilted(gravity, tilts, 0.9), gravity);
  EXPECT_EQ(tilted(gravity, tilts, 5.1), gravity);
  // The tank leans to the left: x rises, the water runs towards -x.
  EXPECT_LT(glm::distance(tilted(gravity, tilts, 3), vec3(-10 * std::sin(0.4f), -10 * std::cos(0.4f), 0)), 1e-4f);
  EXPECT_LT(glm::distance(tilted(gravity, tilts, 2), vec3(-10 * std::sin(0.2f), -10 * std::cos(0.2f), 0)), 1e-4f);
}

TEST(Tilt, LeansTheStillWaterByItsAngle) {
  SimulationOptions options = small_tank(0.12f);
  options.tank.high.z = 0.1f;
  options.blocks[0].high.z = 0.1f;
  options.fluid.solver = Solver::sph;
  options.tilts = {{0, 4, {0, 0, 1}, 0.25f}};
  Simulation simulation(options);
  simulation.advance(1.7);
  // The middle of water under a plane that leans by a lies 1/12 L^2 tan(a) / depth beside the tank's.
  double x = 0;
  for (int i = 0; i < 10; ++i) {
    simulation.advance(0.06);
    const Particles particles = simulation.particles();
    for (const float each : particles.x) x += static_cast<double>(each) / static_cast<double>(particles.size()) / 10;
  }
  const double depth = 0.12, length = 0.4;
  const double angle = std::atan((0.2 - x) * 12 * depth / (length * length));
  EXPECT_NEAR(angle, 0.25 * 0.97, 0.04);  // 0.97: the mean of sin^2 around its middle
}

TEST(Stir, DrivesTheWaterAroundItsAxis) {
  for (const float speed : {0.6f, -0.6f}) {
    SimulationOptions options = small_tank(0.1f);
    options.tank.high.x = 0.2f;
    options.blocks[0].high.x = 0.2f;
    options.stirs = {{0.1, 0.6, {0.1f, 0, 0.1f}, {0, 1, 0}, 0.09f, speed}};
    Simulation simulation(options);
    simulation.advance(0.6);
    const Particles particles = simulation.particles();
    const std::vector<float>& v = particles.find("velocity")->values;
    double mean = 0, wanted = 0;
    int count = 0;
    for (std::size_t i = 0; i < particles.size(); ++i) {
      const vec3 arm = particles.position(i) - vec3(0.1f, 0, 0.1f);
      const float distance = std::hypot(arm.x, arm.z);
      if (distance > 0.08f || distance < 0.02f) continue;
      // About y, from z to x.
      mean += static_cast<double>((v[3 * i] * arm.z - v[3 * i + 2] * arm.x) / distance);
      wanted += static_cast<double>(speed * distance / 0.09f);
      ++count;
    }
    ASSERT_GT(count, 100);
    EXPECT_GT(mean / wanted, 0.5);
    EXPECT_LT(mean / wanted, 1.1);
    expect_inside(particles, options.tank);
  }
}

TEST(Drag, StartsAndStopsSmoothlyAndEndsAtItsPlace) {
  SimulationOptions options = small_tank(0.1f);
  options.obstacles = {obstacle_of(ObstacleShape::Kind::sphere, vec3(0.08f), {0.08f, 0.05f, 0.1f})};
  options.drags = {{0.06, 0.36, 0, {0.32f, 0.06f, 0.1f}}};
  Simulation simulation(options);
  vec3 place = simulation.pose(0).position, last(0.0f);
  float fastest_way = 0;
  for (int i = 0; i < 130; ++i) {
    simulation.step();
    const vec3 way = simulation.pose(0).position - place;
    place += way;
    EXPECT_LT(glm::distance(way, last), 1.6e-4f);  // 18 m/s^2
    fastest_way = std::max(fastest_way, glm::length(way));
    last = way;
    ASSERT_LT(depth_in_ball(simulation.particles(), place, 0.04f), 0.002f);
    if (simulation.time() < 0.06) {
      EXPECT_EQ(way, vec3(0.0f));
    }
  }
  EXPECT_EQ(place, vec3(0.32f, 0.06f, 0.1f));
  EXPECT_NEAR(fastest_way / simulation.step_size(), 1.875 * 0.24 / 0.3, 0.05);
  expect_inside(simulation.particles(), options.tank);
}

TEST(Drag, HoldsADynamicBodyUpAndLetsItFallAfterwards) {
  SimulationOptions options = small_tank(0.04f);
  ObstacleOptions ball = obstacle_of(ObstacleShape::Kind::sphere, vec3(0.06f), {0.2f, 0.2f, 0.1f});
  ball.dynamic = true;
  options.obstacles = {ball};
  options.drags = {{0, 0.09, 0, {0.25f, 0.25f, 0.1f}}};
  Simulation simulation(options);
  simulation.advance(0.09);
  EXPECT_LT(glm::distance(simulation.pose(0).position, vec3(0.25f, 0.25f, 0.1f)), 1e-6f);
  simulation.advance(0.09);
  EXPECT_NEAR(simulation.pose(0).position.y, 0.25 - 0.5 * 9.81 * 0.09 * 0.09, 3e-3);
}

}  // namespace
}  // namespace meniscus
