#include "render/rain_depths.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "rain.h"

namespace meniscus {
namespace {

/// Level water at height 0 over the square of 2 m around the origin.
std::unique_ptr<Surface> still_water() {
  HeightField field;
  field.low = {-1, -1};
  field.step = {0.1f, 0.1f};
  field.height = Image<float>(21, 21, 0.0f);
  field.floor = -1;
  find_normals(field);
  return make_height_field_surface(std::move(field));
}

Ripples ripples_over(float low, float high, float step) {
  RippleOptions options;
  options.low = vec2(low);
  options.high = vec2(high);
  options.step = step;
  return Ripples(options);
}

TEST(WaterDepths, ReachDownToWhatLiesInTheWaterAndAreNothingWhereItStandsOut) {
  Scene scene = empty_scene(-1);  // a plane 1 m under the water
  scene.set_solids({box({0.2f, -0.5f, -0.3f}, {0.6f, 0.3f, 0.3f}), box({-0.6f, -0.5f, -0.3f}, {-0.2f, -0.1f, 0.3f}),
                    box({-0.9f, 0.5f, -0.9f}, {0.9f, 0.6f, 0.9f})});  // stands out; lies under; hangs over
  const Ripples ripples = ripples_over(-0.95f, 0.95f, 0.01f);
  const std::vector<float> depths = water_depths(ripples, *still_water(), scene, 0.7f);
  ASSERT_EQ(depths.size(), static_cast<std::size_t>(ripples.width() * ripples.height()));
  for (int j = 0; j < ripples.height(); ++j)
    for (int i = 0; i < ripples.width(); ++i) {
      const vec3 p = ripples.place(i, j, 0);
      const float x = std::abs(p.x), z = std::abs(p.z);
      // Within 2 cm of an edge either may be.
      if (std::abs(x - 0.2f) < 0.02f || std::abs(x - 0.6f) < 0.02f || std::abs(z - 0.3f) < 0.02f) continue;
      const bool on_box = x > 0.2f && x < 0.6f && z < 0.3f;
      const float expected = !on_box ? 0.7f : p.x > 0 ? 0.0f : 0.1f;
      ASSERT_NEAR(depths[static_cast<std::size_t>(i + ripples.width() * j)], expected, 1e-4f) << p.x << " " << p.z;
    }
}

TEST(WaterDepths, AreTheDeepestWhereWaterMayComeYetAndTheSameOnAnyNumberOfThreads) {
  Scene scene = empty_scene(-1);
  scene.set_solids({box({0.2f, -0.5f, -0.3f}, {0.6f, 0.3f, 0.3f})});
  const Ripples ripples = ripples_over(-2, 2, 0.03f);
  std::vector<std::vector<float>> all;
  for (const int threads : {1, 2, 5}) {
    const ThreadLimit limit(threads);
    all.push_back(water_depths(ripples, *still_water(), scene, 0.7f));
  }
  EXPECT_EQ(all[0], all[1]);
  EXPECT_EQ(all[0], all[2]);
  EXPECT_EQ(all[0].front(), 0.7f);
  EXPECT_EQ(*std::min_element(all[0].begin(), all[0].end()), 0.0f);
}

}  // namespace
}  // namespace meniscus
