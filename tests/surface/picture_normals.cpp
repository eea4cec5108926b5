// Normals of whole pictures, of which some are interpolated, against those of single points, which never are.
#include "surface/fixtures.h"

namespace meniscus {
namespace {

using namespace surface_tests;

/// A wavy tank close by: a spacing is `pixels` wide.
View close_view(float pixels, int size) {
  return orthographic_view(kSpacing * vec3{8, -6, 20}, kSpacing * vec3{0, 0, 1}, {0, 1, 0},
                           static_cast<float>(size) / pixels * kSpacing, size, size);
}

struct Pair {
  SurfaceBuffers picture, points;
};

Pair seen_both_ways(float pixels, int size) {
  RaycastOptions with = options();
  with.filter_radius = 0;
  with.want_thickness = false;
  const auto surface = make_raycast_surface(wavy_tank(), with);
  const View view = close_view(pixels, size);
  std::vector<vec2> centres;
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) centres.push_back({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
  return {surface->see(view), surface->see(view, centres)};
}

TEST(PictureNormals, AreNearThoseOfSinglePointsWhereTheyAreInterpolated) {
  const Pair seen = seen_both_ways(9, 161);
  expect_consistent(seen.picture);
  const Difference d = difference(seen.points, seen.picture);
  EXPECT_GT(d.hits, 10'000u);
  EXPECT_GT(d.normal_mean, 0.001) << "nothing was interpolated";
  EXPECT_LT(d.normal_mean, 0.5) << d;
  EXPECT_LT(d.normal_p99, 2.0) << d;
}

TEST(PictureNormals, AreThoseOfSinglePointsWhereASpacingIsFewPixelsWide) {
  const Pair seen = seen_both_ways(3, 75);
  const Difference d = difference(seen.points, seen.picture);
  EXPECT_GT(d.hits, 1'000u);
  // Depths of pictures and of points may differ by a hundredth of a spacing.
  EXPECT_LT(d.normal_mean, 0.1) << d;
  EXPECT_LT(d.normal_p99, 1.0) << d;
}

TEST(PictureNormals, HaveTheSameBitsForAnyNumberOfThreads) {
  const auto surface = make_raycast_surface(wavy_tank(), options());
  const View view = close_view(8, 131);
  std::vector<SurfaceBuffers> seen;
  for (const int threads : {1, 2, 5}) {
    const ThreadLimit limit(threads);
    seen.push_back(surface->see(view));
  }
  EXPECT_TRUE(same_bits(seen[0], seen[1]));
  EXPECT_TRUE(same_bits(seen[0], seen[2]));
}

}  // namespace
}  // namespace meniscus
