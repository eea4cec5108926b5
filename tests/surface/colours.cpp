// Density-weighted averages of the particles' colours.
#include "surface/fixtures.h"

namespace meniscus {
namespace {

using namespace surface_tests;

constexpr vec3 kRed{0.9f, 0.1f, 0.0f}, kBlue{0.0f, 0.2f, 0.8f};

TEST(Colours, OfTwoHalvesMixSmoothlyBetweenThem) {
  const Particles particles = lattice_box(20, 20, 6, 0.1f);
  std::vector<vec3> colours;
  for (std::size_t i = 0; i < particles.size(); ++i) colours.push_back(particles.x[i] < 0 ? kRed : kBlue);
  const View view = orthographic_view({0, 0, 1}, {0, 0, 0}, {0, 1, 0}, 14 * kSpacing, 141, 141);
  for (const bool fast : {true, false}) {
    const SurfaceBuffers seen = fast ? make_raycast_surface(particles, options(), colours)->see(view)
                                     : make_plain_raycast_surface(particles, options(), colours)->see(view);
    for (int y = 0; y < view.height; y += 10)
      for (int x = 0; x < view.width; ++x) {
        const float at = pixel_ray(view, x, y).origin.x / kSpacing;
        const vec3 colour = seen.colour(x, y);
        if (at < -2.3f) {
          ASSERT_LT(glm::length(colour - kRed), 1e-5f) << at;
        }
        if (at > 2.3f) {
          ASSERT_LT(glm::length(colour - kBlue), 1e-5f) << at;
        }
        // On the line between the two, and nearer to the nearer one.
        const float part = glm::dot(colour - kRed, kBlue - kRed) / glm::dot(kBlue - kRed, kBlue - kRed);
        ASSERT_LT(glm::length(kRed + part * (kBlue - kRed) - colour), 1e-5f);
        if (std::abs(at) > 0.7f) {
          ASSERT_EQ(part > 0.5f, at > 0) << at;
        }
        if (std::abs(at) < 0.3f) {
          ASSERT_NEAR(part, 0.5f, 0.3f) << at;
        }
        // Smooth: from one pixel, a tenth of a spacing, to the next.
        if (x > 0) {
          ASSERT_LT(glm::length(colour - seen.colour(x - 1, y)), 0.2f) << at;
        }
      }
  }
}

TEST(Colours, ThatAreConstantStayConstant) {
  const Particles particles = wavy_tank();
  const vec3 colour{0.25f, 0.5f, 7.0f};
  const std::vector<vec3> colours(particles.size(), colour);
  const View view = looking_at(particles.bounds(), {1, 0.5f, 0.7f}, Projection::perspective, 120, 90);
  const SurfaceBuffers seen = make_raycast_surface(particles, options(), colours)->see(view);
  EXPECT_GT(hits(seen), 1000u);
  for (std::size_t i = 0; i < seen.colour.size(); ++i) {
    const vec3 expected = seen.depth[i] < kInfinity ? colour : vec3{0};
    ASSERT_LT(glm::length(seen.colour[i] - expected), 1e-4f);
  }
}

TEST(Colours, BelongToTheParticlesInTheirGivenOrder) {
  // Drops far apart: each has its own particle's colour.
  Random random(131);
  Particles particles;
  std::vector<vec3> colours;
  for (int i = 0; i < 30; ++i) {
    const float place = static_cast<float>((i * 7) % 30);
    add(particles, {4 * place * kSpacing, random.between(-1, 1) * kSpacing, 0});
    colours.push_back(vec3{place, 1, 0});
  }
  const View view = orthographic_view({58 * kSpacing, 0, 1}, {58 * kSpacing, 0, 0}, {0, 1, 0}, 6 * kSpacing, 1000, 48);
  const SurfaceBuffers seen = make_raycast_surface(particles, options(), colours)->see(view);
  EXPECT_GT(hits(seen), 1000u);
  for_each_hit(view, seen, [&](int x, int y, const Ray&, vec3 point) {
    ASSERT_NEAR(seen.colour(x, y).x, std::round(point.x / (4 * kSpacing)), 1e-3f);
  });
}

TEST(Colours, AreAbsentUnlessGiven) {
  const Particles particles = lattice_ball(3);
  const View view = looking_at(particles.bounds(), {1, 0, 0}, Projection::perspective, 32, 32);
  EXPECT_TRUE(make_raycast_surface(particles, options())->see(view).colour.empty());
}

TEST(Colours, MustBeOneAParticle) {
  const Particles particles = lattice_ball(3);
  const std::vector<vec3> colours(particles.size() - 1, vec3{1});
  EXPECT_THROW(make_raycast_surface(particles, options(), colours), Error);
  EXPECT_THROW(make_plain_raycast_surface(particles, options(), colours), Error);
}

}  // namespace
}  // namespace meniscus
