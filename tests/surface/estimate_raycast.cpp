// Memory of a ray-cast surface as foreseen: how it grows, and against what the grid says that it holds.
#include "particles/band_grid.h"
#include "surface/fixtures.h"
#include "surface/raycast_field.h"

namespace meniscus {
namespace {

using namespace surface_tests;

TEST(EstimateRaycast, GrowsWithParticlesAndPixelsAndLessThanTheParticles) {
  const Bounds bounds{{0, 0, 0}, {2, 1, 2}};
  RaycastOptions with;
  RaycastEstimate before;
  for (const std::uint64_t count : {1000ull, 1'000'000ull, 12'400'000ull, 142'600'000ull}) {
    with.spacing = std::cbrt(4.0f / static_cast<float>(count));
    const RaycastEstimate e = estimate_raycast(count, bounds, with, 1 << 20);
    EXPECT_GT(e.kept_bytes, before.kept_bytes);
    EXPECT_GE(e.build_bytes, e.kept_bytes);
    EXPECT_LE(e.kept, e.particles);
    before = e;
  }
  EXPECT_LT(before.kept, 0.2 * before.particles) << "most of 142.6 million particles lie in the midst of the water";
  const auto view_bytes = [&](std::uint64_t pixels) { return estimate_raycast(10, bounds, with, pixels).view_bytes; };
  EXPECT_EQ(view_bytes(300) - view_bytes(200), view_bytes(200) - view_bytes(100));
}

TEST(EstimateRaycast, TakesAnythingButASpacingThatIsNone) {
  RaycastOptions with = options();
  EXPECT_EQ(estimate_raycast(0, {}, with, 0).kept_bytes, 0u);
  EXPECT_GT(estimate_raycast(1, {{0, 0, 0}, {0, 0, 0}}, with, 1).kept_bytes, 0u);
  EXPECT_LT(estimate_raycast(100, {{-1e30f, -1e30f, -1e30f}, {1e30f, 1e30f, 1e30f}}, with, 1).kept_bytes, 100'000'000u)
      << "spray far away takes no more than its particles justify";
  with.spacing = 0;
  EXPECT_THROW(estimate_raycast(1, {}, with, 1), Error);
  with.spacing = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(estimate_raycast(1, {}, with, 1), Error);
}

}  // namespace
}  // namespace meniscus
