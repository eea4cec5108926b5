// What covers the ground, and the mirror image of lamps in its coat.
#include <gtest/gtest.h>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>

#include "meniscus/scene.h"

namespace meniscus {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

/// A smooth pattern of everything that a cover may change.
class Pattern : public GroundCover {
 public:
  explicit Pattern(float roughness = 0.4f) : roughness_(roughness) {}
  void cover(std::span<const vec3> points, std::span<const vec3> directions, std::span<const float> widths,
             std::span<SolidHit> hits) const override {
    for (std::size_t i = 0; i < hits.size(); ++i) {
      const vec3 p = points[i];
      hits[i].albedo = vec3{0.5f} + 0.3f * vec3{std::sin(3 * p.x), std::cos(2 * p.z), std::sin(p.x + p.z)} -
                       0.1f * std::min(widths[i], 1.0f);
      hits[i].roughness = std::min(1.0f, roughness_ + 0.1f * (1 + std::sin(p.x)));
      hits[i].ior = 1.333f;
      const vec3 bent = glm::normalize(hits[i].face_normal + vec3{0.05f * std::sin(4 * p.x), 0, 0});
      if (glm::dot(bent, directions[i]) < -0.01f) hits[i].normal = bent;
    }
  }

 private:
  float roughness_;
};

Environment sky() {
  static const Environment environment{EnvironmentOptions{}};
  return environment;
}

float largest(vec3 v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

Scene street(std::shared_ptr<const GroundCover> cover) {
  Ground ground;
  ground.square = 0.4f;
  ground.fade_radius = 30;
  Scene scene(sky(), ground);
  SolidMaterial material;
  material.albedo = {0.2f, 0.5f, 0.9f};
  scene.set_solids({{make_solid(box_mesh({-1, 0, -3}, {1, 0.2f, -1})), glm::mat4{1.0f}, material, true},
                    {make_solid(sphere_mesh({1.5f, 0.5f, -2}, 0.5f)), glm::mat4{1.0f}, material, false}});
  Tank tank;
  tank.style = TankStyle::tiled;
  tank.inside = {{-3, -0.4f, -2}, {-2, 0, -1}};
  scene.set_tank(tank);
  scene.set_lamps({{{2, 3, -4}, vec3{4.0f}}});
  scene.set_ground_cover(std::move(cover));
  return scene;
}

View view() { return perspective_view({0.3f, 1.4f, 3}, {-0.2f, 0, -2}, {0, 1, 0}, 1.1f, 96, 64); }

std::vector<Ray> rays_of(const View& view) {
  std::vector<Ray> rays;
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x)
      rays.push_back(view.ray({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f}));
  return rays;
}

TEST(GroundCover, IsTheSameForOneRayAndForMany) {
  for (const float roughness : {0.1f, 0.85f, 1.0f}) {
    const Scene scene = street(std::make_shared<Pattern>(roughness));
    const View from = view();
    const Beam beam{0, from.pixel_size(1)};
    const std::vector<Ray> rays = rays_of(from);
    std::vector<SolidHit> hits(rays.size()), others(rays.size());
    std::vector<vec3> radiance(rays.size()), albedo(rays.size());
    std::vector<float> distance(rays.size()), presence(rays.size());
    std::vector<std::int32_t> face(rays.size());
    scene.hits(rays, beam, hits);
    scene.radiance(rays, beam, radiance);
    scene.face_hits(rays, beam, {distance, face, albedo, presence, others});
    const SceneBuffers seen = scene.see(from);
    std::size_t different = 0, covered = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const SolidHit one = scene.hit(rays[i], beam);
      covered += one.covered;
      bool same = one.found() == hits[i].found() && one.covered == hits[i].covered;
      if (one.found() && same) {
        same = largest(one.albedo - hits[i].albedo) < 4e-3f && largest(one.normal - hits[i].normal) < 2e-3f &&
               std::abs(one.roughness - hits[i].roughness) < 1e-3f && one.ior == hits[i].ior &&
               std::abs(one.presence - hits[i].presence) < 1e-3f && largest(seen.albedo[i] - one.albedo) < 4e-3f &&
               largest(seen.normal[i] - (one.covered ? one.face_normal : one.normal)) < 2e-3f;  // without grain
        if (one.covered)
          same = same && face[i] == FaceHits::kOther && others[i].albedo == hits[i].albedo &&
                 others[i].roughness == hits[i].roughness && others[i].presence == hits[i].presence;
      }
      const vec3 light = scene.radiance(rays[i], beam);
      same = same && largest(light - radiance[i]) < 1e-2f * (0.2f + largest(light)) &&
             largest(light - seen.radiance[i]) < 1e-2f * (0.2f + largest(light));
      different += !same;
    }
    EXPECT_GT(covered, rays.size() / 4);
    EXPECT_LE(different * 500, rays.size()) << roughness;
  }
}

TEST(GroundCover, LiesOnTheGroundAndOnCoveredSolidsAlone) {
  const Scene scene = street(std::make_shared<Pattern>());
  const auto down = [&](float x, float z) { return scene.hit({{x, 3, z}, {0, -1, 0}}); };
  EXPECT_EQ(down(0, 2).ior, 1.333f) << "ground";
  EXPECT_EQ(down(0, -2).ior, 1.333f) << "the covered box";
  EXPECT_EQ(down(1.5f, -2).ior, 1.5f) << "the ball";
  const SolidHit floor = down(-2.5f, -1.5f);
  EXPECT_FALSE(floor.covered) << "the tank's opening";
  EXPECT_NEAR(floor.distance, 3.4f, 1e-4f);
}

TEST(GroundCover, LeavesDistancesAsTheyAre) {
  const Scene bare = street(nullptr), covered = street(std::make_shared<Pattern>());
  const std::vector<Ray> rays = rays_of(view());
  std::vector<float> before(rays.size()), after(rays.size());
  bare.distances(rays, before);
  covered.distances(rays, after);
  EXPECT_EQ(before, after);
  EXPECT_EQ(covered.see(view()).depth.height(), 64);
  for (std::size_t i = 0; i < rays.size(); i += 7) EXPECT_EQ(bare.distance(rays[i]), covered.distance(rays[i]));
}

/// A coat of one roughness, black below.
class BlackCoat : public GroundCover {
 public:
  BlackCoat(float roughness, float ior) : roughness_(roughness), ior_(ior) {}
  void cover(std::span<const vec3>, std::span<const vec3>, std::span<const float>,
             std::span<SolidHit> hits) const override {
    for (SolidHit& hit : hits) {
      hit.albedo = vec3{0.0f};
      hit.roughness = roughness_;
      hit.ior = ior_;
    }
  }

 private:
  float roughness_, ior_;
};

Scene lamp_over(float roughness, float ior, vec3 lamp) {
  static const Environment night = [] {
    EnvironmentOptions options;
    options.radiance_scale = 0;
    return Environment(options);
  }();
  Scene scene(night, Ground{});
  scene.set_lamps({{lamp, vec3{1.0f}}});
  scene.set_ground_cover(std::make_shared<BlackCoat>(roughness, ior));
  return scene;
}

TEST(LampGlare, GivesBackNoMoreLightThanFallsOnTheCoat) {
  for (const float roughness : {0.3f, 0.6f, 0.9f})
    for (const float slant : {0.2f, 0.9f, 1.3f}) {
      const vec3 towards{std::sin(slant), std::cos(slant), 0};
      const Scene scene = lamp_over(roughness, 30.0f, 50.0f * towards);
      const double irradiance = std::cos(slant) / 2500.0;
      double leaves = 0;
      constexpr int kRings = 80, kSpokes = 160;
      for (int i = 0; i < kRings; ++i)
        for (int j = 0; j < kSpokes; ++j) {
          const float z = (static_cast<float>(i) + 0.5f) / kRings,
                      phi = (static_cast<float>(j) + 0.5f) * 2 * kPi / kSpokes, r = std::sqrt(1 - z * z);
          const vec3 out{r * std::cos(phi), z, r * std::sin(phi)};
          leaves +=
              static_cast<double>(z * scene.radiance({out, -out}, 0.0f).y) * 2 * std::numbers::pi / (kRings * kSpokes);
        }
      EXPECT_LT(leaves, irradiance * (1 - static_cast<double>(roughness)) * 1.02) << roughness << ", " << slant;
      // A coat that mirrors nearly all gives most of it back, but for what facets hide from each other.
      EXPECT_GT(leaves, irradiance * (1 - static_cast<double>(roughness)) * 0.5) << roughness << ", " << slant;
    }
}

TEST(LampGlare, IsBrightestInTheMirrorDirectionAndLongerThanWide) {
  const vec3 eye{0, 1.5f, 0}, lamp{0, 1.5f, -12};
  const Scene scene = lamp_over(0.3f, 1.333f, lamp);
  const auto at = [&](float x, float z) { return scene.radiance({eye, glm::normalize(vec3{x, 0, z} - eye)}, 0.0f).y; };
  const float peak = at(0, -6);
  EXPECT_GT(peak, 0.0f);
  const auto angle_to_half = [&](auto move) {
    for (float a = 0; a < 0.3f; a += 0.0005f)
      if (move(a) < 0.5f * peak) return a;
    return 0.3f;
  };
  const float down = std::atan2(1.5f, 6.0f);
  const float tall = angle_to_half([&](float a) { return at(0, -1.5f / std::tan(down + a)); });
  const float wide = angle_to_half([&](float a) { return at(std::tan(a) * 6.2f, -6); });
  EXPECT_GT(tall, 2 * wide);
  EXPECT_LT(lamp_over(0.6f, 1.333f, lamp).radiance({eye, glm::normalize(vec3{0, 0, -6} - eye)}, 0.0f).y, peak);
}

TEST(LampGlare, IsHiddenByWhatStandsBeforeTheLamp) {
  Scene scene = lamp_over(0.3f, 1.333f, {0, 1.5f, -12});
  const Ray ray{{0, 1.5f, 0}, glm::normalize(vec3{0, -1.5f, -6})};
  EXPECT_GT(scene.radiance(ray, 0.0f).y, 0.0f);
  scene.set_solids({{make_solid(box_mesh({-3, 0.2f, -11}, {3, 3, -10.8f})), glm::mat4{1.0f}, std::nullopt}});
  EXPECT_EQ(scene.radiance(ray, 0.0f).y, 0.0f);
}

}  // namespace
}  // namespace meniscus
