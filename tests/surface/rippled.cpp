#include "fixtures.h"

namespace meniscus {
namespace {

using namespace surface_tests;

/// u(a, b) on a field of points over [-1, 1]^2, y up.
template <class F>
HeightField field_of(F height, float step, float half = 1) {
  HeightField field;
  field.low = {-half, -half};
  const int points = static_cast<int>(std::lround(2 * half / step)) + 1;
  field.step = vec2{step};
  field.floor = -1;
  field.height = Image<float>(points, points);
  for (int j = 0; j < points; ++j)
    for (int i = 0; i < points; ++i)
      field.height(i, j) = height(-half + static_cast<float>(i) * step, -half + static_cast<float>(j) * step);
  return field;
}

float wave(float a, float b) { return 0.004f * std::sin(20 * a) * std::cos(14 * b); }
vec2 slope_of_wave(float a, float b) {
  return {0.08f * std::cos(20 * a) * std::cos(14 * b), -0.056f * std::sin(20 * a) * std::sin(14 * b)};
}
/// Leans to both sides.
float plane(float a, float b) { return 0.1f + 0.2f * a - 0.1f * b; }

std::unique_ptr<Surface> plane_water(float half = 1) {
  return make_height_field_surface(field_of(plane, 0.1f, half), true);
}

View from_above() { return perspective_view({0.3f, 2.2f, 0.9f}, {0, 0.1f, 0}, {0, 1, 0}, 0.7f, 320, 240); }

TEST(RippledSurface, HasTheNormalsOfAPlaneDisplacedByTheRipples) {
  const auto water = make_rippled_surface(plane_water(), field_of(wave, 0.01f));
  const View view = from_above();
  const SurfaceBuffers seen = water->see(view);
  std::size_t compared = 0;
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x) {
      if (!(seen.depth(x, y) < kInfinity)) continue;
      const Ray ray = view.ray({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
      const vec3 p = ray.origin + seen.depth(x, y) * ray.direction;
      if (std::abs(p.x) > 0.9f || std::abs(p.z) > 0.9f) continue;
      ++compared;
      const vec2 slope = vec2{0.2f, -0.1f} + slope_of_wave(p.x, p.z);
      const vec3 exact = glm::normalize(vec3{-slope.x, 1, -slope.y});
      EXPECT_LT(glm::length(seen.normal(x, y) - exact), 2e-3f);
    }
  EXPECT_GT(compared, 500u);
}

TEST(RippledSurface, IsAsSmoothAsStillWaterFromFarAway) {
  const auto water = make_rippled_surface(plane_water(), field_of(wave, 0.01f));
  const vec3 still = glm::normalize(vec3{-0.2f, 1, 0.1f});
  float before = 1;
  for (const float away : {1.5f, 5.0f, 20.0f}) {
    const View view = perspective_view({0, away, 0}, {0, 0, 0}, {0, 0, -1}, 1.0f / away, 12, 12);
    View wide = view;
    wide.half_height *= away;  // pixels of the same angle at each distance
    const SurfaceBuffers seen = water->see(wide.resized(24, 24));
    float most = 0;
    for (int k = 0; k < 24 * 24; ++k)
      if (seen.depth[static_cast<std::size_t>(k)] < kInfinity)
        most = std::max(most, glm::length(seen.normal[static_cast<std::size_t>(k)] - still));
    EXPECT_LT(most, before) << away;
    before = most;
  }
  EXPECT_LT(before, 0.01f);
}

TEST(RippledSurface, AndJointOnesAreTheSameForAnyNumberOfThreads) {
  HeightField low = field_of([](float, float) { return 0.02f; }, 0.1f, 1.5f);
  SurfaceBuffers first;
  for (const int threads : {1, 2, 5}) {
    const ThreadLimit limit(threads);
    const auto water = make_rippled_surface(make_joint_surface(plane_water(), low), field_of(wave, 0.01f));
    const SurfaceBuffers seen = water->see(from_above());
    if (threads == 1) first = seen;
    EXPECT_TRUE(std::equal(seen.normal.begin(), seen.normal.end(), first.normal.begin()));
    EXPECT_TRUE(std::equal(seen.depth.begin(), seen.depth.end(), first.depth.begin()));
  }
}

TEST(RippledSurface, ChangesNothingButNormals) {
  const auto plain = plane_water();
  const auto water = make_rippled_surface(plane_water(), field_of(wave, 0.01f));
  const SurfaceBuffers a = plain->see(from_above()), b = water->see(from_above());
  EXPECT_TRUE(std::equal(a.depth.begin(), a.depth.end(), b.depth.begin()));
  EXPECT_TRUE(std::equal(a.thickness.begin(), a.thickness.end(), b.thickness.begin()));
  EXPECT_TRUE(std::equal(a.coverage.begin(), a.coverage.end(), b.coverage.begin()));
  EXPECT_TRUE(std::equal(a.normal.begin(), a.normal.end(), b.unbent_normal.begin()));
  EXPECT_EQ(plain->bounds().high, water->bounds().high);
  EXPECT_EQ(water->spacing(), plain->spacing());
  EXPECT_TRUE(water->can_march());
  EXPECT_NE(water->height_field(), nullptr);
}

TEST(RippledSurface, GoesOverToTheWaterAroundItWithoutAStep) {
  const auto water = make_rippled_surface(plane_water(3), field_of(wave, 0.02f, 0.5f));
  const vec3 still = glm::normalize(vec3{-0.2f, 1, 0.1f});
  vec3 before{0.0f};
  for (float a = -0.8f; a < 0.8f; a += 0.0005f) {
    const Ray ray{{a, 2, 0.013f}, {0, -1, 0}};
    const float from = 0, limit = 10;
    const std::uint8_t inside = 0;
    Crossing found;
    water->crossings({&ray, 1}, {&from, 1}, {&limit, 1}, {&inside, 1}, {&found, 1});
    ASSERT_TRUE(found.distance < kInfinity);
    if (std::abs(a) > 0.5f) {
      EXPECT_LT(glm::length(found.normal - still), 1e-6f);
    }
    if (before != vec3{0.0f}) {
      EXPECT_LT(glm::length(found.normal - before), 3e-3f);
    }
    before = found.normal;
  }
}

TEST(RippledSurface, LeavesNormalsThatLookDown) {
  // From below, through the floor and the sides of a block.
  const auto water = make_rippled_surface(plane_water(), field_of(wave, 0.01f));
  const auto plain = plane_water();
  const View below = perspective_view({0.5f, -3, 2.5f}, {0, -0.5f, 0}, {0, 1, 0}, 0.7f, 48, 32);
  const SurfaceBuffers a = plain->see(below), b = water->see(below);
  std::size_t met = 0;
  for (std::size_t i = 0; i < a.depth.size(); ++i) {
    if (!(a.depth[i] < kInfinity) || a.normal[i].y > 0) continue;
    ++met;
    EXPECT_EQ(a.normal[i], b.normal[i]);
  }
  EXPECT_GT(met, 200u);
}

TEST(RippledSurface, BendsOnceWhereAPictureIsRefined) {
  // A particle surface takes the filtered normals of the picture, which are bent already.
  Particles particles = lattice_box(16, 8, 16);
  RaycastOptions options;
  options.spacing = kSpacing;
  const auto water = make_rippled_surface(make_raycast_surface(particles, options), field_of(wave, 0.01f, 0.5f));
  const View view = perspective_view({0.1f, 1.6f, 0.5f}, {0, 0.1f, 0}, {0, 1, 0}, 0.5f, 96, 72);
  const SurfaceBuffers coarse = water->see(view);
  std::vector<vec2> points;
  std::vector<std::size_t> pixels;
  for (int y = 20; y < 52; ++y)
    for (int x = 30; x < 66; ++x) {
      points.emplace_back(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
      pixels.push_back(static_cast<std::size_t>(y) * 96 + static_cast<std::size_t>(x));
    }
  const SurfaceBuffers fine = water->refine(view, coarse, points);
  double bent = 0, difference = 0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    ASSERT_TRUE(fine.depth[k] < kInfinity);
    bent += static_cast<double>(glm::length(coarse.normal[pixels[k]] - coarse.unbent_normal[pixels[k]]));
    difference += static_cast<double>(glm::length(fine.normal[k] - coarse.normal[pixels[k]]));
  }
  EXPECT_GT(bent, 0.02 * static_cast<double>(points.size()));
  EXPECT_LT(difference, 0.1 * bent);
}

TEST(RippledSurface, RefusesNoWater) {
  EXPECT_THROW(make_rippled_surface(nullptr, field_of(wave, 0.1f)), Error);
  const auto water = make_rippled_surface(plane_water(), HeightField{});
  EXPECT_TRUE(water->see(from_above()).unbent_normal.empty()) << "no ripples";
}

}  // namespace
}  // namespace meniscus
