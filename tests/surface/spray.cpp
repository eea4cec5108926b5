// Entry spheres of spray: none where there is no surface, large enough where there is.
#include "surface/spray.h"

#include "surface/fixtures.h"
#include "surface/masses.h"

namespace meniscus {
namespace {

using namespace surface_tests;

/// Groups of 1 to `most` particles close together, far from each other.
Particles groups(int count, int most, std::uint64_t seed) {
  Particles particles;
  const Particles places = random_cloud(count, 60, seed);
  const Particles offsets = random_cloud(count * most, 1.6f, seed + 1);
  for (int i = 0; i < count; ++i)
    for (int k = 0; k <= i % most; ++k)
      add(particles,
          places.position(static_cast<std::size_t>(i)) + offsets.position(static_cast<std::size_t>(i * most + k)));
  return particles;
}

TEST(Spray, ThatCannotReachTheIsoValueNeverStartsAMarch) {
  RaycastOptions unit = options();
  unit.keep_thin = false;
  Particles lone;  // farther from each other than two smoothing lengths
  for (int z = 0; z < 6; ++z)
    for (int y = 0; y < 6; ++y)
      for (int x = 0; x < 6; ++x) add(lone, kSpacing * 5.0f * vec3(x, y, z));
  const View view = looking_at(lone.bounds(), {0.5f, 0.4f, 1}, Projection::perspective, 400, 300);
  const SurfaceBuffers without = make_raycast_surface(lone, unit)->see(view);
  const SurfaceBuffers with = make_raycast_surface(lone, options())->see(view);
  std::size_t entries = 0, hits = 0;
  for (std::size_t i = 0; i < without.entry.size(); ++i) {
    EXPECT_EQ(without.entry[i], kInfinity);
    entries += with.entry[i] < kInfinity;
    hits += with.depth[i] < kInfinity;
  }
  EXPECT_GT(hits, 300u);
  // Spheres of one spacing around drops of 0.62 would be 2.6 times as large in the picture.
  EXPECT_LT(static_cast<double>(entries), 2.0 * static_cast<double>(hits));
}

TEST(Spray, IsTheSameAsByThePlainMethodInGroupsOfAnySize) {
  for (const bool keep_thin : {false, true})
    for (const float iso : {0.4f, 0.5f, 0.6f}) {
      RaycastOptions with = options();
      with.keep_thin = keep_thin;
      with.iso = iso;
      with.refinement_steps = 6;  // spheres of other sizes start their samples elsewhere
      const Particles particles = groups(260, 9, 17);
      const View view = looking_at(particles.bounds(), {1, 0.3f, 0.6f}, Projection::orthographic, 700, 560);
      const Difference d = difference(make_plain_raycast_surface(particles, with)->see(view),
                                      make_raycast_surface(particles, with)->see(view));
      EXPECT_GT(d.hits, 500u) << keep_thin << " " << iso;
      EXPECT_LT(d.mismatch, 2e-4) << keep_thin << " " << iso << ": " << d;
      EXPECT_LT(d.depth_p99, 0.02) << keep_thin << " " << iso << ": " << d;
    }
}

TEST(Spray, LosesNoSurfaceThatItsSpheresHeldBefore) {
  const Particles particles = groups(120, 6, 29);
  for (const bool keep_thin : {false, true}) {
    RaycastOptions with = options();
    with.keep_thin = keep_thin;
    RaycastField field = make_field(particles, with, {}, Keep::band);
    const MassRule rule = mass_rule(field.options);
    const float volume = std::pow(field.options.spacing, 3.0f);
    const auto density = [&](vec3 at, auto mass) {
      float sum = 0;
      for (std::size_t j = 0; j < field.grid.size(); ++j)
        sum += mass(j) * volume *
               kernel_value(field.options.kernel, glm::length(at - field.grid.position(j)),
                            field.options.smoothing_length);
      return sum;
    };
    std::vector<float> masses(field.grid.size(), 1.0f);
    if (keep_thin)
      for (std::size_t j = 0; j < masses.size(); ++j)
        masses[j] = mass_at(rule, density(field.grid.position(j), [](std::size_t) { return 1.0f; }));
    if (keep_thin) find_masses(field);
    const std::vector<float> before(field.entry_radius.begin(), field.entry_radius.end());
    shrink_entries_of_spray(field);
    // Points along rays from each particle in a few directions.
    std::size_t inside = 0, shrunk = 0;
    for (std::size_t i = 0; i < field.grid.size(); ++i) {
      shrunk += field.entry_radius[i] < 0.99f * entry_radius_at(field.options, 1.0f);
      for (const vec3 direction : {vec3{1, 0, 0}, vec3{0, -1, 0}, vec3{0, 0, 1}, vec3{0.6f, 0.64f, -0.48f}})
        for (float d = 0; d < 1.4f * kSpacing; d += 0.1f * kSpacing) {
          const vec3 at = field.grid.position(i) + d * direction;
          if (density(at, [&](std::size_t j) { return masses[j]; }) < field.options.iso) continue;
          ++inside;
          bool was_covered = false, covered = false;
          for (std::size_t j = 0; j < field.grid.size(); ++j) {
            const float off = glm::length(at - field.grid.position(j));
            was_covered = was_covered || off <= before[j];
            covered = covered || off <= field.entry_radius[j];
          }
          EXPECT_EQ(covered, was_covered) << i;
        }
    }
    EXPECT_GT(inside, 200u);
    EXPECT_GT(shrunk, 10u);
  }
}

}  // namespace
}  // namespace meniscus
