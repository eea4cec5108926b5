// Pictures shaded many pixels at a time against the same pixels one by one.
#include <gtest/gtest.h>
#include <hwy/targets.h>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "fixtures.h"
#include "shading/normal_variance.h"
#include "shading/refraction.h"
#include "shading/sample.h"

namespace meniscus {
namespace {

using namespace tests;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

const Environment& sky() {
  static const Environment environment{EnvironmentOptions{}};
  return environment;
}

Scene on_ground(float square = 0.3f) {
  Ground ground;
  ground.square = square;
  ground.fade_radius = 20.0f;
  return Scene(sky(), ground);
}

View camera(int width = 151, int height = 97) {
  return perspective_view({0.0f, 1.2f, 3.2f}, {0, 0.35f, 0}, {0, 1, 0}, 0.6f, width, height);
}

/// A wavy pool with spheres over it, whose undersides look down to the ground; fractions of pixels at its rim, pixels
/// without a thickness and with normals of no use.
SurfaceBuffers pool(const View& view) {
  SurfaceBuffers water = even(view.width, view.height, kInfinity, vec3{0.0f}, 0.0f);
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x) {
      const Ray ray = view.ray({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
      float& depth = water.depth(x, y);
      const float down = (0.3f - ray.origin.y) / ray.direction.y;
      const vec3 p = ray.origin + down * ray.direction;
      if (down > 0 && p.x * p.x + p.z * p.z < 1.0f) {
        depth = down;
        water.normal(x, y) = glm::normalize(vec3{0.3f * std::sin(20 * p.x + 3 * p.z), 1, 0.3f * std::cos(17 * p.z)});
        water.thickness(x, y) = (x * y) % 11 == 0 ? 0.0f : 0.4f;
      }
      for (int k = 0; k < 7; ++k) {
        const vec3 to_eye =
            ray.origin - vec3{0.3f * static_cast<float>(k) - 0.9f, 0.2f + 0.1f * static_cast<float>(k), 0.4f};
        const float b = glm::dot(to_eye, ray.direction), d = b * b - glm::dot(to_eye, to_eye) + 0.02f;
        if (!(d > 0) || -b - std::sqrt(d) > depth) continue;
        depth = -b - std::sqrt(d);
        water.normal(x, y) = glm::normalize(to_eye + depth * ray.direction);
        water.thickness(x, y) = 2.0f * std::sqrt(d);
      }
      water.coverage(x, y) = depth < kInfinity ? ((x + y) % 13 == 0 ? 0.4f : 1.0f) : 0.0f;
      if (depth < kInfinity && x % 29 == 3) water.normal(x, y) = y % 2 == 0 ? vec3{0.0f} : -water.normal(x, y);
      if (depth < kInfinity && x % 31 == 5) water.thickness(x, y) = y % 2 == 0 ? kInfinity : std::nanf("");
    }
  return water;
}

/// The picture by the functions for one pixel.
Image<vec3> one_by_one(const View& view, const SurfaceBuffers& water, const Scene& scene, const Material& material,
                       FresnelFormula fresnel = FresnelFormula::exact) {
  const Beam beam = view.projection == Projection::perspective ? Beam{0.0f, view.pixel_size(1.0f)}
                                                               : Beam{view.pixel_size(1.0f), 0.0f};
  const NormalVariance variance(view, {}, water.normal);
  Image<vec3> picture(view.width, view.height);
  for (std::size_t i = 0; i < picture.size(); ++i) {
    const auto width = static_cast<std::size_t>(view.width);
    Sample sample;
    sample.ray = view.ray({static_cast<float>(i % width) + 0.5f, static_cast<float>(i / width) + 0.5f});
    sample.depth = water.depth[i];
    sample.beam = beam;
    sample.fresnel = fresnel;
    sample.normal_variance = variance.at(i);
    const float distance = scene.distance(sample.ray), thickness = water.thickness[i];
    sample.thickness = thickness > 0 && thickness < kInfinity ? thickness : 0.0f;
    vec3 seen = scene.radiance(sample.ray, beam);
    if (!(distance < kInfinity) && scene.environment().sun_visible())
      seen += glm::min(scene.environment().sun_glare(sample.ray.direction, beam.spread * beam.spread), vec3{200.0f});
    if (water.coverage[i] > 0 && distance >= sample.depth) {
      sample.normal = facing(water.normal[i], sample.ray.direction);
      seen = glm::mix(seen,
                      material.transparent ? transparent_radiance(sample, scene, material)
                                           : opaque_radiance(sample, scene, material),
                      water.coverage[i]);
    }
    picture[i] = seen;
  }
  return picture;
}

/// Pixels in which a channel differs by more than a thousandth.
int different(const Image<vec3>& a, const Image<vec3>& b) {
  int count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    bool same = true;
    for (int c = 0; c < 3; ++c) same = same && std::abs(a[i][c] - b[i][c]) <= 1e-3f * std::max(a[i][c], 1e-3f);
    if (!same) ++count;
  }
  return count;
}

TEST(ShadeBlocks, ShowWaterOnGroundAsPixelsOneByOneDo) {
  const SurfaceBuffers water = pool(camera());
  for (const char* name : {"water", "ink", "milk", "clay", "plastic"}) {
    const Material material = material_preset(name, 1.0f);
    EXPECT_EQ(different(one_by_one(camera(), water, on_ground(), material),
                        shade(camera(), {}, water, on_ground(), material)),
              0)
        << name;
  }
}

TEST(ShadeBlocks, ShowWaterBySchlickAndWithARoughSurface) {
  const SurfaceBuffers water = pool(camera());
  Material material = material_preset("water", 1.0f);
  material.roughness = 0.3f;
  OpticsInputs optics;
  optics.options.fresnel = FresnelFormula::schlick;
  EXPECT_EQ(different(one_by_one(camera(), water, on_ground(0), material, FresnelFormula::schlick),
                      shade(camera(), {}, water, on_ground(0), material, optics)),
            0);
}

TEST(ShadeBlocks, ShowTheSunAndItsImage) {
  EnvironmentOptions options;
  options.sun_direction = {0.05f, 0.1f, -1.0f};
  Ground ground;
  ground.visible = false;
  const Scene scene(Environment(options), ground);
  const View view = perspective_view({0.0f, 0.6f, 3.2f}, {0, 0.6f, 0}, {0, 1, 0}, 0.7f, 151, 97);
  const Image<vec3> expected = one_by_one(view, pool(view), scene, material_preset("water", 1.0f));
  float brightest = 0;
  for (const vec3 v : expected) brightest = std::max(brightest, v.x);
  ASSERT_GT(brightest, 20.0f);
  EXPECT_EQ(different(expected, shade(view, {}, pool(view), scene, material_preset("water", 1.0f))), 0);
}

/// Where rays meet edges of solids rounding decides which way they go.
TEST(ShadeBlocks, ShowBodiesAndTanksAroundTheWaterAsPixelsOneByOneDo) {
  const View view = camera();
  const SurfaceBuffers water = pool(view);
  Scene scene = on_ground();
  SolidMaterial coat;
  coat.roughness = 0.2f;
  scene.set_solids({{make_solid(sphere_mesh({0.2f, 0.45f, 0.3f}, 0.3f)), glm::mat4{1.0f}, std::nullopt},
                    {make_solid(box_mesh({-0.8f, 0.0f, -0.3f}, {-0.4f, 0.5f, 0.2f})), glm::mat4{1.0f}, coat}});
  scene.set_lamps({{{0.5f, 2.0f, 1.0f}, vec3{2.0f}}});
  const Material material = material_preset("water", 1.0f);
  const auto few = static_cast<int>(water.depth.size() / 200);
  EXPECT_LE(different(one_by_one(view, water, scene, material), shade(view, {}, water, scene, material)), few);
  Tank tank;
  tank.style = TankStyle::tiled;
  tank.inside = {{-1.1f, 0, -1.1f}, {1.1f, 0.8f, 1.1f}};
  scene.set_tank(tank);
  EXPECT_LE(different(one_by_one(view, water, scene, material), shade(view, {}, water, scene, material)), few);
}

TEST(ShadeBlocks, ShowTheSameForPointsInAnyOrderAndOtherProjections) {
  const Scene scene = on_ground();
  const Material material = material_preset("water", 1.0f);
  View view = orthographic_view({0.0f, 1.2f, 3.2f}, {0, 0.35f, 0}, {0, 1, 0}, 2.0f, 150, 90);
  const SurfaceBuffers water = pool(view);
  const Image<vec3> picture = shade(view, {}, water, scene, material);
  EXPECT_EQ(different(one_by_one(view, water, scene, material), picture), 0);

  // Pixel centres as points, the last one first; with a width that is no multiple of anything.
  std::vector<vec2> points;
  SurfaceBuffers listed = even(150 * 90, 1, 0, vec3{0.0f}, 0);
  for (std::size_t i = water.depth.size(); i-- > 0;) {
    const std::size_t k = points.size();
    points.push_back({static_cast<float>(i % 150) + 0.5f, static_cast<float>(i / 150) + 0.5f});
    listed.depth[k] = water.depth[i];
    listed.normal[k] = water.normal[i];
    listed.thickness[k] = water.thickness[i];
    listed.coverage[k] = water.coverage[i];
  }
  Image<vec3> turned = shade(view, points, listed, scene, material);
  std::reverse(turned.begin(), turned.end());
  EXPECT_EQ(different(picture, turned), 0);
}

TEST(ShadeBlocks, ShowTheSameByEveryInstructionSet) {
  const SurfaceBuffers water = pool(camera());
  const Material material = material_preset("water", 1.0f);
  const Image<vec3> expected = one_by_one(camera(), water, on_ground(), material);
  hwy::SetSupportedTargetsForTest(0);
  const std::int64_t supported = hwy::SupportedTargets();
  for (std::int64_t left = supported; left != 0; left &= left - 1) {
    const auto target = static_cast<decltype(hwy::SupportedTargets())>(left & -left);
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    EXPECT_EQ(different(expected, shade(camera(), {}, water, on_ground(), material)), 0) << hwy::TargetName(target);
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

TEST(ShadeBlocks, ShowTheSameBitsForAnyNumberOfThreads) {
  const View view = camera();
  const SurfaceBuffers water = pool(view);
  std::vector<Image<vec3>> pictures;
  for (const int threads : {1, 2, 5}) {
    const ThreadLimit limit(threads);
    pictures.push_back(shade(view, {}, water, on_ground(), material_preset("water", 1.0f)));
  }
  for (std::size_t i = 0; i < pictures[0].size(); ++i)
    ASSERT_TRUE(pictures[0][i] == pictures[1][i] && pictures[0][i] == pictures[2][i]) << i;
}

}  // namespace
}  // namespace meniscus
