// Picture points between pixels, for smooth silhouettes.
#include "surface/fixtures.h"

namespace meniscus {
namespace {

using namespace surface_tests;

TEST(Refine, AtPixelCentresGivesWhatWasSeen) {
  const Particles particles = wavy_tank();
  const auto surface = make_raycast_surface(particles, options());
  for (const Projection projection : kProjections) {
    const View view = looking_at(particles.bounds(), {1, 0.6f, 0.5f}, projection, 101, 67);
    const SurfaceBuffers seen = surface->see(view);
    std::vector<vec2> centres;
    for (int y = 0; y < view.height; ++y)
      for (int x = 0; x < view.width; ++x)
        centres.emplace_back(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
    const SurfaceBuffers fine = surface->refine(view, seen, centres), alone = surface->see(view, centres);
    ASSERT_EQ(fine.depth.width(), static_cast<int>(centres.size()));
    ASSERT_EQ(fine.depth.height(), 1);
    std::size_t different = 0, covered = 0;
    std::vector<double> depths, normals;
    for (std::size_t i = 0; i < centres.size(); ++i) {
      const bool hit = seen.depth[i] < kInfinity;
      covered += hit;
      different += hit != (fine.depth[i] < kInfinity);
      if (!hit || !(fine.depth[i] < kInfinity)) continue;
      depths.push_back(std::abs(static_cast<double>(seen.depth[i]) - fine.depth[i]) / kSpacing);
      normals.push_back(degrees_between(seen.normal[i], fine.normal[i]));
      ASSERT_NEAR(glm::length(fine.normal[i]), 1.0f, 1e-4f);
    }
    EXPECT_GT(covered, 1000u);
    EXPECT_LE(different, centres.size() / 1000);
    EXPECT_LT(quantile(depths, 0.5), 2e-3);
    EXPECT_LT(quantile(depths, 0.99), 0.02);
    EXPECT_LT(quantile(normals, 0.5), 3.0);
    for (std::size_t i = 0; i < centres.size(); ++i)
      if (fine.depth[i] < kInfinity) {
        ASSERT_NEAR(fine.thickness[i], seen.thickness[i], 1e-4f);
      }
    EXPECT_TRUE(same_bits(alone.depth, fine.depth));
  }
}

TEST(Refine, FindsTheAreaOfADropOfAFewPixels) {
  // A lone particle is a sphere of known radius, so its silhouette's area is known.
  Random random(121);
  for (int i = 0; i < 12; ++i) {
    Particles particles;
    add(particles, 0.3f * random.in_cube(1));
    Bounds box;
    box.add(particles.position(0) + kSpacing * random.in_cube(0.3f));
    const View view = looking_at(box.grown(random.between(1.5f, 4.0f) * kSpacing), random.direction(),
                                 Projection::orthographic, 24, 24);
    const auto surface = make_raycast_surface(particles, options());
    const SurfaceBuffers seen = surface->see(view);
    constexpr int kSide = 8;
    std::vector<vec2> points;
    for (int y = 0; y < view.height * kSide; ++y)
      for (int x = 0; x < view.width * kSide; ++x)
        points.emplace_back((static_cast<float>(x) + 0.5f) / kSide, (static_cast<float>(y) + 0.5f) / kSide);
    const SurfaceBuffers fine = surface->refine(view, seen, points);
    double covered = 0;
    for (const float c : fine.coverage) covered += c / (kSide * kSide);
    const double pixel = 2.0 * view.half_height / view.height;
    const double area = std::numbers::pi * std::pow(kDropRadius * kSpacing / pixel, 2);
    EXPECT_NEAR(covered / area, 1.0, 0.02) << area << " px";
  }
}

TEST(Refine, AnswersForNoPointsAndPointsAtTheBorder) {
  const Particles particles = lattice_box(20, 20, 8);
  const auto surface = make_raycast_surface(particles, options());
  const View view = orthographic_view({0, 0, 1}, {0, 0, 0}, {0, 1, 0}, 4 * kSpacing, 33, 17);
  const SurfaceBuffers seen = surface->see(view);
  const std::vector<vec2> corners{{0, 0}, {33, 0}, {0, 17}, {33, 17}, {16.5f, 0}, {32.999f, 16.999f}};
  const SurfaceBuffers fine = surface->refine(view, seen, corners);
  for (std::size_t i = 0; i < corners.size(); ++i)
    EXPECT_NEAR(fine.depth[i], 1.0f - 4 * kSpacing, 0.05f * kSpacing) << i;
  EXPECT_EQ(surface->refine(view, seen, {}).depth.size(), 0u);
}

}  // namespace
}  // namespace meniscus
