#include "fixtures.h"
#include "meniscus/formulas/kernels.h"

namespace meniscus::surface_tests {
namespace {

DensityOptions density_options(Kernel kernel = Kernel::wyvill) {
  DensityOptions result;
  result.spacing = kSpacing;
  result.kernel = kernel;
  return result;
}

/// A grid around the particles and as far as a kernel reaches, with unequal steps.
DensityGrid grid_around(const Particles& particles, int nx, int ny, int nz) {
  const Bounds box = particles.bounds().grown(2.1f * kSpacing);
  return {box.low, box.extent() / vec3{nx - 1, ny - 1, nz - 1}, nx, ny, nz};
}

/// RMS of the difference over the RMS of the density.
double relative_difference(const std::vector<float>& fast, const std::vector<double>& plain) {
  double error = 0, size = 0;
  for (std::size_t i = 0; i < plain.size(); ++i) {
    error += std::pow(fast[i] - plain[i], 2);
    size += plain[i] * plain[i];
  }
  return std::sqrt(error / size);
}

TEST(Density, SplattedDiscsAddUpToThePlainSum) {
  for (const Kernel kernel : kKernels)
    for (const bool keep_thin : {true, false}) {
      const Particles water = wavy_tank();
      DensityOptions options = density_options(kernel);
      options.keep_thin = keep_thin;
      // Rows of less than a vector, of more, and planes that do not fill a slab.
      for (const auto& n : {glm::ivec3{37, 41, 23}, glm::ivec3{7, 90, 10}, glm::ivec3{130, 9, 14}}) {
        const DensityGrid grid = grid_around(water, n.x, n.y, n.z);
        EXPECT_LT(relative_difference(splat_density(water, options, grid), plain_density(water, options, grid)), 2e-6)
            << name_of(kernel) << " " << n.x;
      }
    }
}

TEST(Density, PlainSumIsTheKernelOfALoneParticle) {
  Particles one;
  add(one, vec3{0.013f, -0.02f, 0.004f});
  for (const Kernel kernel : kKernels) {
    DensityOptions options = density_options(kernel);
    options.keep_thin = false;
    const DensityGrid grid{vec3{-0.12f}, vec3{0.02f}, 13, 13, 13};
    const std::vector<double> density = plain_density(one, options, grid);
    const double volume = std::pow(kSpacing, 3);
    for (int k = 0; k < 13; ++k)
      for (int j = 0; j < 13; ++j)
        for (int i = 0; i < 13; ++i) {
          const float r = glm::length(grid.low + vec3{i, j, k} * grid.step - one.position(0));
          const float h = 2 * kSpacing;
          const double expected = volume * (kernel == Kernel::wyvill         ? formulas::wyvill(r, h)
                                            : kernel == Kernel::cubic_spline ? formulas::cubic_spline(r, h)
                                                                             : formulas::poly6(r, h));
          EXPECT_NEAR(density[static_cast<std::size_t>((k * 13 + j) * 13 + i)], expected, 2e-6);
        }
  }
}

TEST(Density, ALatticeHasDensityOne) {
  const Particles lattice = lattice_box(12, 12, 12);
  const DensityGrid grid{vec3{-1.5f * kSpacing}, vec3{kSpacing / 5.0f}, 16, 16, 16};
  // The kernels of this support miss one by less than a hundredth or so on a lattice.
  for (const float density : splat_density(lattice, density_options(), grid)) EXPECT_NEAR(density, 1.0f, 0.03f);
}

TEST(Density, IntegratesToTheVolumeOfTheParticles) {
  DensityOptions options = density_options();
  options.keep_thin = false;
  const Particles cloud = random_cloud(500, 10, 5);
  const DensityGrid grid = grid_around(cloud, 80, 80, 80);
  double sum = 0;
  for (const float density : splat_density(cloud, options, grid)) sum += density;
  const double cell = static_cast<double>(grid.step.x) * grid.step.y * grid.step.z;
  EXPECT_NEAR(sum * cell / (500 * std::pow(kSpacing, 3)), 1.0, 1e-3);
}

TEST(Density, SlabsComeInOrderAndMakeTheWholeField) {
  const Particles water = wavy_tank();
  const DensityGrid grid = grid_around(water, 33, 35, 30);
  const std::vector<float> whole = splat_density(water, density_options(), grid);
  int next = 0;
  std::size_t bytes = 0;
  splat_density(
      water, density_options(), grid,
      [&](int k, int planes, std::span<const float> values) {
        EXPECT_EQ(k, next);
        EXPECT_EQ(planes, std::min(4, 30 - k));
        ASSERT_EQ(values.size(), static_cast<std::size_t>(planes) * 33 * 35);
        EXPECT_EQ(std::memcmp(values.data(), whole.data() + static_cast<std::size_t>(k) * 33 * 35,
                              values.size() * sizeof(float)),
                  0);
        next += 4;
      },
      nullptr, &bytes);
  EXPECT_EQ(next, 32);
  EXPECT_GE(bytes, sizeof(float) * 4 * 33 * 35);
  EXPECT_LT(bytes, sizeof(float) * 4 * 33 * 35 + 100 * water.size() + 100'000);
}

TEST(Density, HasTheSameBitsForAnyNumberOfThreads) {
  const Particles water = wavy_tank();
  const DensityGrid grid = grid_around(water, 50, 60, 40);
  std::vector<float> first;
  for (const int threads : {1, 2, 5}) {
    const ThreadLimit limit(threads);
    const std::vector<float> density = splat_density(water, density_options(), grid);
    if (first.empty()) first = density;
    EXPECT_EQ(std::memcmp(first.data(), density.data(), density.size() * sizeof(float)), 0) << threads;
  }
}

TEST(Density, IsTheSameForEveryInstructionSet) {
  const Particles water = wavy_tank();
  const DensityGrid grid = grid_around(water, 61, 40, 21);
  const std::vector<double> plain = plain_density(water, density_options(), grid);
  for (const std::string& name : instruction_sets()) {
    use_instruction_set(name);
    EXPECT_LT(relative_difference(splat_density(water, density_options(), grid), plain), 2e-6) << name;
  }
  use_instruction_set("best");
}

TEST(Density, KeepsItsDigitsFarFromTheOrigin) {
  const vec3 away{1000.0f, -2000.0f, 500.0f};
  const Particles water = moved(wavy_tank(), [&](vec3 p) { return p + away; });
  const DensityGrid grid = grid_around(water, 40, 40, 40);
  EXPECT_LT(
      relative_difference(splat_density(water, density_options(), grid), plain_density(water, density_options(), grid)),
      3e-3);  // a coordinate of 2000 m in float has steps of 0.12 mm: 1/400 spacing
}

TEST(Density, NoParticlesHaveNoDensity) {
  const DensityGrid grid{vec3{0}, vec3{0.1f}, 4, 5, 6};
  for (const float density : splat_density(Particles{}, density_options(), grid)) EXPECT_EQ(density, 0.0f);
}

TEST(Density, RefusesGridsThatCannotBeMeant) {
  const Particles one = lattice_box(1, 1, 1);
  const auto code = [&](DensityGrid grid) {
    try {
      splat_density(one, density_options(), grid, [](int, int, std::span<const float>) {});
    } catch (const Error& error) {
      return static_cast<int>(error.code());
    }
    return -1;
  };
  const int invalid = static_cast<int>(ErrorCode::invalid_argument);
  EXPECT_EQ(code({vec3{0}, vec3{0.1f}, 1, 5, 6}), invalid);
  EXPECT_EQ(code({vec3{0}, vec3{0.1f}, 5, 5, -6}), invalid);
  EXPECT_EQ(code({vec3{0}, vec3{0.1f, 0, 0.1f}, 5, 5, 6}), invalid);
  EXPECT_EQ(code({vec3{0}, vec3{0.1f, kInfinity, 0.1f}, 5, 5, 6}), invalid);
  EXPECT_EQ(code({vec3{std::nanf("")}, vec3{0.1f}, 5, 5, 6}), invalid);
  EXPECT_EQ(code({vec3{0}, vec3{0.1f}, 100'000, 100'000, 6}), static_cast<int>(ErrorCode::limit_exceeded));
}

}  // namespace
}  // namespace meniscus::surface_tests
