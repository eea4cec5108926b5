#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "meniscus/render.h"
#include "render/antialias.h"

namespace meniscus {
namespace {

PictureOptions small_picture() {
  PictureOptions options;
  options.width = 160;
  options.height = 96;
  return options;
}

FramePicture drawn(const Particles& particles, const PictureOptions& options) {
  return render_frame(particles, settings_of(survey_particles(particles), options));
}

TEST(RenderFrame, GivesTheSameBitsWithOneTwoAndFiveThreads) {
  const Particles tank = synthetic_tank(3000);
  std::vector<FramePicture> pictures;
  for (const int threads : {1, 2, 5}) {
    const ThreadLimit limit(threads);
    pictures.push_back(drawn(tank, small_picture()));
  }
  for (const FramePicture& other : {std::cref(pictures[1]), std::cref(pictures[2])}) {
    EXPECT_TRUE(std::equal(other.radiance.begin(), other.radiance.end(), pictures[0].radiance.begin()));
    EXPECT_TRUE(std::equal(other.picture.begin(), other.picture.end(), pictures[0].picture.begin()));
  }
}

TEST(RenderFrame, DoesNotCareForTheOrderOfParticles) {
  const Particles tank = synthetic_tank(3000);
  std::vector<std::size_t> order(tank.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::shuffle(order.begin(), order.end(), std::mt19937(5));
  Particles shuffled = tank;
  for (std::size_t i = 0; i < order.size(); ++i) {
    shuffled.x[i] = tank.x[order[i]];
    shuffled.y[i] = tank.y[order[i]];
    shuffled.z[i] = tank.z[order[i]];
  }
  EXPECT_GT(compare(drawn(tank, small_picture()).picture, drawn(shuffled, small_picture()).picture).psnr_db, 45);
}

/// The particles with x, y, z turned into y, z, x: a rigid turn about the diagonal.
Particles turned(const Particles& particles) {
  Particles result = particles;
  result.x = particles.z;
  result.y = particles.x;
  result.z = particles.y;
  result.up = Axis::z;
  return result;
}
vec3 turned(vec3 p) { return {p.z, p.x, p.y}; }

TEST(RenderFrame, DoesNotCareForTheAxesOfTheWorld) {
  const Particles tank = synthetic_tank(3000);
  PictureOptions options = small_picture();
  options.ground = GroundStyle::plain;  // which squares of a chequer are dark is nobody's promise
  options.sun_deg = vec2{90, 40};       // seen from +x where y is up ...
  options.camera.eye = vec3{5, 3, 4};
  options.camera.target = vec3{1, 0.6f, 1};
  const Image<Rgb8> picture = drawn(tank, options).picture;
  options.camera.eye = turned(*options.camera.eye);
  options.camera.target = turned(*options.camera.target);
  options.sun_deg = vec2{180, 40};  // ... and from +y where z is up
  EXPECT_GT(compare(picture, drawn(turned(tank), options).picture).psnr_db, 50);
}

TEST(RenderFrame, AnEmptyFrameIsTheSceneWithoutWater) {
  const FramePicture frame = drawn(Particles{}, small_picture());
  EXPECT_EQ(frame.picture.width(), 160);
  EXPECT_TRUE(
      std::all_of(frame.buffers.coverage.begin(), frame.buffers.coverage.end(), [](float c) { return c == 0; }));
  EXPECT_TRUE(
      std::all_of(frame.radiance.begin(), frame.radiance.end(), [](vec3 c) { return std::isfinite(c.x + c.y + c.z); }));
}

std::size_t covered(const FramePicture& frame) {
  return static_cast<std::size_t>(
      std::count_if(frame.buffers.coverage.begin(), frame.buffers.coverage.end(), [](float c) { return c > 0; }));
}

TEST(RenderFrame, OneParticleTwoAndManyInOnePointAreSeen) {
  for (const std::size_t count : {1u, 2u, 500u}) {
    Particles particles;
    particles.x.assign(count, 0.3f);
    particles.y.assign(count, 0.1f);
    particles.z.assign(count, -0.2f);
    if (count == 2) particles.x[1] += 0.1f;
    const FramePicture frame = drawn(particles, small_picture());
    EXPECT_GT(covered(frame), 20u) << count;
  }
}

TEST(RenderFrame, OutlinesComeNearToThoseOfSixteenTimesThePixels) {
  const Particles tank = synthetic_tank(3000);
  PictureOptions options = small_picture();
  options.material = "clay";
  const FramePicture edges = drawn(tank, options);
  options.antialias = Antialias::full;
  const FramePicture full = drawn(tank, options);
  options.antialias = Antialias::off;
  const FramePicture off = drawn(tank, options);
  PictureOptions large = options;
  large.width *= 4;
  large.height *= 4;
  const FramePicture fine = drawn(tank, large);
  Image<float> coverage(options.width, options.height);
  for (int y = 0; y < large.height; ++y)
    for (int x = 0; x < large.width; ++x) coverage(x / 4, y / 4) += fine.buffers.coverage(x, y) / 16;
  const auto coverage_error = [&](const FramePicture& frame) {
    double sum = 0;
    for (std::size_t i = 0; i < coverage.size(); ++i) sum += std::abs(frame.buffers.coverage[i] - coverage[i]);
    return sum;
  };
  EXPECT_LT(coverage_error(edges), 0.2 * coverage_error(off));
  EXPECT_LT(coverage_error(full), 0.6 * coverage_error(off));
  const Image<Rgb8> reference = developed(downsampled(fine.radiance, 4), options.tone);
  const double raw_db = compare(off.picture, reference).psnr_db;
  EXPECT_GT(compare(edges.picture, reference).psnr_db, raw_db + 3);
  EXPECT_GT(compare(full.picture, reference).psnr_db, raw_db + 3);
}

TEST(RenderFrame, OutlinesHaveFractionsOfCoverage) {
  const FramePicture frame = drawn(synthetic_tank(3000), small_picture());
  const auto fractions = std::count_if(frame.buffers.coverage.begin(), frame.buffers.coverage.end(),
                                       [](float c) { return c > 0.02f && c < 0.98f; });
  EXPECT_GT(fractions, 50);
}

TEST(RenderFrame, ColoursFollowTheAttributeAndItsRange) {
  Particles tank = synthetic_tank(3000);
  tank.attributes.push_back({"height", 1, tank.y});
  PictureOptions options = small_picture();
  options.colour = ColourBy{"height", Colormap::grey, {}};
  SurveyOptions survey_options;
  survey_options.colour = options.colour;
  const Survey survey = survey_particles(tank, survey_options);
  const auto [low, high] = std::minmax_element(tank.y.begin(), tank.y.end());
  ASSERT_TRUE(survey.colour_range);
  EXPECT_FLOAT_EQ(survey.colour_range->first, *low);
  EXPECT_FLOAT_EQ(survey.colour_range->second, *high);
  const FramePicture frame = render_frame(tank, settings_of(survey, options));
  EXPECT_FALSE(frame.buffers.colour.empty());
  options.colour->attribute = "colour_of_music";
  EXPECT_THROW(render_frame(tank, settings_of(survey, options)), Error);
}

Scene without_ground() {
  Ground ground;
  ground.visible = false;
  return Scene(Environment(EnvironmentOptions{}), ground);
}

TEST(SilhouettePixels, AreThoseAtTheBorderOfTheWaterAndWhereItFolds) {
  const View view = orthographic_view({0, 0, 5}, vec3{0}, {0, 1, 0}, 10, 10, 10);
  SurfaceBuffers seen;
  seen.coverage = Image<float>(10, 10);
  seen.depth = Image<float>(10, 10, std::numeric_limits<float>::infinity());
  seen.normal = Image<vec3>(10, 10);
  for (int y = 0; y < 10; ++y)
    for (int x = 3; x < 10; ++x) {
      seen.coverage(x, y) = 1;
      seen.depth(x, y) = x < 6 ? 4.0f : 1.0f;
      seen.normal(x, y) = {0, 0, 1};
    }
  std::vector<std::uint32_t> expected;
  for (std::uint32_t y = 0; y < 10; ++y)
    for (const std::uint32_t x : {2u, 3u, 5u, 6u}) expected.push_back(10 * y + x);
  EXPECT_EQ(silhouette_pixels(view, seen, without_ground(), 0.5f), expected);
}

TEST(SilhouettePixels, ASlopeIsNone) {
  // A plane at 60 degrees to the rays: its depth changes by 1.7 pixels from pixel to pixel.
  const View view = orthographic_view({0, 0, 5}, vec3{0}, {0, 1, 0}, 10, 10, 10);
  SurfaceBuffers seen;
  seen.coverage = Image<float>(10, 10, 1.0f);
  seen.depth = Image<float>(10, 10);
  seen.normal = Image<vec3>(10, 10, vec3{-std::sqrt(0.75f), 0, 0.5f});
  for (int y = 0; y < 10; ++y)
    for (int x = 0; x < 10; ++x) seen.depth(x, y) = 20 - 1.732f * static_cast<float>(x);
  EXPECT_TRUE(silhouette_pixels(view, seen, without_ground(), 0.01f).empty());
}

TEST(SilhouettePixels, FollowTheLineWhereTheGroundHidesTheWater) {
  // A wall of water seen along the ground's plane: its lower rows lie under the ground.
  const View view = orthographic_view({0, 5, 5}, {0, 0, 0}, {0, 1, 0}, 10, 10, 10);
  SurfaceBuffers seen;
  seen.coverage = Image<float>(10, 10, 1.0f);
  seen.depth = Image<float>(10, 10, 7.0f);
  seen.normal = Image<vec3>(10, 10, -view.forward);
  Ground ground;
  ground.height = 0;
  const Scene scene(Environment(EnvironmentOptions{}), ground);
  std::vector<std::uint32_t> expected;
  int last_row_of_water = -1;
  for (int y = 0; y < 10; ++y)
    if (scene.ground_distance(view.ray({0.5f, static_cast<float>(y) + 0.5f})) >= 7.0f) last_row_of_water = y;
  ASSERT_GE(last_row_of_water, 0);
  ASSERT_LT(last_row_of_water, 9);
  for (int y = last_row_of_water; y <= last_row_of_water + 1; ++y)
    for (int x = 0; x < 10; ++x) expected.push_back(static_cast<std::uint32_t>(10 * y + x));
  EXPECT_EQ(silhouette_pixels(view, seen, scene, 0.5f), expected);
}

TEST(RenderFrame, AParticleThatFlewAwayDoesNotStopThePicture) {
  Particles tank = synthetic_tank(4000);
  PictureOptions options;
  options.width = 64;
  options.height = 48;
  const FrameSettings settings = settings_of(survey_particles(tank), options);
  const Image<Rgb8> without = render_frame(tank, settings).picture;
  for (const float far : {1e6f, 1e30f}) {
    Particles with = tank;
    with.x.push_back(far);
    with.y.push_back(0);
    with.z.push_back(0);
    const FramePicture frame = render_frame(with, settings);
    EXPECT_EQ(frame.far_away, 1u) << far;
    EXPECT_GT(compare(frame.picture, without).psnr_db, 60) << far;
  }
}

TEST(RenderFrame, AFewDropsFarAsideLeaveTheShadowAsItIs) {
  Particles tank = synthetic_tank(4000);
  PictureOptions options;
  options.width = 96;
  options.height = 64;
  const FrameSettings settings = settings_of(survey_particles(tank), options);
  const Image<Rgb8> without = render_frame(tank, settings).picture;
  const float width = tank.bounds().extent().x;
  for (const float side : {-30.0f, 30.0f}) {
    tank.x.push_back(side * width);
    tank.y.push_back(2 * width);
    tank.z.push_back(0);
  }
  EXPECT_GT(compare(render_frame(tank, settings).picture, without).psnr_db, 45);
}

TEST(Shown, BuffersAreColoursOverWhite) {
  FrameSettings settings;
  const Particles ball = [] {
    Particles particles;
    for (int z = -3; z <= 3; ++z)
      for (int y = -3; y <= 3; ++y)
        for (int x = -3; x <= 3; ++x) {
          particles.x.push_back(static_cast<float>(x));
          particles.y.push_back(static_cast<float>(y));
          particles.z.push_back(static_cast<float>(z));
        }
    return particles;
  }();
  settings.view = orthographic_view({0, 0, 20}, vec3{0}, {0, 1, 0}, 12, 48, 48);
  settings.surface.spacing = 1;
  settings.show = Show::normals;
  const Image<Rgb8> normals = render_frame(ball, settings).picture;
  EXPECT_EQ(normals(0, 0), (Rgb8{255, 255, 255}));
  // Towards the eye is (128, 128, 255) as in every normal map.
  EXPECT_NEAR(normals(24, 24).r, 128, 3);
  EXPECT_NEAR(normals(24, 24).g, 128, 3);
  EXPECT_NEAR(normals(24, 24).b, 255, 1);
  settings.show = Show::thickness;
  const Image<Rgb8> thickness = render_frame(ball, settings).picture;
  EXPECT_GT(thickness(24, 24).g, thickness(24, 11).g);  // viridis rises in green
}

}  // namespace
}  // namespace meniscus
