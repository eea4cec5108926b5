// Rays that share what is gathered of the particles near them meet the surface where each would alone.
#include "surface/fixtures.h"

namespace meniscus {
namespace {

using namespace surface_tests;

/// A wavy tank with drops above it, and a wall of water 60 spacings behind, seen past it and between the drops.
Particles tank_before_a_wall() {
  Particles particles = wavy_tank(6);
  const Particles wall = lattice_box(30, 30, 5, 0.2f);
  for (std::size_t i = 0; i < wall.size(); ++i) add(particles, wall.position(i) + kSpacing * vec3{0, 0, -60});
  return particles;
}

TEST(Beams, MeetTheSurfaceWhereLoneRaysDoHoweverWideAPixelIs) {
  const Particles particles = tank_before_a_wall();
  RaycastOptions with = options();
  with.want_normals = with.want_thickness = false;
  const auto fast = make_raycast_surface(particles, with), plain = make_plain_raycast_surface(particles, with);
  std::size_t hits = 0;
  for (const float pixels_a_spacing : {0.2f, 0.5f, 1.0f, 2.0f, 4.0f})
    for (const vec3 from : {vec3{3, 5, 100}, vec3{60, 40, 70}}) {
      const int size = static_cast<int>(30 * pixels_a_spacing);
      const View view =
          orthographic_view(kSpacing * from, kSpacing * vec3{0, 0, -20}, {0.1f, 1, 0}, 30 * kSpacing, size, size);
      const Difference d = difference(plain->see(view), fast->see(view));
      EXPECT_LT(d.mismatch, 1e-3) << pixels_a_spacing << ": " << d;
      EXPECT_LT(d.depth_p99, 0.01) << pixels_a_spacing << ": " << d;
      hits += d.hits;
    }
  EXPECT_GT(hits, 15'000u);
}

TEST(Beams, OfPointsInAnyOrderMeetWhatThoseOfNeighboursDo) {
  // Points that follow each other are marched together: far apart or side by side, each finds the same depth.
  const Particles particles = tank_before_a_wall();
  RaycastOptions with = options();
  with.want_normals = with.want_thickness = false;
  const auto surface = make_raycast_surface(particles, with);
  const View view =
      orthographic_view(kSpacing * vec3{3, 5, 100}, kSpacing * vec3{0, 0, -20}, {0.1f, 1, 0}, 30 * kSpacing, 48, 48);
  std::vector<vec2> points;
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 48; ++x) points.push_back({static_cast<float>(x) + 0.3f, static_cast<float>(y) + 0.6f});
  std::vector<vec2> scattered;
  for (std::size_t i = 0; i < points.size(); ++i) scattered.push_back(points[i * 1009 % points.size()]);
  const SurfaceBuffers a = surface->see(view, points), b = surface->see(view, scattered);
  std::size_t met = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const float in_turn = a.depth[i * 1009 % points.size()], apart = b.depth[i];
    ASSERT_EQ(in_turn < kInfinity, apart < kInfinity) << i;
    if (!(apart < kInfinity)) continue;
    ++met;
    EXPECT_NEAR(in_turn, apart, 1e-3f * kSpacing) << i;
  }
  EXPECT_GT(met, 1000u);
}

TEST(Beams, LeapOverNothingThatRaysWouldMeet) {
  // Clumps of all densities before each other: most rays graze some spheres, leave them, and go on for a long way.
  Particles particles = clumped_cloud(900, 30, 12);
  for (const float back : {25.0f, 70.0f, 300.0f}) {
    const Particles more = clumped_cloud(900, 30, static_cast<std::uint64_t>(back));
    for (std::size_t i = 0; i < more.size(); ++i) add(particles, more.position(i) - kSpacing * vec3{0, 0, back});
  }
  for (const Kernel kernel : {Kernel::cubic_spline, Kernel::wyvill})
    for (const float iso : {0.35f, 0.6f}) {
      RaycastOptions with = options();
      with.want_normals = with.want_thickness = false;
      with.kernel = kernel;
      with.iso = iso;
      with.refinement_steps = 6;  // spheres of other sizes start their samples elsewhere
      const View view = orthographic_view(kSpacing * vec3{0, 0, 40}, vec3{0}, {0.1f, 1, 0}, 34 * kSpacing, 160, 160);
      const Difference d = difference(make_plain_raycast_surface(particles, with)->see(view),
                                      make_raycast_surface(particles, with)->see(view));
      EXPECT_GT(d.hits, 5000u);
      EXPECT_LT(d.mismatch, 5e-4) << iso << ": " << d;
      EXPECT_LT(d.depth_p99, 0.02) << iso << ": " << d;
    }
}

}  // namespace
}  // namespace meniscus
