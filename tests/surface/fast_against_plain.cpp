// The vectorised surface against the plain one: two ways to one picture.
#include "surface/fixtures.h"

namespace meniscus {
namespace {

using namespace surface_tests;

Difference fast_against_plain(const Particles& particles, const RaycastOptions& with, const View& view) {
  const SurfaceBuffers fast = make_raycast_surface(particles, with)->see(view);
  const SurfaceBuffers plain = make_plain_raycast_surface(particles, with)->see(view);
  expect_consistent(fast);
  expect_consistent(plain);
  EXPECT_EQ(fast.eye_in_water, plain.eye_in_water);
  return difference(plain, fast);
}

void expect_same_picture(const Difference& d, const std::string& what, std::size_t least_hits = 500) {
  EXPECT_GT(d.hits, least_hits) << what;
  EXPECT_LT(d.mismatch, 1e-3) << what << ": " << d;
  EXPECT_LT(d.depth_p99, 0.01) << what << ": " << d;
  EXPECT_LT(d.normal_mean, 0.5) << what << ": " << d;
}

TEST(FastAgainstPlain, AgreesOnAWavyTankForEveryKernelAndRefinement) {
  const Particles particles = wavy_tank();
  int n = 0;
  for (const Kernel kernel : kKernels)
    for (const Refinement refinement : {Refinement::secant, Refinement::bisection})
      for (const float iso : {0.35f, 0.5f, 0.65f}) {
        RaycastOptions with = options();
        with.kernel = kernel;
        with.refinement = refinement;
        with.refinement_steps = refinement == Refinement::bisection ? 6 : 2;
        with.iso = iso;
        with.filter_radius = 2;
        const View view = looking_at(particles.bounds(), {1, 0.5f, 0.9f}, kProjections[n++ % 2], 90, 70);
        expect_same_picture(fast_against_plain(particles, with, view),
                            surface_tests::name_of(kernel) + (" iso " + std::to_string(iso)));
      }
}

TEST(FastAgainstPlain, AgreesForOtherLengthsStepsAndNormals) {
  const Particles particles = wavy_tank(4);
  const View view = looking_at(particles.bounds(), {-0.3f, 1, 0.6f}, Projection::perspective, 75, 61);
  RaycastOptions with = options();
  with.smoothing_length = 1.5f * kSpacing;
  expect_same_picture(fast_against_plain(particles, with, view), "short smoothing length");
  with.smoothing_length = 3 * kSpacing;
  with.normal_radius = 2 * kSpacing;
  with.normals = NormalMethod::gradient;
  expect_same_picture(fast_against_plain(particles, with, view), "long smoothing length");
  with = options();
  with.step = 0.1f;
  with.normals = NormalMethod::pca;
  with.filter_radius = 0;
  expect_same_picture(fast_against_plain(particles, with, view), "short step");
  with = options();
  with.keep_thin = false;
  with.filter_radius = 1;
  expect_same_picture(fast_against_plain(particles, with, view), "unit masses");
}

TEST(FastAgainstPlain, AgreesOnParticlesThrownAtRandom) {
  for (const std::uint64_t seed : {11ull, 12ull, 13ull}) {
    const Particles particles = random_cloud(5000, 15, seed);  // about 1.5 a cubic spacing: dense, with voids
    const View view = looking_at(particles.bounds(), {0.4f, 0.7f, 0.5f}, kProjections[seed % 2], 80, 64);
    expect_same_picture(fast_against_plain(particles, options(), view), "random cloud " + std::to_string(seed));
  }
}

TEST(FastAgainstPlain, AgreesOnClumps) {
  for (const std::uint64_t seed : {21ull, 22ull, 23ull}) {
    const Particles particles = clumped_cloud(4000, 16, seed);
    const View view = looking_at(particles.bounds(), {-0.6f, 0.2f, 0.5f}, kProjections[seed % 2], 80, 64);
    expect_same_picture(fast_against_plain(particles, options(), view), "clumped cloud " + std::to_string(seed));
  }
}

TEST(FastAgainstPlain, AgreesOnSprayThatIsMuchWiderThanItsParticles) {
  const Particles particles = random_cloud(600, 3000, 31);
  Bounds near;
  for (std::size_t i = 0; i < 3; ++i) near.add(particles.position(i));
  Particles with_clumps = particles;
  for (std::size_t i = 0; i < 30; ++i) add(with_clumps, particles.position(i) + vec3{0.6f * kSpacing, 0, 0});
  Bounds drop;
  drop.add(particles.position(0));
  const View close = looking_at(drop.grown(2 * kSpacing), {1, 1, 1}, Projection::perspective, 64, 64);
  expect_same_picture(fast_against_plain(with_clumps, options(), close), "close to a drop", 100);
  const View far = looking_at(particles.bounds(), {1, 1, 1}, Projection::perspective, 640, 480);
  const Difference d = fast_against_plain(with_clumps, options(), far);
  EXPECT_LT(d.mismatch, 1e-4) << d;
}

TEST(CullInterior, LeavesThePictureAsItIs) {
  const Particles clouds[] = {wavy_tank(), lattice_box(18, 16, 14), random_cloud(6000, 16, 41),
                              clumped_cloud(5000, 14, 42)};
  for (const Particles& particles : clouds)
    for (const Projection projection : kProjections) {
      RaycastOptions culled = options(), whole = options();
      whole.cull_interior = false;
      const View view = looking_at(particles.bounds(), {0.5f, -0.7f, 0.8f}, projection, 160, 120);
      const Difference d = difference(make_raycast_surface(particles, whole)->see(view),
                                      make_raycast_surface(particles, culled)->see(view));
      EXPECT_LT(d.mismatch, 2e-4) << d;
      EXPECT_LT(d.depth_p99, 0.01) << d;
      EXPECT_LT(d.normal_mean, 0.2) << d;
    }
}

TEST(CullInterior, SeesWhatLiesBehindGapsThatCountsOfParticlesDoNotShow) {
  // Three particles in one point of each cell of the grid would fill it well by their number, yet parallel rays run
  // between such clumps. Amidst them clumps stand in those rays' way.
  Particles particles;
  add(particles, 0.5f * kSpacing * vec3{1, 1, 1});  // so that the others stand in the middles of cells of two spacings
  constexpr int kCells = 9;
  for (int z = 0; z < kCells; ++z)
    for (int y = 0; y < kCells; ++y)
      for (int x = 0; x < kCells; ++x) {
        const bool amidst = std::min({x, y, z}) >= 2 && std::max({x, y, z}) <= kCells - 3;
        const vec3 at = 2.0f * vec3{x, y, z} + vec3{1, 1, 1} + (amidst ? vec3{0.9f, 0.9f, 0} : vec3{0});
        for (int i = 0; i < 3; ++i) add(particles, kSpacing * at);
      }
  RaycastOptions culled = options(), whole = options();
  whole.cull_interior = false;
  const View view =
      orthographic_view(kSpacing * vec3{9, 9, 40}, kSpacing * vec3{9, 9, 0}, {0, 1, 0}, 18 * kSpacing, 180, 180);
  const SurfaceBuffers a = make_raycast_surface(particles, culled)->see(view),
                       b = make_raycast_surface(particles, whole)->see(view);
  int amidst = 0;
  for_each_hit(view, b, [&](int, int, const Ray&, vec3 point) { amidst += point.z < (2 * kCells - 3) * kSpacing; });
  EXPECT_GT(amidst, 100);
  const Difference d = difference(b, a);
  EXPECT_EQ(d.mismatch, 0.0) << d;
  EXPECT_LT(d.depth_p99, 0.01) << d;
}

TEST(CullInterior, LosesNoWaterFromAnyDirection) {
  Random random(51);
  std::size_t lost = 0, seen = 0, late = 0;
  for (int i = 0; i < 12; ++i) {
    const Particles particles = i % 3 == 0   ? clumped_cloud(4000, random.between(9, 20), random.bits())
                                : i % 3 == 1 ? random_cloud(5000, random.between(10, 18), random.bits())
                                             : lattice_ball(random.between(5, 9), random.between(0, 0.3f));
    RaycastOptions culled = options(), whole = options();
    culled.want_normals = whole.want_normals = culled.want_thickness = whole.want_thickness = false;
    whole.cull_interior = false;
    const auto with = make_raycast_surface(particles, culled), without = make_raycast_surface(particles, whole);
    for (int j = 0; j < 3; ++j) {
      const View view = looking_at(particles.bounds(), random.direction(), kProjections[j % 2], 96, 96);
      const SurfaceBuffers a = with->see(view), b = without->see(view);
      for (std::size_t p = 0; p < b.depth.size(); ++p) {
        if (!(b.depth[p] < kInfinity)) continue;
        ++seen;
        lost += !(a.depth[p] < kInfinity);
        late += a.depth[p] > b.depth[p] + 0.5f * kSpacing;
      }
    }
  }
  EXPECT_GT(seen, 50'000u);
  EXPECT_LT(static_cast<double>(lost) / static_cast<double>(seen), 1e-4) << lost << " of " << seen;
  EXPECT_LT(static_cast<double>(late) / static_cast<double>(seen), 3e-4) << late << " of " << seen;
}

}  // namespace
}  // namespace meniscus
