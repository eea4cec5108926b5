#include "sim/pbf.h"

#include <gtest/gtest.h>

#include "solver_cases.h"

namespace meniscus {
namespace {

constexpr float kSpacing = 0.02f;
const FluidOptions kOptions = fluid_of(Solver::pbf, kSpacing);

TEST(Pbf, FallsFreely) {
  Fluid drop;
  drop.add({0.5f, 5, 0.5f}, {1, 0, 0});
  Case falling(kOptions, drop);
  const BoxBoundary tank(box({10, 10, 1}));
  const int steps = static_cast<int>(0.5f / falling.options.step);
  for (int n = 0; n < steps; ++n) falling.step(tank);
  const float time = static_cast<float>(steps) * falling.options.step;
  EXPECT_NEAR(falling.fluid.vy[0], -9.81f * time, 0.01f);
  EXPECT_NEAR(falling.fluid.x[0], 0.5f + time, 1e-3f);
  // Speed first, then place: half a step ahead of the parabola.
  EXPECT_NEAR(falling.fluid.y[0], 5 - 0.5f * 9.81f * time * (time + falling.options.step), 2e-3f);
}

TEST(Pbf, WaterAtRestSettlesAtItsLevel) {
  const vec3 size{0.16f, 0.16f, 0.16f};
  Case still(kOptions, block_of_water(box(size), kSpacing));
  const Bounds walls = box({0.16f, 10, 0.16f});
  const BoxBoundary tank(walls);
  const double before = still.energy();
  for (int n = 0; n < 400; ++n) {
    still.step(tank);
    ASSERT_LT(still.energy(), before * 1.02) << n;
  }
  EXPECT_LT(still.kinetic(), 5e-4 * before);
  EXPECT_TRUE(still.within(walls));
  // Eight layers: the mean height is that of four, the level twice as much.
  EXPECT_NEAR(2 * still.mean_height_rel(), 8, 0.5);
  glm::dvec3 centre{0.0};
  float lowest = 1;
  for (std::size_t i = 0; i < still.fluid.size(); ++i) {
    centre += glm::dvec3(still.fluid.x[i], still.fluid.y[i], still.fluid.z[i]) / double(still.fluid.size());
    lowest = std::min(lowest, still.fluid.y[i]);
  }
  EXPECT_NEAR(centre.x, 0.08, 0.2 * kSpacing);  // it does not drift
  EXPECT_NEAR(centre.z, 0.08, 0.2 * kSpacing);
  EXPECT_GT(lowest, 0.35f * kSpacing);  // no layer sticks to the floor
  EXPECT_LT(lowest, 0.70f * kSpacing);  // and there is no gap
}

TEST(Pbf, DamBreaksWithoutGainingEnergyOrLosingWater) {
  const Bounds walls = box({0.4f, 10, 0.16f});
  const BoxBoundary tank(walls);
  Case dam(kOptions, block_of_water(box({0.16f, 0.24f, 0.16f}), kSpacing));
  double energy = dam.energy();
  const double first = energy;
  for (int n = 0; n < 250; ++n) {
    dam.step(tank);
    const double now = dam.energy();
    ASSERT_LT(now, energy + 0.04 * first) << n;  // what presses the water is not counted
    energy = std::min(energy, now);
  }
  EXPECT_TRUE(dam.within(walls));
  EXPECT_LT(energy, 0.6 * first);
  EXPECT_NEAR(2 * dam.mean_height_rel(), 12 * 0.16 / 0.4, 0.9);
}

TEST(Pbf, GivesTheSameBitsOnAnyNumberOfThreads) {
  const auto run = [](int threads) {
    const ThreadLimit limit(threads);
    Case dam(kOptions, block_of_water(box({0.16f, 0.2f, 0.16f}), kSpacing));
    const BoxBoundary tank(box({0.4f, 10, 0.16f}));
    for (int n = 0; n < 40; ++n) dam.step(tank);
    return dam.fluid;
  };
  const Fluid one = run(1);
  for (const int threads : {2, 5}) {
    const Fluid many = run(threads);
    EXPECT_EQ(one.x, many.x);
    EXPECT_EQ(one.y, many.y);
    EXPECT_EQ(one.vz, many.vz);
  }
}

TEST(Pbf, GivesBodiesWhatTheWaterLoses) {
  FluidOptions options = kOptions;
  options.gravity = vec3{0.0f};
  options.surface_tension = 0;  // its forces are not pairs
  const vec3 centre{0.12f, 0.1f, 0.09f};
  const BallBoundary ball(centre, 0.05f, {0.3f, -0.2f, 0.1f}, {2, 8, -3});
  const Fluid block = block_of_water(box({0.2f, 0.2f, 0.2f}), kSpacing);
  Fluid around;
  for (std::size_t i = 0; i < block.size(); ++i) {
    const vec3 place{block.x[i], block.y[i], block.z[i]};
    if (length(place - centre) > 0.055f) around.add(place, vec3{0.0f});
  }
  Case water(options, around);
  std::vector<Impulse> felt(1);
  for (int n = 0; n < 20; ++n) water.step(ball, felt);
  const Momentum gained = momentum_of(water.fluid, water.mass, centre);
  const double size = glm::length(gained.linear), turn = glm::length(gained.angular);
  ASSERT_GT(size, 0.005);
  EXPECT_LT(glm::length(gained.linear + glm::dvec3(felt[0].linear)), 1e-3 * size + 1e-5);
  // Places change within a step while momentum is counted at one: no more than a few per cent of the arm.
  EXPECT_LT(glm::length(gained.angular + glm::dvec3(felt[0].angular)), 0.1 * turn + 0.02 * size * 0.05);
}

TEST(Pbf, PartsWaterThatIsInOnePlace) {
  Fluid twice = block_of_water(box({0.12f, 0.12f, 0.12f}), kSpacing);
  const Fluid again = twice;
  for (std::size_t i = 0; i < again.size(); ++i) twice.add({again.x[i], again.y[i], again.z[i]}, vec3{0.0f});
  const Bounds walls = box({0.3f, 100, 0.3f});
  const BoxBoundary tank(walls);
  Case doubled(kOptions, twice);
  for (int n = 0; n < 200; ++n) doubled.step(tank);
  EXPECT_TRUE(doubled.within(walls));
  for (std::size_t i = 0; i < again.size(); ++i) EXPECT_NE(doubled.fluid.x[i], doubled.fluid.x[i + again.size()]) << i;
}

TEST(Pbf, SaysWhichOptionIsOutOfRange) {
  const auto refused = [](auto change) {
    FluidOptions options = kOptions;
    change(options);
    EXPECT_THROW(make_pbf_solver(options), Error);
  };
  refused([](FluidOptions& o) { o.spacing = 0; });
  refused([](FluidOptions& o) { o.spacing = NAN; });
  refused([](FluidOptions& o) { o.smoothing_length = 10 * kSpacing; });
  refused([](FluidOptions& o) { o.step = -1; });
  refused([](FluidOptions& o) { o.step = 100; });
  refused([](FluidOptions& o) { o.rest_density = 0; });
  refused([](FluidOptions& o) { o.iterations = 0; });
  refused([](FluidOptions& o) { o.gravity.x = INFINITY; });
  try {
    with_defaults(fluid_of(Solver::pbf, -3));
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("spacing"), std::string::npos) << error.what();
  }
}

TEST(Pbf, TakesLongStepsInParts) {
  FluidOptions options = kOptions;
  options.step = 0.05f;
  if (options.solver == Solver::sph) options.stiffness = 40;
  EXPECT_LT(longest_stable_step(options), options.step);
  Case still(options, block_of_water(box({0.12f, 0.12f, 0.12f}), kSpacing));
  const BoxBoundary tank(box({0.12f, 10, 0.12f}));
  const double before = still.energy();
  for (int n = 0; n < 40; ++n) still.step(tank);
  EXPECT_LT(still.kinetic(), 2e-3 * before);
}

}  // namespace
}  // namespace meniscus
