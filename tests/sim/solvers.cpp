// What holds for both solvers, each within its own bounds.
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <ostream>

#include "solver_cases.h"

namespace meniscus {
namespace {

constexpr float kSpacing = 0.02f;

struct Bound {
  Solver solver;
  int settles;         ///< steps
  double level;        ///< spacings; sph is pressed together
  int breaks;          ///< steps of a dam break
  double bounce;       ///< of its energy: what presses the water is not counted in it
  double least_force;  ///< N s, of water on a ball that moves through it
};
void PrintTo(const Bound& bound, std::ostream* out) { *out << (bound.solver == Solver::sph ? "sph" : "pbf"); }
constexpr Bound kSph{Solver::sph, 700, 0.7, 700, 0.01, 0.01};
constexpr Bound kPbf{Solver::pbf, 400, 0.5, 250, 0.04, 0.005};

class Solvers : public testing::TestWithParam<Bound> {
 protected:
  FluidOptions options_ = fluid_of(GetParam().solver, kSpacing);
};

TEST_P(Solvers, LetADropFallFreely) {
  Fluid drop;
  drop.add({0.5f, 5, 0.5f}, {1, 0, 0});
  Case falling(options_, drop);
  const BoxBoundary tank(box({10, 10, 1}));
  const int steps = static_cast<int>(0.5f / falling.options.step);
  for (int n = 0; n < steps; ++n) falling.step(tank);
  const float time = static_cast<float>(steps) * falling.options.step;
  EXPECT_NEAR(falling.fluid.vy[0], -9.81f * time, 0.01f);
  EXPECT_NEAR(falling.fluid.x[0], 0.5f + time, 1e-3f);
  // Speed first, then place: half a step ahead of the parabola.
  EXPECT_NEAR(falling.fluid.y[0], 5 - 0.5f * 9.81f * time * (time + falling.options.step), 2e-3f);
}

TEST_P(Solvers, LetWaterComeToRestAtItsLevel) {
  Case still(options_, block_of_water(box({0.16f, 0.16f, 0.16f}), kSpacing));
  const Bounds walls = box({0.16f, 10, 0.16f});
  const BoxBoundary tank(walls);
  const double before = still.energy();
  for (int n = 0; n < GetParam().settles; ++n) {
    still.step(tank);
    ASSERT_LT(still.energy(), before * 1.02) << n;
  }
  EXPECT_LT(still.kinetic(), 5e-4 * before);
  EXPECT_TRUE(still.within(walls));
  // Eight layers: the mean height is that of four, the level twice as much.
  EXPECT_NEAR(2 * still.mean_height_rel(), 8, GetParam().level);
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

TEST_P(Solvers, BreakADamWithoutGainingEnergyOrLosingWater) {
  const Bounds walls = box({0.4f, 10, 0.16f});
  const BoxBoundary tank(walls);
  Case dam(options_, block_of_water(box({0.16f, 0.24f, 0.16f}), kSpacing));
  double energy = dam.energy();
  const double first = energy;
  for (int n = 0; n < GetParam().breaks; ++n) {
    dam.step(tank);
    const double now = dam.energy();
    ASSERT_LT(now, energy + GetParam().bounce * first) << n;
    energy = std::min(energy, now);
  }
  EXPECT_TRUE(dam.within(walls));
  EXPECT_LT(energy, 0.6 * first);
  EXPECT_NEAR(2 * dam.mean_height_rel(), 12 * 0.16 / 0.4, 0.9);
}

Fluid some_steps_of_a_dam(const FluidOptions& options, int steps) {
  Case dam(options, block_of_water(box({0.16f, 0.2f, 0.16f}), kSpacing));
  const BoxBoundary tank(box({0.4f, 10, 0.16f}));
  for (int n = 0; n < steps; ++n) dam.step(tank);
  return dam.fluid;
}

TEST_P(Solvers, GiveTheSameBitsOnAnyNumberOfThreads) {
  options_.vorticity = 0.5f;
  const auto run = [&](int threads) {
    const ThreadLimit limit(threads);
    return some_steps_of_a_dam(options_, 40);
  };
  const Fluid one = run(1);
  for (const int threads : {2, 5}) {
    const Fluid many = run(threads);
    EXPECT_EQ(one.x, many.x);
    EXPECT_EQ(one.y, many.y);
    EXPECT_EQ(one.vz, many.vz);
  }
}

TEST_P(Solvers, AgreeWithEveryInstructionSetToRounding) {
  // Few steps, for water is chaotic.
  options_.vorticity = 0.5f;
  const Fluid best = some_steps_of_a_dam(options_, 5);
  hwy::SetSupportedTargetsForTest(0);
  const std::int64_t supported = hwy::SupportedTargets() & ~std::int64_t{HWY_SSSE3 | HWY_AVX3_DL};
  int sets = 0;
  for (std::int64_t left = supported; left != 0; left &= left - 1, ++sets) {
    const auto target = static_cast<decltype(hwy::SupportedTargets())>(left & -left);
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    const Fluid other = some_steps_of_a_dam(options_, 5);
    float farthest = 0, fastest = 0;
    for (std::size_t i = 0; i < best.size(); ++i) {
      farthest = std::max({farthest, std::abs(best.x[i] - other.x[i]), std::abs(best.y[i] - other.y[i])});
      fastest = std::max({fastest, std::abs(best.vx[i] - other.vx[i]), std::abs(best.vz[i] - other.vz[i])});
    }
    EXPECT_LT(farthest, 1e-4f * kSpacing) << hwy::TargetName(target);
    EXPECT_LT(fastest, 1e-3f) << hwy::TargetName(target);
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  EXPECT_GE(sets, 1);
  RecordProperty("instruction_sets", sets);
}

TEST_P(Solvers, GiveBodiesWhatTheWaterLoses) {
  options_.gravity = vec3{0.0f};
  options_.surface_tension = 0;  // its forces are not pairs
  const vec3 centre{0.12f, 0.1f, 0.09f};
  const BallBoundary ball(centre, 0.05f, {0.3f, -0.2f, 0.1f}, {2, 8, -3});
  const Fluid block = block_of_water(box({0.2f, 0.2f, 0.2f}), kSpacing);
  Fluid around;
  for (std::size_t i = 0; i < block.size(); ++i) {
    const vec3 place{block.x[i], block.y[i], block.z[i]};
    if (length(place - centre) > 0.055f) around.add(place, vec3{0.0f});
  }
  Case water(options_, around);
  std::vector<Impulse> felt(1);
  for (int n = 0; n < 20; ++n) water.step(ball, felt);
  const Momentum gained = momentum_of(water.fluid, water.mass, centre);
  const double size = glm::length(gained.linear), turn = glm::length(gained.angular);
  ASSERT_GT(size, GetParam().least_force);
  EXPECT_LT(glm::length(gained.linear + glm::dvec3(felt[0].linear)), 1e-3 * size + 1e-5);
  // Places change within a step while momentum is counted at one: no more than a few per cent of the arm.
  EXPECT_LT(glm::length(gained.angular + glm::dvec3(felt[0].angular)), 0.1 * turn + 0.02 * size * 0.05);
}

TEST_P(Solvers, PartWaterThatIsInOnePlace) {
  Fluid twice = block_of_water(box({0.12f, 0.12f, 0.12f}), kSpacing);
  const Fluid again = twice;
  for (std::size_t i = 0; i < again.size(); ++i) twice.add({again.x[i], again.y[i], again.z[i]}, vec3{0.0f});
  const Bounds walls = box({0.3f, 100, 0.3f});
  const BoxBoundary tank(walls);
  Case doubled(options_, twice);
  for (int n = 0; n < 200; ++n) doubled.step(tank);
  EXPECT_TRUE(doubled.within(walls));
  for (std::size_t i = 0; i < again.size(); ++i) EXPECT_NE(doubled.fluid.x[i], doubled.fluid.x[i + again.size()]) << i;
}

TEST_P(Solvers, SayWhichOptionIsOutOfRange) {
  const auto refused = [&](auto change) {
    FluidOptions options = options_;
    change(options);
    EXPECT_THROW(Case(options, Fluid{}), Error);
  };
  refused([](FluidOptions& o) { o.spacing = 0; });
  refused([](FluidOptions& o) { o.spacing = NAN; });
  refused([](FluidOptions& o) { o.smoothing_length = 10 * kSpacing; });
  refused([](FluidOptions& o) { o.step = -1; });
  refused([](FluidOptions& o) { o.step = 100; });
  refused([](FluidOptions& o) { o.step = 1e-9f; });
  refused([](FluidOptions& o) { o.rest_density = 0; });
  refused([](FluidOptions& o) { o.iterations = 0; });
  refused([](FluidOptions& o) { o.gravity.x = INFINITY; });
  try {
    with_defaults(fluid_of(GetParam().solver, -3));
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("spacing"), std::string::npos) << error.what();
  }
}

std::string refusal(const FluidOptions& options) {
  try {
    with_defaults(options);
  } catch (const Error& error) {
    return error.what();
  }
  return "nothing was refused";
}

TEST(Sph, RefusesWhatOnlyStepsBelowAMicrosecondWouldKeepStable) {
  for (float FluidOptions::*option :
       {&FluidOptions::stiffness, &FluidOptions::viscosity, &FluidOptions::surface_tension}) {
    FluidOptions options = fluid_of(Solver::sph, kSpacing);
    options.*option = 1e10f;
    EXPECT_NE(refusal(options).find("steps are too short (expected at least 1e-06 s"), std::string::npos)
        << refusal(options);
    EXPECT_NE(refusal(options).find("less stiffness"), std::string::npos) << refusal(options);
    options.step = 2e-6f;  // parts of it are as short
    EXPECT_NE(refusal(options).find("steps are too short"), std::string::npos) << refusal(options);
  }
  FluidOptions hasty = fluid_of(Solver::sph, kSpacing);
  hasty.step = 1e-9f;
  EXPECT_NE(refusal(hasty).find("set a longer step"), std::string::npos) << refusal(hasty);
  EXPECT_NO_THROW(with_defaults(fluid_of(Solver::sph, 1e-5f))) << "the least spacing";
}

TEST_P(Solvers, TellSmoothingLengthsInSpacings) {
  options_.smoothing_length = 10 * kSpacing;
  EXPECT_NE(refusal(options_).find("expected 1.5 .. 4 spacings, found 10"), std::string::npos) << refusal(options_);
}

TEST_P(Solvers, TakeLongStepsInParts) {
  options_.step = 0.05f;
  if (options_.solver == Solver::sph) options_.stiffness = 40;
  EXPECT_LT(longest_stable_step(options_), options_.step);
  Case still(options_, block_of_water(box({0.12f, 0.12f, 0.12f}), kSpacing));
  const BoxBoundary tank(box({0.12f, 10, 0.12f}));
  const double before = still.energy();
  for (int n = 0; n < 40; ++n) still.step(tank);
  EXPECT_LT(still.kinetic(), 2e-3 * before);
}

INSTANTIATE_TEST_SUITE_P(Each, Solvers, testing::Values(kSph, kPbf),
                         [](const auto& of) { return of.param.solver == Solver::sph ? "Sph" : "Pbf"; });

}  // namespace
}  // namespace meniscus
