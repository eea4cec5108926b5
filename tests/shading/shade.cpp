// What shade() does with its buffers: sizes, coverage, points, threads, bad values.
#include <gtest/gtest.h>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <random>

#include "fixtures.h"

namespace meniscus {
namespace {

using namespace tests;

const Environment& sky() {
  static const Environment environment{EnvironmentOptions{}};
  return environment;
}

Scene chequered() {
  Ground ground;
  ground.square = 0.3f;
  ground.fade_radius = 20.0f;
  ground.height = -1.0f;
  return Scene(sky(), ground);
}

View camera(int width = 61, int height = 47) {
  return perspective_view({0.5f, 2, 5}, {0, 0, 0}, {0, 1, 0}, 0.7f, width, height);
}

/// A wavy surface with holes.
SurfaceBuffers wavy(const View& view) {
  SurfaceBuffers buffers = even(view.width, view.height, 4.0f, {0, 1, 0}, 0.5f);
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x) {
      const float a = 0.3f * static_cast<float>(x), b = 0.21f * static_cast<float>(y);
      buffers.normal(x, y) = glm::normalize(vec3{0.3f * std::sin(a), 1.0f, 0.3f * std::cos(b)});
      buffers.depth(x, y) = 4.0f + 0.2f * std::cos(a);
      if ((x / 5 + y / 7) % 4 == 0) {
        buffers.coverage(x, y) = 0.0f;
        buffers.depth(x, y) = std::numeric_limits<float>::infinity();
        buffers.normal(x, y) = vec3{0.0f};
      }
    }
  return buffers;
}

bool sound(vec3 v) {
  return v.x >= 0 && v.y >= 0 && v.z >= 0 && v.x + v.y + v.z < std::numeric_limits<float>::infinity();
}

TEST(ShadeBuffers, GiveTheSameBitsForAnyNumberOfThreads) {
  const View view = camera();
  const Scene scene = chequered();
  const Material water = material_preset("water", 1.0f);
  std::vector<Image<vec3>> pictures;
  for (const int threads : {1, 2, 5}) {
    const ThreadLimit limit(threads);
    pictures.push_back(shade(view, {}, wavy(view), scene, water));
  }
  for (std::size_t i = 0; i < pictures[0].size(); ++i) {
    ASSERT_EQ(pictures[0][i], pictures[1][i]);
    ASSERT_EQ(pictures[0][i], pictures[2][i]);
  }
}

TEST(ShadeBuffers, GiveTheSameForAListOfPixelCentres) {
  const View view = camera();
  const Scene scene = chequered();
  const SurfaceBuffers whole = wavy(view);
  std::vector<vec2> centres;
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x)
      centres.push_back({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
  SurfaceBuffers list = even(static_cast<int>(centres.size()), 1, 0.0f, vec3{0.0f}, 0.0f);
  std::copy(whole.depth.begin(), whole.depth.end(), list.depth.begin());
  std::copy(whole.normal.begin(), whole.normal.end(), list.normal.begin());
  std::copy(whole.thickness.begin(), whole.thickness.end(), list.thickness.begin());
  std::copy(whole.coverage.begin(), whole.coverage.end(), list.coverage.begin());
  const Material water = material_preset("water", 1.0f);
  const Image<vec3> a = shade(view, {}, whole, scene, water), b = shade(view, centres, list, scene, water);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_EQ(a[i], b[i]) << i;
}

TEST(ShadeBuffers, MixWaterAndSceneByCoverage) {
  const View view = camera();
  const Scene scene = chequered();
  const Material water = material_preset("water", 1.0f);
  SurfaceBuffers buffers = even(view.width, view.height, 4.0f, glm::normalize(vec3{0.1f, 1, 0.2f}), 0.4f);
  const Image<vec3> full = shade(view, {}, buffers, scene, water);
  buffers.coverage = Image<float>(view.width, view.height, 0.0f);
  const Image<vec3> none = shade(view, {}, buffers, scene, water);
  buffers.coverage = Image<float>(view.width, view.height, 0.25f);
  const Image<vec3> quarter = shade(view, {}, buffers, scene, water);
  for (std::size_t i = 0; i < full.size(); ++i)
    ASSERT_LT(glm::length(quarter[i] - (0.25f * full[i] + 0.75f * none[i])), 1e-5f * (1.0f + glm::length(full[i])));
  EXPECT_LT(glm::length(none(30, 40) - scene.radiance(view.ray({30.5f, 40.5f}), view.pixel_size(1.0f))), 1e-6f);
}

TEST(ShadeBuffers, MayHoldAnything) {
  const View view = camera(80, 60);
  const Scene scene = chequered();
  const float bad[] = {std::numeric_limits<float>::quiet_NaN(),
                       std::numeric_limits<float>::infinity(),
                       -std::numeric_limits<float>::infinity(),
                       0.0f,
                       -0.0f,
                       -3.0f,
                       1e30f,
                       1e-30f,
                       1e-42f};
  std::mt19937 random(3);
  std::uniform_real_distribution<float> any(-2.0f, 2.0f);
  const auto value = [&] { return random() % 4 == 0 ? bad[random() % std::size(bad)] : any(random); };
  for (const char* name : {"water", "milk", "clay", "plastic"}) {
    for (const bool under : {false, true}) {
      SurfaceBuffers buffers = even(80, 60, 4.0f, {0, 1, 0}, 0.5f);
      buffers.colour = Image<vec3>(80, 60);
      buffers.eye_in_water = under;
      for (std::size_t i = 0; i < buffers.depth.size(); ++i) {
        buffers.depth[i] = value();
        buffers.normal[i] = {value(), value(), value()};
        buffers.thickness[i] = value();
        buffers.coverage[i] = value();
        buffers.colour[i] = {value(), value(), value()};
      }
      for (const vec3& radiance : shade(view, {}, buffers, scene, material_preset(name, 1.0f)))
        ASSERT_TRUE(sound(radiance)) << name << " " << under;
    }
  }
}

TEST(ShadeBuffers, AreHiddenByGroundBeforeThem) {
  const View view = camera();
  const Scene scene = chequered();
  const Material clay = material_preset("clay", 1.0f);
  const SurfaceBuffers far = even(view.width, view.height, 100.0f, {0, 1, 0}, 0.5f);
  const Image<vec3> picture = shade(view, {}, far, scene, clay);
  EXPECT_LT(glm::length(picture(30, 40) - scene.radiance(view.ray({30.5f, 40.5f}), view.pixel_size(1.0f))), 1e-6f);
}

TEST(ShadeBuffers, TakeTheColoursOfTheParticles) {
  const View view = camera();
  const Scene scene = chequered();
  SurfaceBuffers buffers = even(view.width, view.height, 4.0f, {0, 1, 0}, 2.0f);
  buffers.colour = Image<vec3>(view.width, view.height, {0.9f, 0.1f, 0.1f});
  for (const char* name : {"water", "plastic", "clay"}) {
    const vec3 seen = shade(view, {}, buffers, scene, material_preset(name, 1.0f))(30, 30);
    EXPECT_GT(seen.x, 1.5f * seen.y) << name;
    EXPECT_GT(seen.x, 1.5f * seen.z) << name;
  }
}

TEST(ShadeBuffers, MustHaveThePicturesSize) {
  const View view = camera();
  SurfaceBuffers buffers = wavy(view);
  buffers.thickness = Image<float>(3, 3);
  EXPECT_THROW(shade(view, {}, buffers, chequered(), Material{}), Error);
  const vec2 points[] = {{1, 1}, {2, 2}};
  EXPECT_THROW(shade(view, points, wavy(view), chequered(), Material{}), Error);
}

TEST(ShadeBuffers, AddARowToTheTimes) {
  const View view = camera(8, 8);
  StageTimes times;
  shade(view, {}, even(8, 8, 4.0f, {0, 1, 0}, 1.0f), chequered(), Material{}, {}, &times);
  ASSERT_EQ(times.rows().size(), 1u);
  EXPECT_EQ(times.rows()[0].first, "shade");
}

TEST(Materials, AreKnownByTheirNames) {
  for (const std::string& name : material_names()) {
    const Material material = material_preset(name, 2.0f);
    EXPECT_EQ(material.name, name);
    EXPECT_GT(material.ior, 1.0f);
  }
  try {
    material_preset("marble", 1.0f);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
    EXPECT_NE(std::string(error.what()).find("milk"), std::string::npos) << "the message lists what there is";
  }
  EXPECT_THROW(material_preset("water", 0.0f), Error);
}

TEST(Materials, TintWaterOverTheirScaleRedMost) {
  for (const float scale : {0.1f, 1.0f, 25.0f}) {
    const Material water = material_preset("water", scale);
    const vec3 sigma = (water.extinction + water.scattering) * scale;
    EXPECT_LT(std::exp(-sigma.x), 0.6f);
    EXPECT_GT(std::exp(-sigma.z), 0.5f);
    EXPECT_GT(sigma.x, sigma.y);
    EXPECT_GT(sigma.y, sigma.z);
  }
}

TEST(Materials, MustBePossible) {
  Material material;
  material.ior = 1.0f;
  const View view = camera(8, 8);
  EXPECT_THROW(shade(view, {}, even(8, 8, 4.0f, {0, 1, 0}, 1.0f), chequered(), material), Error);
  material = Material{};
  material.extinction.y = -1.0f;
  EXPECT_THROW(shade(view, {}, even(8, 8, 4.0f, {0, 1, 0}, 1.0f), chequered(), material), Error);
}

}  // namespace
}  // namespace meniscus
