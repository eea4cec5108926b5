// Water in slabs against the whole.
#include "surface/slab_surface.h"

#include "surface/fixtures.h"

namespace meniscus {
namespace {

using namespace surface_tests;

/// A long wavy tank with drops over it: 20 spacings deep and wide, 90 long.
Particles long_tank() {
  Random random(5);
  Particles result;
  for (int x = 0; x < 90; ++x)
    for (int z = 0; z < 24; ++z) {
      const int layers = 9 + static_cast<int>(std::lround(2.2f * std::sin(0.31f * static_cast<float>(x)) +
                                                          1.4f * std::cos(0.4f * static_cast<float>(z))));
      for (int y = 0; y < layers; ++y) add(result, kSpacing * (vec3{x, y, z} + random.in_cube(0.2f)));
    }
  for (int drop = 0; drop < 40; ++drop) {
    const vec3 centre{random.between(0, 90), random.between(14, 22), random.between(0, 24)};
    for (int i = 0; i < 1 + drop / 4; ++i)
      add(result, kSpacing * (centre + 0.6f * std::cbrt(static_cast<float>(drop / 4)) * random.in_cube(1.0f)));
  }
  return result;
}

void expect_same(const SurfaceBuffers& whole, const SurfaceBuffers& slabs, const std::string& what) {
  const Difference d = difference(whole, slabs);
  EXPECT_GT(d.hits, 500u) << what;
  EXPECT_LT(d.mismatch, 1e-4) << what << ": " << d;
  EXPECT_LT(d.depth_p99, 1e-3) << what << ": " << d;
  EXPECT_LT(d.normal_p99, 0.25) << what << ": " << d;
}

double sum_of(const Image<float>& image) {
  double sum = 0;
  for (const float value : image) sum += value;
  return sum;
}

TEST(SlabSurface, ShowsWhatTheWholeShows) {
  const Particles particles = long_tank();
  const RaycastOptions with = options();
  const auto whole = make_raycast_surface(particles, with);
  for (const int slabs : {1, 2, 5})
    for (const vec3 direction : {vec3{0.2f, 0.6f, 1}, vec3{1, 0.4f, 0.1f}, vec3{-0.1f, 1, 0.05f}})
      for (const Projection projection : kProjections) {
        const View view = looking_at(particles.bounds(), direction, projection, 180, 120);
        const SurfaceBuffers expected = whole->see(view);
        const SurfaceBuffers seen = make_slab_surface(particles, with, {}, slabs)->see(view);
        const std::string what = std::to_string(slabs) + " slabs, x " + std::to_string(direction.x);
        expect_same(expected, seen, what);
        EXPECT_NEAR(sum_of(seen.thickness), sum_of(expected.thickness), 0.01 * sum_of(expected.thickness)) << what;
      }
}

TEST(SlabSurface, SumsTheThicknessOfTheWhole) {
  // Deep water, whose inner cells are boxes: light that falls through it bends by the slopes of the thickness.
  Particles particles = lattice_box(120, 32, 30, 0.25f);
  add(particles, particles.bounds().low - kSpacing * vec3{0.7f, 2.4f, 1.2f});  // moves the cells
  const auto whole = make_raycast_surface(particles, options());
  for (const vec3 direction : {vec3{0.2f, 0.6f, 1}, vec3{0, 1, 0}, vec3{-1, 0.4f, 0.1f}})
    for (const Projection projection : kProjections) {
      const View view = looking_at(particles.bounds(), direction, projection, 150, 100);
      const Image<float> expected = whole->thickness(view);
      for (const int slabs : {1, 2, 5}) {
        const Image<float> sums = make_slab_surface(particles, options(), {}, slabs)->thickness(view);
        double squares = 0;
        for (std::size_t i = 0; i < sums.size(); ++i) squares += std::pow(double{sums[i]} - double{expected[i]}, 2);
        const double rms = std::sqrt(squares / static_cast<double>(sums.size()));
        // Along the cells' sides rays meet or miss the boxes of whole columns beside a cut.
        const double most = slabs == 1 ? 0 : direction.x == 0 ? 8e-3 : 4e-3;
        EXPECT_LE(rms, most * sum_of(expected) / static_cast<double>(sums.size()))
            << slabs << " slabs, x " << direction.x;
      }
    }
}

TEST(SlabSurface, SeesColoursAndPointsBetweenPixels) {
  const Particles particles = long_tank();
  std::vector<vec3> colours;
  for (std::size_t i = 0; i < particles.size(); ++i) colours.push_back({particles.x[i], particles.y[i], 0.5f});
  const View view = looking_at(particles.bounds(), {0.3f, 0.7f, 1}, Projection::perspective, 160, 100);
  const auto whole = make_raycast_surface(particles, options(), colours);
  const auto slabs = make_slab_surface(particles, options(), colours, 4);
  std::vector<vec2> points;
  for (int i = 0; i < 900; ++i)
    points.emplace_back(40.25f + static_cast<float>(i % 30) * 2.5f, 25.5f + static_cast<float>(i / 30) * 1.5f);
  const SurfaceBuffers expected = whole->refine(view, whole->see(view), points);
  const SurfaceBuffers seen = slabs->refine(view, slabs->see(view), points);
  const Difference d = difference(expected, seen);
  EXPECT_GT(d.hits, 300u);
  EXPECT_LT(d.mismatch, 2e-3) << d;
  EXPECT_LT(d.depth_p99, 1e-3) << d;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!(seen.depth[i] < kInfinity) || !(std::abs(seen.depth[i] - expected.depth[i]) < 1e-5f)) continue;
    EXPECT_NEAR(seen.colour[i].x, expected.colour[i].x, 1e-3f);
  }
  EXPECT_EQ(seen.thickness.size(), points.size());
}

TEST(SlabSurface, GivesTheSameBitsForAnyNumberOfThreads) {
  const Particles particles = long_tank();
  const View view = looking_at(particles.bounds(), {0.3f, 0.7f, 1}, Projection::perspective, 90, 60);
  SurfaceBuffers first;
  for (const int threads : {1, 2, 5}) {
    const ThreadLimit limit(threads);
    const SurfaceBuffers seen = make_slab_surface(particles, options(), {}, 3)->see(view);
    if (threads == 1) first = seen;
    EXPECT_TRUE(std::equal(seen.depth.begin(), seen.depth.end(), first.depth.begin()));
    EXPECT_TRUE(std::equal(seen.thickness.begin(), seen.thickness.end(), first.thickness.begin()));
  }
}

TEST(SlabSurface, TakesNoneAndOneParticleAndRefusesAnEyeInTheWater) {
  const View view = looking_at({{-1, -1, -1}, {1, 1, 1}}, {0, 0, 1}, Projection::perspective, 20, 20);
  const Particles none;
  EXPECT_EQ(sum_of(make_slab_surface(none, options(), {}, 3)->see(view).coverage), 0);
  Particles one;
  add(one, {0, 0, 0});
  EXPECT_NO_THROW(make_slab_surface(one, options(), {}, 3)->see(view));
  const Particles tank = long_tank();
  const vec3 inside = kSpacing * vec3{30, 4, 12};
  const View within = perspective_view(inside, inside + vec3{1, 0, 0}, {0, 1, 0}, 1.0f, 20, 20);
  EXPECT_THROW(make_slab_surface(tank, options(), {}, 3)->see(within), Error);
  EXPECT_THROW(make_slab_surface(tank, options(), {}, 0), Error);
}

TEST(SlabSurface, IsCutOnlyAsFarAsTheMemoryAsks) {
  const Bounds bounds{{0, 0, 0}, {2, 1, 2}};
  RaycastOptions with = options();
  with.spacing = 0.005f;
  const std::uint64_t count = 20'000'000, pixels = 1 << 16;
  const std::uint64_t whole = slab_bytes(1, count, bounds, with, pixels, false);
  EXPECT_EQ(slabs_within(whole, count, bounds, with, pixels, false), 1);
  const int some = slabs_within(whole / 2, count, bounds, with, pixels, false);
  EXPECT_GT(some, 1);
  EXPECT_LE(slab_bytes(some, count, bounds, with, pixels, false), whole / 2);
  EXPECT_EQ(slabs_within(1000, count, bounds, with, pixels, false), 0);
}

}  // namespace
}  // namespace meniscus
