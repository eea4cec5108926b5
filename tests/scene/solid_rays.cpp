#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <random>

#include "scene/scene_of.h"
#include "scene/solid.h"

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
using glm::dvec3;

vec3 random_vector(std::mt19937& random, float low, float high) {
  std::uniform_real_distribution<float> value(low, high);
  const float x = value(random), y = value(random);
  return {x, y, value(random)};
}

Mesh random_triangles(std::mt19937& random, int count) {
  Mesh mesh;
  for (int i = 0; i < count; ++i) {
    const vec3 middle = random_vector(random, -1, 1);
    for (int k = 0; k < 3; ++k) {
      mesh.corners.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
      mesh.positions.push_back(middle + random_vector(random, -0.3f, 0.3f));
    }
  }
  return mesh;
}

struct Nearest {
  double distance = std::numeric_limits<double>::infinity();
  dvec3 normal{0.0};
  double margin = 0;  ///< of the hit from the triangle's edges, in barycentric coordinates; of a near miss too
};

/// Every triangle of every placed solid in double precision, Cramer's rule.
Nearest brute_force(const std::vector<PlacedSolid>& solids, const Ray& ray) {
  Nearest nearest;
  double closest_call = 1;
  for (const PlacedSolid& placed : solids) {
    const Mesh& mesh = placed.solid->mesh();
    const glm::dmat4 world(placed.world_from_solid);
    for (std::size_t t = 0; t < mesh.corners.size(); t += 3) {
      dvec3 p[3];
      for (std::size_t k = 0; k < 3; ++k)
        p[k] = dvec3(world * glm::dvec4(dvec3(mesh.positions[mesh.corners[t + k]]), 1.0));
      const dvec3 a = p[1] - p[0], b = p[2] - p[0], d(ray.direction), s = dvec3(ray.origin) - p[0];
      const dvec3 n = glm::cross(a, b);
      const double det = -glm::dot(d, n);
      if (det == 0) continue;
      const dvec3 q = glm::cross(s, d);
      const double u = glm::dot(b, q) / det, v = -glm::dot(a, q) / det, distance = glm::dot(s, n) / det;
      const double margin = std::min({u, v, 1 - u - v});
      if (distance < 0) continue;
      closest_call = std::min(closest_call, std::abs(margin));
      if (margin < 0 || distance >= nearest.distance) continue;
      nearest.distance = distance;
      nearest.normal = glm::normalize(n) * (glm::dot(n, d) > 0 ? -1.0 : 1.0);
    }
  }
  nearest.margin = closest_call;
  return nearest;
}

TEST(Solids, LeaveAllLoopsTheirThreads) {
  static_cast<void>(make_solid(box_mesh(vec3{0.0f}, vec3{1.0f})));
  EXPECT_GE(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism),
            static_cast<std::size_t>(tbb::info::default_concurrency()));
}

TEST(SolidRays, MeetWhatTheSumOverAllTrianglesMeets) {
  std::mt19937 random(7);
  std::vector<PlacedSolid> solids;
  for (int i = 0; i < 4; ++i) {
    glm::mat4 world = glm::translate(glm::mat4(1.0f), random_vector(random, -2, 2));
    world = glm::rotate(world, 0.7f * static_cast<float>(i), random_vector(random, 0.1f, 1));
    // Stretched and sheared; every other one mirrored.
    world = glm::scale(world, vec3{i % 2 ? -1.5f : 0.6f, 1.2f, 0.8f});
    world[1][0] += 0.3f;
    solids.push_back({make_solid(random_triangles(random, 60)), world, {}});
  }
  const Scene scene = scene_of(solids);
  int hits = 0;
  for (int i = 0; i < 4000; ++i) {
    const vec3 origin = random_vector(random, -4, 4);
    const Ray ray{origin, glm::normalize(random_vector(random, -2, 2) - origin)};
    const Nearest expected = brute_force(solids, ray);
    if (expected.margin < 1e-4) continue;  // the edge of a triangle belongs to either side
    const SolidHit found = scene.hit(ray);
    ASSERT_EQ(found.found(), expected.distance < 1e9) << i;
    ASSERT_EQ(scene.distance(ray), found.distance);
    if (!found.found()) continue;
    ++hits;
    ASSERT_NEAR(found.distance, expected.distance, 1e-4 * (1 + expected.distance));
    ASSERT_LT(glm::length(dvec3(found.normal) - expected.normal), 1e-3);
    ASSERT_EQ(found.normal, found.face_normal);
    // Either end of the range cuts it off.
    ASSERT_GT(scene.hit(ray, {}, found.distance * 1.001f + 1e-4f).distance, found.distance);
    ASSERT_FALSE(scene.hit(ray, {}, 0, found.distance * 0.999f - 1e-4f).found());
    const vec3 point = ray.origin + found.distance * ray.direction;
    if (found.distance > 0.01f) {
      EXPECT_TRUE(scene.blocked(ray.origin, point + 0.01f * ray.direction)) << i;
      EXPECT_FALSE(scene.blocked(ray.origin, point)) << "the end's own surface does not count";
    }
    EXPECT_TRUE(found.distance < 1e-3f || scene.shadowed(ray.origin, ray.direction)) << i;
  }
  EXPECT_GT(hits, 500);
}

TEST(SolidRays, MeetASphereWhereItsEquationHasItsRoot) {
  const vec3 centre{0.3f, -0.2f, 0.5f};
  const Scene scene = scene_of({{make_solid(sphere_mesh(centre, 0.75f, 512)), glm::mat4(1.0f), {}}});
  std::mt19937 random(3);
  for (int i = 0; i < 2000; ++i) {
    const vec3 origin = 3.0f * glm::normalize(random_vector(random, -1, 1));
    const Ray ray{origin, glm::normalize(centre + random_vector(random, -0.7f, 0.7f) - origin)};
    const vec3 to = centre - origin;
    const float middle = glm::dot(to, ray.direction), miss = glm::length(to - middle * ray.direction);
    const SolidHit found = scene.hit(ray);
    if (miss > 0.751f) {
      EXPECT_FALSE(found.found());
    } else if (miss < 0.7f) {
      const float distance = middle - std::sqrt(0.75f * 0.75f - miss * miss);
      ASSERT_NEAR(found.distance, distance, 2e-4f);
      const vec3 normal = glm::normalize(origin + distance * ray.direction - centre);
      EXPECT_LT(glm::length(found.normal - normal), 2e-3f);
      EXPECT_LT(glm::length(found.face_normal - normal), 2e-2f);
    }
  }
}

TEST(SolidRays, SeeNormalsTowardsTheirOriginFromBothSidesOfMirroredSolids) {
  Mesh sphere = sphere_mesh({0, 0, 0}, 1, 64);
  const auto solid = make_solid(sphere);
  for (const float mirror : {1.0f, -1.0f})
    for (const float from : {0.0f, 3.0f}) {
      const Scene scene = scene_of({{solid, glm::scale(glm::mat4(1.0f), {mirror, 2.0f, 1.0f}), {}}});
      std::mt19937 random(5);
      for (int i = 0; i < 300; ++i) {
        const vec3 direction = glm::normalize(random_vector(random, -1, 1));
        const SolidHit hit = scene.hit({-from * direction, direction});
        ASSERT_TRUE(hit.found());
        EXPECT_LT(glm::dot(hit.normal, direction), 0);
        EXPECT_LT(glm::dot(hit.face_normal, direction), 0);
        // The gradient of x^2 + (y / 2)^2 + z^2.
        const vec3 p = (hit.distance - from) * direction;
        const vec3 gradient = glm::normalize(vec3{p.x, p.y / 4, p.z}) * (from > 0 ? 1.0f : -1.0f);
        EXPECT_GT(glm::dot(hit.normal, gradient), 0.998f);
      }
    }
}

/// Signed volume and whether every edge is there once in each direction, points that coincide taken as one.
void expect_closed(const Mesh& mesh, double volume, double tolerance) {
  std::vector<std::uint32_t> first(mesh.positions.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    first[i] = static_cast<std::uint32_t>(i);
    for (std::size_t j = 0; j < i; ++j)
      if (glm::length(mesh.positions[j] - mesh.positions[i]) < 1e-6f) {
        first[i] = first[j];
        break;
      }
  }
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  double sum = 0;
  for (std::size_t t = 0; t < mesh.corners.size(); t += 3) {
    const dvec3 a(mesh.positions[mesh.corners[t]]), b(mesh.positions[mesh.corners[t + 1]]),
        c(mesh.positions[mesh.corners[t + 2]]);
    sum += glm::dot(a, glm::cross(b, c)) / 6;
    const vec3 face(glm::cross(b - a, c - a));
    for (std::size_t k = 0; k < 3; ++k) {
      ++edges[{first[mesh.corners[t + k]], first[mesh.corners[t + (k + 1) % 3]]}];
      EXPECT_GT(glm::dot(face, mesh.normals[mesh.corners[t + k]]), 0) << "normals are those of the outer side";
    }
  }
  EXPECT_NEAR(sum, volume, tolerance);
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_EQ((edges.count({edge.second, edge.first})), 1u);
  }
}

TEST(Shapes, AreClosedWithNormalsOutwards) {
  const double pi = 3.14159265358979;
  expect_closed(box_mesh({-1, 0, 2}, {1, 0.5f, 5}), 3.0, 1e-5);
  expect_closed(sphere_mesh({1, 2, 3}, 0.5f, 48), 4.0 / 3 * pi * 0.125, 0.006);
  expect_closed(cylinder_mesh({1, 0, 0}, {1, 2, 1}, 0.3f, 48), pi * 0.09 * std::sqrt(5.0), 0.004);
}

TEST(Shapes, RefuseSizesThatAreNone) {
  EXPECT_THROW(box_mesh({0, 0, 0}, {1, 0, 1}), Error);
  EXPECT_THROW(sphere_mesh({0, 0, 0}, 0), Error);
  EXPECT_THROW(sphere_mesh({0, 0, 0}, 1, 2), Error);
  EXPECT_THROW(cylinder_mesh({0, 0, 0}, {0, 0, 0}, 1), Error);
  EXPECT_THROW(cylinder_mesh({0, 0, 0}, {0, 1, 0}, std::nanf("")), Error);
}

TEST(Solid, RefusesMeshesThatAreNone) {
  const auto refused = [](auto&& change) {
    Mesh mesh = box_mesh({0, 0, 0}, {1, 1, 1});
    mesh.material_of.assign(12, 0);
    change(mesh);
    try {
      make_solid(mesh);
    } catch (const Error& error) {
      return error.code() == ErrorCode::invalid_argument;
    }
    return false;
  };
  EXPECT_FALSE(refused([](Mesh&) {}));
  EXPECT_TRUE(refused([](Mesh& m) { m.corners.back() = 24; }));
  EXPECT_TRUE(refused([](Mesh& m) { m.corners.pop_back(); }));
  EXPECT_TRUE(refused([](Mesh& m) { m.normals.pop_back(); }));
  EXPECT_TRUE(refused([](Mesh& m) { m.texture_points.pop_back(); }));
  EXPECT_TRUE(refused([](Mesh& m) { m.material_of.pop_back(); }));
  EXPECT_TRUE(refused([](Mesh& m) { m.material_of[3] = 1; }));
  EXPECT_TRUE(refused([](Mesh& m) { m.positions[3].y = kInfinity; }));
  EXPECT_TRUE(refused([](Mesh& m) { m.materials = {SolidMaterial{vec3{0.6f}, {}, 1.5f, 1.5f}}; }));
  EXPECT_TRUE(refused([](Mesh& m) { m.materials = {SolidMaterial{vec3{0.6f}, {}, 1.0f, 1.0f}}; }));
  EXPECT_TRUE(refused([](Mesh& m) { m.materials = {SolidMaterial{vec3{-0.1f}, {}, 1.0f, 1.5f}}; }));
  EXPECT_TRUE(refused([](Mesh& m) { m.materials = {SolidMaterial{vec3{0.6f}, "*0", 1.0f, 1.5f}}; }));
}

TEST(Solid, WithoutTrianglesIsNowhere) {
  const Scene scene = scene_of({{make_solid(Mesh{}), glm::mat4(1.0f), {}}});
  EXPECT_FALSE(scene.hit({{0, 0, 0}, {1, 0, 0}}).found());
  EXPECT_TRUE(scene.solid_bounds().empty());
}

TEST(Solid, IsPlacedOnlyByTransformsThatCanBeInverted) {
  const auto solid = make_solid(box_mesh({0, 0, 0}, {1, 1, 1}));
  glm::mat4 flat(1.0f), projective(1.0f), endless(1.0f);
  flat[1][1] = 0;
  projective[0][3] = 0.5f;
  endless[3][0] = kInfinity;
  for (const glm::mat4& world : {flat, projective, endless}) EXPECT_THROW(scene_of({{solid, world, {}}}), Error);
  EXPECT_THROW(scene_of({{nullptr, glm::mat4(1.0f), {}}}), Error);
  EXPECT_NO_THROW(scene_of({{solid, glm::scale(glm::mat4(1.0f), vec3{1e-4f}), {}}}));
}

TEST(Solid, KeepsItsHierarchyFromSceneToScene) {
  const auto solid = make_solid(sphere_mesh({0, 0, 0}, 1));
  const auto& built = dynamic_cast<const BuiltSolid&>(*solid);
  const RTCScene hierarchy = built.scene();
  Scene first = scene_of({{solid, glm::mat4(1.0f), {}}});
  const Scene copy = first;
  first.set_solids({{solid, glm::translate(glm::mat4(1.0f), {5, 0, 0}), {}}});
  EXPECT_EQ(built.scene(), hierarchy);
  EXPECT_EQ(solid->mesh().positions.data(), built.mesh().positions.data());
  // The copy keeps the place that it was made with.
  EXPECT_NEAR(copy.hit({{0, 0, 4}, {0, 0, -1}}).distance, 3.0f, 1e-2f);
  EXPECT_FALSE(first.hit({{0, 0, 4}, {0, 0, -1}}).found());
  EXPECT_NEAR(first.hit({{5, 0, 4}, {0, 0, -1}}).distance, 3.0f, 1e-2f);
  EXPECT_NEAR(first.solid_bounds().high.x, 6.0f, 1e-5f);
}

TEST(Solid, WearsThePlacesMaterialInsteadOfItsOwn) {
  Mesh mesh = box_mesh({0, 0, 0}, {1, 1, 1});
  mesh.materials = {SolidMaterial{vec3{0.1f}, {}, 1.0f, 1.5f}, SolidMaterial{vec3{0.9f}, {}, 0.25f, 1.5f}};
  mesh.material_of.assign(12, 0);
  mesh.material_of[10] = mesh.material_of[11] = 1;  // upper z
  const auto solid = make_solid(mesh);
  const Ray down{{0.4f, 0.6f, 3}, {0, 0, -1}}, up{{0.4f, 0.6f, -3}, {0, 0, 1}};
  const Scene own = scene_of({{solid, glm::mat4(1.0f), {}}});
  EXPECT_EQ(own.hit(down).albedo, vec3{0.9f});
  EXPECT_EQ(own.hit(down).roughness, 0.25f);
  EXPECT_EQ(own.hit(up).albedo, vec3{0.1f});
  const Scene other = scene_of({{solid, glm::mat4(1.0f), SolidMaterial{vec3{0.3f}, {}, 1.0f, 2.0f}}});
  EXPECT_EQ(other.hit(down).albedo, vec3{0.3f});
  EXPECT_EQ(other.hit(down).ior, 2.0f);
}

/// Something of everything.
Scene full_scene() {
  Ground ground;
  ground.square = 0.3f;
  ground.fade_radius = 20;
  Scene scene(test_sky(), ground);
  std::mt19937 random(11);
  const SolidMaterial coated{vec3{0.6f}, {}, 0.2f, 1.5f};
  scene.set_solids({{make_solid(sphere_mesh({0, 0.5f, 0}, 0.4f)), glm::mat4(1.0f), coated},
                    {make_solid(random_triangles(random, 200)), glm::translate(glm::mat4(1.0f), {0, 1.5f, 0}), {}}});
  Tank tank;
  tank.style = TankStyle::tiled;
  tank.inside.add({-1, 0, -1});
  tank.inside.add({1, 0.8f, 1});
  scene.set_tank(tank);
  scene.set_lamps({{{1, 2, 1}, vec3{3.0f}}});
  return scene;
}

bool same_bits(const SceneBuffers& a, const SceneBuffers& b) {
  return std::memcmp(a.radiance.data(), b.radiance.data(), a.radiance.size() * sizeof(vec3)) == 0 &&
         std::memcmp(a.depth.data(), b.depth.data(), a.depth.size() * sizeof(float)) == 0 &&
         std::memcmp(a.normal.data(), b.normal.data(), a.normal.size() * sizeof(vec3)) == 0 &&
         std::memcmp(a.albedo.data(), b.albedo.data(), a.albedo.size() * sizeof(vec3)) == 0;
}

TEST(SceneView, HasTheSameBitsForAnyNumberOfThreads) {
  const View view = perspective_view({2, 2, 3}, {0, 0.6f, 0}, {0, 1, 0}, 0.9f, 150, 110);
  const auto drawn = [&](int threads) {
    const ThreadLimit limit(threads);
    return full_scene().see(view);  // built anew as well
  };
  const SceneBuffers one = drawn(1);
  EXPECT_TRUE(same_bits(one, drawn(2)));
  EXPECT_TRUE(same_bits(one, drawn(5)));
}

TEST(SceneView, AtPointsIsThatOfPixels) {
  const Scene scene = full_scene();
  const View view = perspective_view({2, 2, 3}, {0, 0.6f, 0}, {0, 1, 0}, 0.9f, 50, 30);
  std::vector<vec2> points;
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 50; ++x) points.push_back({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
  EXPECT_TRUE(same_bits(scene.see(view), scene.see(view, points)));
}

TEST(SceneView, OfACubeIsThatOfItsSixFaces) {
  const Scene scene = full_scene();
  const View cube = cube_view({0.6f, 0.7f, 0.55f}, 24);
  const SceneBuffers all = scene.see(cube);
  for (int k = 0; k < 6; ++k) {
    const SceneBuffers face = scene.see(cube.face(k));
    for (int y = 0; y < 24; ++y)
      for (int x = 0; x < 24; ++x) {
        ASSERT_EQ(all.depth(24 * k + x, y), face.depth(x, y)) << k << " " << x << " " << y;
        ASSERT_EQ(all.normal(24 * k + x, y), face.normal(x, y));
        ASSERT_EQ(all.radiance(24 * k + x, y), face.radiance(x, y));
      }
  }
}

TEST(SceneView, DepthIsTheDistanceAlongTheRay) {
  const Scene scene = full_scene();
  const View orthographic = orthographic_view({3, 3, 3}, {0, 0, 0}, {0, 1, 0}, 3, 30, 20);
  const SceneBuffers seen = scene.see(orthographic);
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 30; ++x)
      EXPECT_FLOAT_EQ(seen.depth(x, y),
                      scene.distance(orthographic.ray({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f})));
}

}  // namespace
}  // namespace meniscus
