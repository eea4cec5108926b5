// Rays in blocks against the same rays one by one.
#include <gtest/gtest.h>
#include <hwy/targets.h>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "meniscus/scene.h"

namespace meniscus {
namespace {

const Environment& sky() {
  static const Environment environment{EnvironmentOptions{}};
  return environment;
}

/// A ground with everything that a ground may have.
Ground ground_along(vec3 up, float height, float fade) {
  Ground ground;
  ground.up = up;
  ground.height = height;
  ground.square = 0.13f;
  ground.albedo = {0.8f, 0.7f, 0.6f};
  ground.second_albedo = {0.1f, 0.2f, 0.3f};
  ground.fade_radius = fade;
  return ground;
}

Tank tank_along(vec3 up, TankStyle style) {
  Tank tank;
  tank.style = style;
  tank.up = up;
  tank.inside = {{-0.5f, -0.4f, -0.6f}, {0.7f, 0.6f, 0.5f}};
  return tank;
}

std::vector<PlacedSolid> bodies(float roughness) {
  SolidMaterial material;
  material.albedo = {0.2f, 0.5f, 0.9f};
  material.roughness = roughness;
  return {{make_solid(sphere_mesh({0.1f, 0.0f, -0.1f}, 0.25f, 24)), glm::mat4{1.0f}, material},
          {make_solid(box_mesh({-0.1f, -0.1f, -0.1f}, {0.1f, 0.1f, 0.3f})),
           glm::rotate(glm::translate(glm::mat4{1.0f}, vec3{-0.25f, 0.2f, 0.1f}), 0.5f, vec3{1, 1, 0}), material}};
}

/// Light as under waves: different everywhere.
class Stripes : public WaterLight {
  Light at(vec3 point, vec3 normal) const override {
    Light light;
    light.sun = vec3{0.5f + 0.4f * std::sin(9.0f * point.x)};
    light.sky = vec3{0.5f + 0.4f * std::sin(7.0f * point.y)};
    light.refracted = vec3{0.1f, 0.2f, 0.3f} * (1.0f + normal.z);
    light.lamps = vec3{0.7f};
    return light;
  }
};

/// Rays from eyes around, inside, below and far away, the pixels of small pictures.
std::vector<Ray> rays_of_many_eyes(int pixels) {
  std::vector<Ray> rays;
  for (const vec3 eye :
       {vec3{1.5f, 1.2f, 2.0f}, vec3{-2.0f, 0.9f, 1.4f}, vec3{0.05f, 0.3f, 0.4f}, vec3{0.2f, -0.3f, 0.0f},
        vec3{1.0f, -1.5f, 0.7f}, vec3{0.3f, 2.5f, 0.1f}, vec3{-14.0f, 9.0f, 11.0f}}) {
    const View view = perspective_view(eye, {0.1f, 0.05f, 0.0f}, {0, 1, 0}, 0.9f, pixels, pixels);
    for (int y = 0; y < pixels; ++y)
      for (int x = 0; x < pixels; ++x)
        rays.push_back(view.ray({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f}));
  }
  return rays;
}

float largest(vec3 v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

/// Rays that meet an edge may go either way: one in two thousand is let go, and no more.
struct Differences {
  std::size_t all = 0, different = 0;
  void count(bool same) {
    ++all;
    if (!same) ++different;
  }
  bool few() const { return different * 2000 <= all; }
};

/// Field by field the same as hits().
void expect_faces_as_hits(const Scene& scene, const std::vector<Ray>& rays, Beam beam,
                          const std::vector<SolidHit>& hits) {
  std::vector<float> distance(rays.size()), presence(rays.size());
  std::vector<std::int32_t> face(rays.size());
  std::vector<vec3> albedo(rays.size());
  std::vector<SolidHit> others(rays.size());
  scene.face_hits(rays, beam, {distance, face, albedo, presence, others});
  std::size_t different = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    SolidHit one;
    one.distance = distance[i];
    if (face[i] == FaceHits::kOther) {
      one = others[i];
    } else if (face[i] != FaceHits::kNothing) {
      one.face_normal[face[i] / 2] = face[i] % 2 == 1 ? 1.0f : -1.0f;
      one.normal = one.face_normal;
      one.albedo = albedo[i];
      one.presence = presence[i];
    }
    const SolidHit& other = hits[i];
    if (!(one.distance == other.distance && distance[i] == other.distance && one.normal == other.normal &&
          one.face_normal == other.face_normal && one.albedo == other.albedo && one.presence == other.presence &&
          one.roughness == other.roughness && one.ior == other.ior))
      ++different;
  }
  EXPECT_EQ(different, 0u);
}

void expect_as_one_by_one(const Scene& scene, const std::vector<Ray>& rays, Beam beam, const std::string& what) {
  std::vector<SolidHit> hits(rays.size());
  std::vector<vec3> radiance(rays.size());
  std::vector<float> seen(rays.size()), distances(rays.size());
  scene.hits(rays, beam, hits);
  expect_faces_as_hits(scene, rays, beam, hits);
  scene.radiance(rays, beam, radiance, seen);
  scene.distances(rays, distances);
  Differences of_hits, of_radiance, of_distances;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const SolidHit one = scene.hit(rays[i], beam);
    const SolidHit& many = hits[i];
    const bool same =
        one.found() == many.found() &&
        (!one.found() ||
         (std::abs(one.distance - many.distance) <= 2e-5f * one.distance && largest(one.normal - many.normal) < 1e-3f &&
          largest(one.face_normal - many.face_normal) < 1e-4f && largest(one.albedo - many.albedo) < 4e-3f &&
          one.roughness == many.roughness && one.ior == many.ior && std::abs(one.presence - many.presence) < 1e-3f));
    of_hits.count(same);
    EXPECT_EQ(seen[i], many.distance);
    const float distance = scene.distance(rays[i]);
    of_distances.count(distance == distances[i] || std::abs(distance - distances[i]) < 2e-5f * distance);
    const vec3 light = scene.radiance(rays[i], beam);
    of_radiance.count(largest(light - radiance[i]) < 4e-3f * (0.2f + largest(light)));
  }
  EXPECT_TRUE(of_hits.few()) << what << ": " << of_hits.different << " of " << of_hits.all << " hits differ";
  EXPECT_TRUE(of_radiance.few()) << what << ": " << of_radiance.different << " radiances differ";
  EXPECT_TRUE(of_distances.few()) << what << ": " << of_distances.different << " distances differ";
}

TEST(RayBlocks, MeetTanksAndGroundAsRaysOneByOneDo) {
  const auto rays = rays_of_many_eyes(45);
  for (const vec3 up : {vec3{1, 0, 0}, vec3{0, 1, 0}, vec3{0, 0, 1}})
    for (const TankStyle style : {TankStyle::none, TankStyle::glass, TankStyle::tiled})
      for (const float fade : {0.0f, 6.0f}) {
        const Tank tank = tank_along(up, style);
        // On the tank's floor, and half way up its walls.
        for (const float height : {glm::dot(tank.inside.low, up), 0.1f}) {
          Scene scene(sky(), ground_along(up, height, fade));
          scene.set_tank(tank);
          expect_as_one_by_one(scene, rays, {0.001f, 0.002f},
                               "up " + std::to_string(up.x) + std::to_string(up.y) + " style " +
                                   std::to_string(static_cast<int>(style)) + " fade " + std::to_string(fade));
        }
      }
}

TEST(RayBlocks, MeetSolidsAndTheirShadowsAsRaysOneByOneDo) {
  const auto rays = rays_of_many_eyes(30);
  for (const TankStyle style : {TankStyle::none, TankStyle::glass, TankStyle::tiled})
    for (const float roughness : {1.0f, 0.3f}) {
      Scene scene(sky(), ground_along({0, 1, 0}, -0.4f, 9.0f));
      scene.set_tank(tank_along({0, 1, 0}, style));
      scene.set_solids(bodies(roughness));
      expect_as_one_by_one(scene, rays, {0.0f, 0.004f}, "style " + std::to_string(static_cast<int>(style)));
    }
}

TEST(RayBlocks, AreLitByWaterAndLampsAsRaysOneByOneAre) {
  const auto rays = rays_of_many_eyes(30);
  for (const TankStyle style : {TankStyle::none, TankStyle::glass, TankStyle::tiled}) {
    Scene scene(sky(), ground_along({0, 1, 0}, -0.4f, 0.0f));
    scene.set_tank(tank_along({0, 1, 0}, style));
    scene.set_solids(bodies(1.0f));
    scene.set_lamps({{{0.2f, 1.4f, 0.3f}, {3.0f, 2.0f, 1.0f}}, {{-1.5f, 0.5f, 0.0f}, {0.5f, 1.0f, 2.0f}}});
    scene.set_water_light(std::make_shared<Stripes>());
    expect_as_one_by_one(scene, rays, {0.0f, 0.004f}, "style " + std::to_string(static_cast<int>(style)));
  }
}

TEST(RayBlocks, MeetWhatRaysAlongTheAxesMeet) {
  std::vector<Ray> rays;
  for (int axis = 0; axis < 3; ++axis)
    for (const float sign : {-1.0f, 1.0f})
      for (float a = -0.93f; a < 1.0f; a += 0.17f)
        for (float b = -0.91f; b < 1.0f; b += 0.13f)
          for (const float from : {0.0f, -2.0f, 2.0f}) {
            Ray ray{vec3{a, b, from}, vec3{0.0f}};
            ray.direction[axis] = sign;
            rays.push_back(ray);
          }
  for (const TankStyle style : {TankStyle::glass, TankStyle::tiled}) {
    Scene scene(sky(), ground_along({0, 1, 0}, -0.4f, 0.0f));
    scene.set_tank(tank_along({0, 1, 0}, style));
    scene.set_solids(bodies(1.0f));
    expect_as_one_by_one(scene, rays, {}, "style " + std::to_string(static_cast<int>(style)));
  }
}

Scene everything() {
  Scene scene(sky(), ground_along({0, 1, 0}, -0.4f, 6.0f));
  scene.set_tank(tank_along({0, 1, 0}, TankStyle::tiled));
  scene.set_solids(bodies(1.0f));
  return scene;
}

TEST(RayBlocks, DoNotCareWhatElseIsInTheList) {
  const Scene scene = everything();
  const auto rays = rays_of_many_eyes(20);
  std::vector<vec3> together(rays.size());
  scene.radiance(rays, {0.0f, 0.003f}, together);
  Differences differences;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    vec3 alone;
    scene.radiance({&rays[i], 1}, {0.0f, 0.003f}, {&alone, 1});
    differences.count(largest(alone - together[i]) < 1e-5f);
  }
  EXPECT_TRUE(differences.few()) << differences.different;
}

TEST(RayBlocks, MayBeNone) {
  everything().radiance(std::span<const Ray>{}, Beam{}, {});
  everything().distances({}, {});
  everything().hits({}, {}, {});
  everything().face_hits({}, {}, {});
}

TEST(RayBlocks, RefuseListsOfDifferentLengths) {
  const std::vector<Ray> rays(3, Ray{{0, 1, 0}, {0, -1, 0}});
  std::vector<vec3> radiance(2);
  std::vector<float> distances(4);
  std::vector<SolidHit> hits(2);
  EXPECT_THROW(everything().radiance(rays, {}, radiance), Error);
  EXPECT_THROW(everything().distances(rays, distances), Error);
  EXPECT_THROW(everything().hits(rays, {}, hits), Error);
  EXPECT_THROW(everything().face_hits(rays, {}, {}), Error);
}

SceneBuffers seen_at(const Scene& scene, int size) {
  return scene.see(perspective_view({1.5f, 1.2f, 2.0f}, {0.1f, 0.05f, 0.0f}, {0, 1, 0}, 0.7f, size, size - 3));
}

TEST(SceneView, IsWhatItsRaysShow) {
  for (const View& view : {perspective_view({1.5f, 1.2f, 2.0f}, {0.1f, 0.05f, 0.0f}, {0, 1, 0}, 0.7f, 101, 67),
                           orthographic_view({1.0f, 1.5f, 1.2f}, {0, 0, 0}, {0, 1, 0}, 2.0f, 61, 83),
                           cube_view({0.3f, 0.35f, 0.3f}, 29)}) {
    const Scene scene = everything();
    const SceneBuffers seen = scene.see(view);
    const Beam beam = view.projection == Projection::orthographic ? Beam{view.pixel_size(1.0f), 0.0f}
                                                                  : Beam{0.0f, view.pixel_size(1.0f)};
    Differences differences;
    for (int y = 0; y < view.height; ++y)
      for (int x = 0; x < view.width; ++x) {
        const Ray ray = view.ray({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
        const SolidHit hit = scene.hit(ray, beam);
        const vec3 light = scene.radiance(ray, beam);
        const bool same_depth = hit.found() ? std::abs(hit.distance - seen.depth(x, y)) <= 2e-5f * hit.distance
                                            : seen.depth(x, y) == hit.distance;
        differences.count(same_depth && largest(hit.normal - seen.normal(x, y)) < 1e-3f &&
                          largest(hit.albedo - seen.albedo(x, y)) < 4e-3f &&
                          largest(light - seen.radiance(x, y)) < 4e-3f * (0.2f + largest(light)));
      }
    EXPECT_TRUE(differences.few()) << differences.different << " of " << differences.all;
  }
}

TEST(SceneView, IsTheSameForAnyNumberOfThreads) {
  const Scene scene = everything();
  const SceneBuffers many = seen_at(scene, 150);
  const ThreadLimit limit(1);
  const SceneBuffers one = seen_at(scene, 150);
  for (std::size_t i = 0; i < one.depth.size(); ++i) {
    ASSERT_EQ(one.depth[i], many.depth[i]);
    ASSERT_EQ(one.radiance[i], many.radiance[i]);
    ASSERT_EQ(one.albedo[i], many.albedo[i]);
  }
}

TEST(SceneView, IsTheSameWithEveryInstructionSetToRounding) {
  const Scene scene = everything();
  const SceneBuffers best = seen_at(scene, 120);
  hwy::SetSupportedTargetsForTest(0);
  const std::int64_t supported = hwy::SupportedTargets();
  for (std::int64_t left = supported; left != 0; left &= left - 1) {
    hwy::SetSupportedTargetsForTest(static_cast<decltype(hwy::SupportedTargets())>(left & -left));
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    const SceneBuffers other = seen_at(scene, 120);
    Differences differences;
    for (std::size_t i = 0; i < best.depth.size(); ++i)
      differences.count(largest(best.radiance[i] - other.radiance[i]) < 4e-3f &&
                        (best.depth[i] == other.depth[i] || std::abs(best.depth[i] - other.depth[i]) < 1e-4f));
    EXPECT_TRUE(differences.few()) << hwy::TargetName(static_cast<decltype(hwy::SupportedTargets())>(left & -left))
                                   << ": " << differences.different;
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace
}  // namespace meniscus
