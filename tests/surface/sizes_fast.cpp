// The vectorised surface of particles of different sizes against the plain one.
#include <array>

#include "surface/sized_clouds.h"

namespace meniscus {
namespace {

using namespace surface_tests;

/// Pools of fine and coarse particles side by side, deep enough to have a midst, with drops of all sizes over them.
Cloud pools(float ratio, float jitter = 0.15f) {
  Cloud cloud;
  Random random(8);
  const float fine = 0.03f, coarse = ratio * fine;
  cloud.fill({-0.6f, -0.5f, 0}, {0, 0.5f, 0.5f}, fine, jitter, random);
  cloud.fill({0, -0.5f, 0}, {0.8f, 0.5f, 0.55f}, coarse, jitter, random);
  for (int drop = 0; drop < 25; ++drop) {
    const vec3 centre = vec3{0, 0, 0.8f} + random.in_cube(1) * vec3{0.6f, 0.5f, 0.2f};
    const float s = random.between(fine, coarse);
    for (int i = 0; i < 1 + drop; ++i)
      cloud.put(centre + random.in_cube(0.4f * s * std::cbrt(static_cast<float>(1 + drop))),
                s * random.between(0.9f, 1));
  }
  return cloud;
}

RaycastOptions fine_options() { return options(0.03f); }

TEST(SizesFastAgainstPlain, AgreesOnPoolsOfTwoResolutions) {
  for (int n = 0; n < 3; ++n) {
    const float ratio = std::array{1.5f, 3.0f, 6.0f}[static_cast<std::size_t>(n)];
    const Cloud cloud = pools(ratio);
    RaycastOptions with = fine_options();
    with.kernel = kKernels[n];
    with.keep_thin = n != 1;
    const vec3 from[] = {{1, 0.5f, 0.9f}, {-0.7f, 1, 0.4f}, {0.2f, -0.3f, 1}};
    const View view = looking_at(cloud.particles.bounds(), from[n], kProjections[n % 2], 84, 64);
    const SurfaceBuffers plain =
        make_plain_raycast_surface(cloud.particles, with, {}, nullptr, cloud.sizes())->see(view);
    const SurfaceBuffers fast = make_raycast_surface(cloud.particles, with, {}, nullptr, cloud.sizes())->see(view);
    expect_consistent(fast);
    const Difference d = difference(plain, fast, 0.03f);
    EXPECT_GT(d.hits, 900u);
    EXPECT_LT(d.mismatch, 1e-3) << ratio << " " << n << ": " << d;
    EXPECT_LT(d.depth_p99, 0.01) << ratio << " " << n << ": " << d;
    EXPECT_LT(d.normal_p99, 0.5) << ratio << " " << n << ": " << d;
  }
}

TEST(SizesFastAgainstPlain, LosesNoWaterByLeavingTheMidstOut) {
  for (const float ratio : {1.7f, 3.0f}) {
    const Cloud cloud = pools(ratio);
    RaycastOptions culled = fine_options(), whole = fine_options();
    culled.want_thickness = whole.want_thickness = false;
    whole.cull_interior = false;
    for (const Projection projection : kProjections) {
      const View view = looking_at(cloud.particles.bounds(), {0.5f, -0.7f, 0.6f}, projection, 150, 110);
      const Difference d =
          difference(make_raycast_surface(cloud.particles, whole, {}, nullptr, cloud.sizes())->see(view),
                     make_raycast_surface(cloud.particles, culled, {}, nullptr, cloud.sizes())->see(view), 0.03f);
      EXPECT_LT(d.mismatch, 2e-4) << d;
      EXPECT_LT(d.depth_p99, 0.01) << d;
      EXPECT_LT(d.normal_mean, 0.2) << d;
    }
  }
}

TEST(SizesFast, GivesTheSameBitsForAnyNumberOfThreads) {
  const Cloud cloud = pools(3);
  const View view = looking_at(cloud.particles.bounds(), {1, 0.5f, 0.9f}, Projection::perspective, 90, 70);
  const auto see = [&](int threads) {
    const ThreadLimit limit(threads);
    return make_raycast_surface(cloud.particles, fine_options(), {}, nullptr, cloud.sizes())->see(view);
  };
  const SurfaceBuffers one = see(1);
  EXPECT_TRUE(same_bits(one, see(2)));
  EXPECT_TRUE(same_bits(one, see(5)));
}

TEST(SizesFast, KnowsAnEyeInTheWaterOfAnySize) {
  const Cloud cloud = pools(3);
  const auto surface = make_raycast_surface(cloud.particles, fine_options(), {}, nullptr, cloud.sizes());
  for (const float x : {-0.3f, 0.4f}) {
    const View below = perspective_view({x, 0, 0.3f}, {x + 0.1f, 0, 1}, {0, 1, 0}, 0.6f, 24, 24);
    const SurfaceBuffers seen = surface->see(below);
    EXPECT_TRUE(seen.eye_in_water) << x;
    EXPECT_NEAR(seen.depth(12, 12), 0.23f, 0.06f) << x;
    const View above = perspective_view({x, 0, 1.3f}, {x + 0.1f, 0, 0}, {0, 1, 0}, 0.6f, 24, 24);
    EXPECT_FALSE(surface->see(above).eye_in_water) << x;
  }
}

TEST(SizesFast, CrossesWhereItIsSeen) {
  const Cloud cloud = pools(3);
  RaycastOptions with = fine_options();
  with.filter_radius = 0;
  const auto surface = make_raycast_surface(cloud.particles, with, {}, nullptr, cloud.sizes());
  const View view = looking_at(cloud.particles.bounds(), {1, 0.5f, 0.9f}, Projection::perspective, 60, 44);
  const SurfaceBuffers seen = surface->see(view);
  std::vector<Ray> rays;
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x) rays.push_back(pixel_ray(view, x, y));
  const std::vector<float> from(rays.size(), 0.0f), limit(rays.size(), 20.0f);
  std::vector<std::uint8_t> inside(rays.size(), 0);
  std::vector<Crossing> found(rays.size());
  surface->crossings(rays, from, limit, inside, found);
  std::size_t mismatches = 0;
  std::vector<double> depths, normals;
  std::vector<float> into = from;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const bool hit = seen.depth[i] < kInfinity, crosses = found[i].distance < kInfinity;
    mismatches += hit != crosses;
    if (!hit || !crosses) continue;
    depths.push_back(std::abs(static_cast<double>(seen.depth[i]) - found[i].distance) / 0.03);
    normals.push_back(degrees_between(seen.normal[i], found[i].normal));
    into[i] = found[i].distance + 0.01f;
    inside[i] = 1;
  }
  EXPECT_GT(depths.size(), 500u);
  EXPECT_LE(mismatches, rays.size() / 500);
  EXPECT_LT(quantile(depths, 0.97), 0.02);
  EXPECT_LT(quantile(normals, 0.97), 0.5);
  // Out again where the water ends: at its walls or floor, not within it.
  surface->crossings(rays, into, limit, inside, found);
  std::size_t out = 0, within = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!inside[i]) continue;
    if (!(found[i].distance < kInfinity)) continue;
    ++out;
    const vec3 p = rays[i].origin + found[i].distance * rays[i].direction;
    within += p.x > -0.5f && p.x < 0.65f && std::abs(p.y) < 0.4f && p.z > 0.1f && p.z < 0.4f;
  }
  EXPECT_GT(out, 500u);
  EXPECT_LE(within, out / 100);
}

}  // namespace
}  // namespace meniscus
