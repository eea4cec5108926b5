// Depths that are foretold from the pixels around: where a spacing covers many pixels, most are.
#include "surface/fixtures.h"

namespace meniscus {
namespace {

using namespace surface_tests;

TEST(ForetoldDepths, AreThoseOfThePlainMethodWhereASpacingCoversManyPixels) {
  const Particles particles = wavy_tank(5);
  RaycastOptions with = options();
  with.want_normals = with.want_thickness = false;
  for (const Projection projection : kProjections) {
    const View view = looking_at(particles.bounds(), {0.6f, 0.4f, 0.8f}, projection, 301, 243);
    const Difference d = difference(make_plain_raycast_surface(particles, with)->see(view),
                                    make_raycast_surface(particles, with)->see(view));
    EXPECT_GT(d.hits, 15000u);
    EXPECT_LT(d.mismatch, 1e-3) << d;
    EXPECT_LT(d.depth_p99, 0.01) << d;
  }
}

}  // namespace
}  // namespace meniscus
