#include "sim/sph.h"

#include <gtest/gtest.h>

#include "meniscus/formulas/fluids.h"
#include "meniscus/formulas/kernels.h"
#include "solver_cases.h"

namespace meniscus {
namespace {

constexpr float kSpacing = 0.02f;
const FluidOptions kOptions = fluid_of(Solver::sph, kSpacing);

/// Relative density at a particle far from all walls, by brute force in double precision.
double density_at(const Case& water, std::size_t i) {
  const float h = water.options.smoothing_length;
  const Fluid& fluid = water.fluid;
  const glm::dvec3 place(fluid.x[i], fluid.y[i], fluid.z[i]);
  double sum = 0;
  for (std::size_t j = 0; j < fluid.size(); ++j) {
    const double r = glm::length(glm::dvec3(fluid.x[j], fluid.y[j], fluid.z[j]) - place);
    if (r < static_cast<double>(h)) sum += formulas::spiky(static_cast<float>(r), h);
  }
  return sum * sph_constants(water.options).per_lattice;
}

TEST(Sph, IsPressedTogetherAsItsStiffnessSays) {
  // p = k (rho - rho_0) and dp/dy = -rho g: rho = rho_0 exp(g (H - y) / k) below the level H, and the level is lower by
  // g H^2 / (2 k) than that of 15 layers.
  const vec3 size{0.16f, 0.3f, 0.16f};
  Case still(kOptions, block_of_water(box(size), kSpacing));
  const BoxBoundary tank(box({size.x, 10, size.z}));
  for (int n = 0; n < 1000; ++n) still.step(tank);
  const double k = still.options.stiffness, g = 9.81, h = still.options.smoothing_length;
  const double level = 0.3 * (1 - g * 0.3 / (2 * k));
  // Least squares of log rho by height within the water.
  double n = 0, y_sum = 0, log_sum = 0, yy = 0, y_log = 0;
  for (std::size_t i = 0; i < still.fluid.size(); ++i) {
    const double x = still.fluid.x[i], y = still.fluid.y[i], z = still.fluid.z[i];
    if (x < h || x > 0.16 - h || z < h || z > 0.16 - h || y < h || y > level - h) continue;
    const double value = std::log(density_at(still, i));
    EXPECT_NEAR(value, g * (level - y) / k, 0.15 * g * 0.3 / k) << y;
    n += 1, y_sum += y, log_sum += value, yy += y * y, y_log += y * value;
  }
  const double slope = (n * y_log - y_sum * log_sum) / (n * yy - y_sum * y_sum);
  EXPECT_NEAR(slope, -g / k, 0.1 * g / k);
  const double at_middle = (log_sum - slope * y_sum) / n + slope * level / 2;
  EXPECT_NEAR(at_middle, g * level / (2 * k), 0.08 * g * 0.3 / k);
  // The centre of mass of water that is denser below: half of the level, less a twelfth of what is pressed together.
  const double centre = level / 2 - g * level * level / (12 * k);
  EXPECT_NEAR(2 * still.mean_height_rel(), 2 * centre / kSpacing, 0.25);
}

/// Two particles in the void, half a smoothing length apart along x.
Fluid pair_with(vec3 velocity, float h) {
  Fluid fluid;
  fluid.add({0.5f, 0.5f, 0.5f}, velocity);
  fluid.add({0.5f + h / 2, 0.5f, 0.5f}, -velocity);
  return fluid;
}

TEST(Sph, ViscositySlowsAPairByItsLaplacian) {
  FluidOptions options = kOptions;
  options.gravity = vec3{0.0f};
  options.surface_tension = 0;
  options.viscosity = 12;
  options.stiffness = 40;
  const float h = 2 * kSpacing, v = 0.01f;
  Case pair(options, pair_with({0, v, 0}, h));
  pair.step(BoxBoundary(box({1, 1, 1})));
  // dv_i/dt = mu m (v_j - v_i) / (rho_i rho_j) laplacian W                               [Muller2003] eq. 14
  const SphConstants c = sph_constants(pair.options);
  const double rho = c.per_lattice * double(formulas::spiky(0, h) + formulas::spiky(h / 2, h));
  const double rate = c.kinematic * c.volume * formulas::viscosity_laplacian(h / 2, h) / (rho * rho);
  ASSERT_LT(rho, 1.0);  // no pressure
  const double wanted = v * (1 - 2 * rate * pair.options.step);
  ASSERT_LT(wanted, 0.9 * v);
  EXPECT_NEAR(pair.fluid.vy[0], wanted, 1e-5 * v);
  EXPECT_NEAR(pair.fluid.vy[1], -wanted, 1e-5 * v);
  EXPECT_EQ(pair.fluid.vx[0], 0.0f);
}

TEST(Sph, PressureIsTheSlopeOfItsEnergy) {
  // Four particles in nearly one point are denser than water at rest: brute force of p_i / rho_i^2 + p_j / rho_j^2.
  FluidOptions options = kOptions;
  options.gravity = vec3{0.0f};
  options.surface_tension = 0;
  options.viscosity = 0;
  options.stiffness = 40;
  const float h = 2 * kSpacing;
  Fluid fluid;
  for (const vec3 at : {vec3{0, 0, 0}, vec3{0.2f, 0.1f, 0}, vec3{0, 0.25f, 0.1f}, vec3{0.1f, 0, 0.3f}})
    fluid.add(vec3{0.5f} + 0.8f * h * at, vec3{0.0f});
  Case knot(options, fluid);
  std::vector<double> pressure(fluid.size());
  for (std::size_t i = 0; i < fluid.size(); ++i) {
    const double rho = density_at(knot, i);
    ASSERT_GT(rho, 1.05);
    pressure[i] = double(knot.options.stiffness) * (rho - 1) / (rho * rho);
  }
  const double volume = std::pow(double(kSpacing), 3), dt = knot.options.step;
  std::vector<glm::dvec3> wanted(fluid.size(), glm::dvec3(0.0));
  for (std::size_t i = 0; i < fluid.size(); ++i)
    for (std::size_t j = 0; j < fluid.size(); ++j) {
      if (j == i) continue;
      const glm::dvec3 way =
          glm::dvec3(fluid.x[i], fluid.y[i], fluid.z[i]) - glm::dvec3(fluid.x[j], fluid.y[j], fluid.z[j]);
      const double r = glm::length(way), gap = double(h) - r;
      const double steep = 45 / (3.14159265358979 * std::pow(double(h), 6)) * gap * gap;  // [Muller2003] eq. 21
      wanted[i] += dt * volume * (pressure[i] + pressure[j]) * steep / r * way;
    }
  knot.step(BoxBoundary(box({1, 1, 1})));
  for (std::size_t i = 0; i < fluid.size(); ++i) {
    const glm::dvec3 found(knot.fluid.vx[i], knot.fluid.vy[i], knot.fluid.vz[i]);
    EXPECT_LT(glm::length(found - wanted[i]), 2e-4 * glm::length(wanted[i])) << i;
  }
}

}  // namespace
}  // namespace meniscus
