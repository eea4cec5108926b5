// Masses and entry radii against sums over all pairs of particles.
#include "surface/masses.h"

#include <gtest/gtest.h>

#include "particles/clouds.h"

namespace meniscus {
namespace {

using namespace clouds;

struct Compared {
  std::size_t looked_at = 0;
  std::size_t other_mass = 0;
  float worst_mass = 0;
  float worst_radius = 0;  ///< spacings by which a radius is too small
};

/// The masses of particles in open cells; spacing 1.
Compared compare(const Particles& particles, Kernel kernel = Kernel::cubic_spline, float h = 2.0f) {
  RaycastOptions options;
  options.spacing = 1.0f;
  options.kernel = kernel;
  options.smoothing_length = h;
  RaycastField field = make_field(particles, options, {}, Keep::band);
  find_masses(field);
  const MassRule rule = mass_rule(field.options);
  const BandGrid& grid = field.grid;
  Compared result;
  for (int block = 0; block < grid.blocks(); ++block)
    for (int cell = 0; cell < BandGrid::kCells; ++cell) {
      if (grid.kinds(block)[cell] != BandGrid::open) continue;
      const BandGrid::Run run = grid.run(block, cell);
      for (std::size_t i = run.begin; i < run.end; ++i) {
        double density = 0;
        for (std::size_t j = 0; j < particles.size(); ++j) {
          const vec3 off = particles.position(j) - grid.position(i);
          const float r = std::sqrt(off.x * off.x + off.y * off.y + off.z * off.z);
          if (r < h) density += static_cast<double>(kernel_value(kernel, r, h));
        }
        const auto exact = static_cast<float>(density);
        const float off = std::abs(field.mass[i] - mass_at(rule, exact));
        ++result.looked_at;
        result.other_mass += off > 1e-3f;
        result.worst_mass = std::max(result.worst_mass, off);
        result.worst_radius =
            std::max(result.worst_radius, entry_radius_at(field.options, exact) - field.entry_radius[i]);
      }
    }
  return result;
}

TEST(Masses, AreExactInLoneDropsJetsAndSheets) {
  const Particles clouds[] = {spray(300, {-9, -9, -9}, {9, 9, 9}),
                              cubic(2, 2, 2),
                              cubic(24, 24, 1, 0.2),
                              cubic(24, 24, 2, 0.2),
                              cubic(24, 24, 3, 0.2),
                              tilted_sheet(24, 1),
                              tilted_sheet(24, 2, 0.2),
                              cylinder(6, 12, 2)};
  int n = 0;
  for (const Particles& cloud : clouds) {
    const Compared found = compare(cloud);
    EXPECT_GT(found.looked_at, 0u) << n;
    EXPECT_EQ(found.other_mass, 0u) << n;
    EXPECT_LT(found.worst_radius, 1e-3f) << n;
    ++n;
  }
}

TEST(Masses, AreExactAtTheSurfaceOfDeepWater) {
  int n = 0;
  for (const Particles& water : {cubic(20, 20, 20), cubic(19, 20, 18, 0.2), cubic(19, 20, 18, 0.4),
                                 flip_seeds(9, 10, 9), face_centred(9), pairs(14)}) {
    const Compared found = compare(water);
    EXPECT_GT(found.looked_at, 100u) << n;
    EXPECT_EQ(found.other_mass, 0u) << n << ", by up to " << found.worst_mass;
    EXPECT_LT(found.worst_radius, 0.1f) << n;
    ++n;
  }
}

TEST(Masses, AreExactForEveryKernelAndSmoothingLength) {
  for (const Kernel kernel : {Kernel::cubic_spline, Kernel::poly6, Kernel::wyvill})
    for (const float h : {1.5f, 2.0f, 3.0f})
      for (const Particles& water : {tilted_sheet(14, 1, 0.2), joined(cubic(14, 12, 13, 0.3), drops(2))}) {
        const Compared found = compare(water, kernel, h);
        EXPECT_GT(found.looked_at, 100u) << h;
        EXPECT_EQ(found.other_mass, 0u) << h << ", by up to " << found.worst_mass;
        EXPECT_LT(found.worst_radius, 1e-3f) << h;
      }
}

TEST(Masses, AreTheSameForAnyNumberOfThreads) {
  const Particles water = joined(cubic(30, 20, 24, 0.3), spray(200, {-30, 25, -30}, {50, 45, 50}));
  RaycastOptions options;
  options.spacing = 1.0f;
  std::vector<RaycastField> fields;
  for (const int threads : {1, 2, 5}) {
    const ThreadLimit limit(threads);
    fields.push_back(make_field(water, options, {}, Keep::band));
    find_masses(fields.back());
    EXPECT_EQ(fields.back().mass, fields[0].mass);
    EXPECT_EQ(fields.back().entry_radius, fields[0].entry_radius);
  }
}

}  // namespace
}  // namespace meniscus
