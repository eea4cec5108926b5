// Cameras in the water and clouds that are hardly water: nothing may break.
#include "surface/fixtures.h"

namespace meniscus {
namespace {

using namespace surface_tests;

TEST(EyeInWater, SeesTheInsideOfABallAtTheRightDistance) {
  const Particles particles = lattice_ball(8);
  const float expected = radius_of_volume(particles.size());
  for (const bool fast : {true, false}) {
    const auto surface =
        fast ? make_raycast_surface(particles, options()) : make_plain_raycast_surface(particles, options());
    for (const vec3 direction : {vec3{1, 0, 0}, vec3{0, 0, -1}, vec3{-1, 1, 1}}) {
      const View view = perspective_view({0, 0, 0}, direction, {0, 0.3f, 1}, 1.4f, 48, 40);
      const SurfaceBuffers seen = surface->see(view);
      EXPECT_TRUE(seen.eye_in_water);
      expect_consistent(seen);
      EXPECT_EQ(hits(seen), seen.depth.size());  // every way leads out
      double mean = 0;
      for_each_hit(view, seen, [&](int x, int y, const Ray& ray, vec3) {
        mean += seen.depth(x, y) / static_cast<double>(seen.depth.size());
        EXPECT_NEAR(seen.depth(x, y), expected, 0.7f * kSpacing);
        EXPECT_GT(glm::dot(seen.normal(x, y), ray.direction), 0.7f);  // out of the water is away from the eye
      });
      EXPECT_NEAR(mean, expected, 0.15f * kSpacing);
    }
  }
}

TEST(EyeInWater, AnywhereAboutATankShowsNoGarbage) {
  const Particles particles = wavy_tank();
  const auto fast = make_raycast_surface(particles, options()),
             plain = make_plain_raycast_surface(particles, options());
  Random random(111);
  int inside = 0;
  for (int i = 0; i < 30; ++i) {
    const vec3 eye = particles.position(random.bits() % particles.size()) + 0.6f * kSpacing * random.in_cube(1);
    const View view = perspective_view(eye, eye + random.direction(), {0, 0, 1}, 1.2f, 40, 30);
    const SurfaceBuffers seen = fast->see(view);
    expect_consistent(seen);
    const SurfaceBuffers reference = plain->see(view);
    expect_consistent(reference);
    EXPECT_EQ(seen.eye_in_water, reference.eye_in_water);
    inside += seen.eye_in_water;
    const Difference d = difference(reference, seen);
    EXPECT_LT(d.mismatch, 5e-3) << d;
    EXPECT_LT(d.depth_p99, 0.05) << d;
  }
  EXPECT_GT(inside, 10);
  EXPECT_LT(inside, 30);
}

TEST(EyeInABubble, SeesTheBubblesWall) {
  // A hollow in the midst of well filled cells: the eye is not in water, and the wall is close.
  Particles particles;
  const Particles box = lattice_box(40, 40, 40);
  for (std::size_t i = 0; i < box.size(); ++i)
    if (glm::length(box.position(i)) > 2.2f * kSpacing) add(particles, box.position(i));
  const View view = perspective_view({0, 0, 0}, {1, 0.2f, 0.1f}, {0, 0, 1}, 1.2f, 48, 36);
  const SurfaceBuffers seen = make_raycast_surface(particles, options())->see(view);
  EXPECT_FALSE(seen.eye_in_water);
  expect_consistent(seen);
  EXPECT_EQ(hits(seen), seen.depth.size());
  for (const float depth : seen.depth) {
    EXPECT_GT(depth, 1.0f * kSpacing);
    EXPECT_LT(depth, 2.6f * kSpacing);
  }
}

TEST(ParallelRays, ThatStartInTheWaterMeetItAtOnce) {
  const Particles particles = lattice_box(40, 40, 40);
  for (const bool cull : {true, false}) {
    RaycastOptions with = options();
    with.cull_interior = cull;
    const View view = orthographic_view({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 10 * kSpacing, 40, 40);
    const SurfaceBuffers seen = make_raycast_surface(particles, with)->see(view);
    expect_consistent(seen);
    for (const float depth : seen.depth) EXPECT_EQ(depth, 0.0f) << cull;
    // The face that the plane cuts is flat.
    for (const vec3 normal : seen.normal) EXPECT_GT(normal.z, 0.999f) << cull;
  }
}

class Degenerate : public testing::TestWithParam<int> {};

Particles degenerate(int which) {
  Particles particles;
  switch (which) {
    case 0:
      break;
    case 1:
      add(particles, {1, 2, 3});
      break;
    case 2:
      add(particles, {1, 2, 3}), add(particles, {1.02f, 2, 3});
      break;
    case 3:
      for (int i = 0; i < 1000; ++i) add(particles, {0.5f, 0.5f, 0.5f});
      break;
    case 4:
      particles = lattice_box(20, 20, 1);
      break;
    case 5:
      for (int i = 0; i < 50; ++i) add(particles, vec3{0, 0.7f * static_cast<float>(i) * kSpacing, 0});
      break;
    case 6:
      for (int i = 0; i < 50; ++i)
        add(particles, vec3{static_cast<float>(i), static_cast<float>(i), 2.0f * static_cast<float>(i)});
      break;
    case 7:
      particles = surface_tests::moved(lattice_box(10, 10, 10, 0.2f), [](vec3 p) {
        return p + 1e4f * kSpacing * vec3{1, -1, 1};
      });
      break;
    case 8:
      for (int i = 0; i < 200; ++i) add(particles, i % 2 == 0 ? vec3{0} : vec3{0.3f * kSpacing, 0, 0});
      break;
  }
  return particles;
}

TEST_P(Degenerate, CloudsGiveFiniteBuffers) {
  const Particles particles = degenerate(GetParam());
  const Bounds box = particles.empty() ? Bounds{vec3{0}, vec3{1}} : particles.bounds().grown(2 * kSpacing);
  std::vector<vec3> colours(particles.size(), vec3{0.2f, 0.4f, 0.6f});
  for (const Projection projection : kProjections)
    for (const Kernel kernel : kKernels)
      for (const vec3 direction : {vec3{1, 0, 0}, vec3{0.3f, 0.5f, 1}}) {
        RaycastOptions with = options();
        with.kernel = kernel;
        const auto fast = make_raycast_surface(particles, with, colours),
                   plain = make_plain_raycast_surface(particles, with, colours);
        const View view = looking_at(box, direction, projection, 66, 50);
        const SurfaceBuffers seen = fast->see(view), reference = plain->see(view);
        expect_consistent(seen);
        expect_consistent(reference);
        const Difference d = difference(reference, seen);
        EXPECT_LE(d.mismatch * static_cast<double>(seen.depth.size()), 4.0) << d;
        // A picture from the midst of the particles, too.
        if (particles.empty()) {
          EXPECT_EQ(hits(seen), 0u);
          EXPECT_TRUE(fast->bounds().empty());
          continue;
        }
        const vec3 eye = particles.position(0) + vec3{0.01f * kSpacing};
        expect_consistent(fast->see(perspective_view(eye, eye + direction, {0, 0, 1}, 1.0f, 32, 32)));
        EXPECT_EQ(std::isfinite(glm::length(fast->bounds().extent())), true);
      }
}

INSTANTIATE_TEST_SUITE_P(Surface, Degenerate, testing::Range(0, 9));

TEST(FarFromTheOrigin, ABoxIsStillABox) {
  // Floats are a thousandth of a spacing apart there.
  const vec3 shift = 1e4f * kSpacing * vec3{1, -1, 1};
  const Particles near = lattice_box(12, 12, 12), far = surface_tests::moved(near, [&](vec3 p) { return p + shift; });
  View view = looking_at(near.bounds(), {1, 0.5f, 0.7f}, Projection::perspective, 80, 60);
  const SurfaceBuffers before = make_raycast_surface(near, options())->see(view);
  view.eye = view.eye + shift;
  const SurfaceBuffers after = make_raycast_surface(far, options())->see(view);
  const Difference d = difference(before, after);
  EXPECT_LT(d.mismatch, 0.01) << d;
  EXPECT_LT(d.depth_p99, 0.05) << d;
  EXPECT_LT(d.normal_mean, 0.5) << d;
}

}  // namespace
}  // namespace meniscus
