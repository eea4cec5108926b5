#include <gtest/gtest.h>

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <numbers>
#include <random>

#include "obstacle_meshes.h"
#include "sim/shape.h"
#include "sim/signed_distance.h"

namespace meniscus {
namespace {

constexpr auto kBox = ObstacleShape::Kind::box;
constexpr auto kSphere = ObstacleShape::Kind::sphere;
constexpr auto kCylinder = ObstacleShape::Kind::cylinder;

std::vector<vec3> points_in(float half, int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> coordinate(-half, half);
  std::vector<vec3> points;
  for (int i = 0; i < count; ++i) {
    const float x = coordinate(random), y = coordinate(random), z = coordinate(random);
    points.push_back({x, y, z});
  }
  return points;
}

std::unique_ptr<const Shape> shape_of(ObstacleShape::Kind kind, vec3 size) { return make_shape({kind, size, {}, {}}); }

/// Points dense on the surface of a box, a sphere or a cylinder of half a metre around the origin.
double sampled_distance(ObstacleShape::Kind kind, glm::dvec3 p) {
  double least = 1e9;
  const auto try_point = [&](glm::dvec3 q) { least = std::min(least, glm::distance(p, q)); };
  constexpr int n = 160;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const double u = double(i) / n, v = double(j) / n, turn = 2 * std::numbers::pi * u;
      if (kind == kBox) {
        const double a = u - 0.5, b = v - 0.5;
        for (const double side : {-0.5, 0.5}) try_point({side, a, b}), try_point({a, side, b}), try_point({a, b, side});
      } else if (kind == kSphere) {
        const double down = std::numbers::pi * v;
        try_point(0.5 * glm::dvec3(std::sin(down) * std::cos(turn), std::cos(down), std::sin(down) * std::sin(turn)));
      } else {
        try_point({0.5 * std::cos(turn), v - 0.5, 0.5 * std::sin(turn)});
        for (const double side : {-0.5, 0.5}) try_point({0.5 * v * std::cos(turn), side, 0.5 * v * std::sin(turn)});
      }
    }
  return least;
}

TEST(Shapes, DistancesAreThoseOfTheNearestOfManySurfacePoints) {
  for (const auto kind : {kBox, kSphere, kCylinder}) {
    const auto shape = shape_of(kind, vec3(1.0f));
    for (const vec3 p : points_in(1.2f, 60, 1)) {
      const NearestSurface found = shape->nearest(p);
      // Samples are 0.02 m apart at most: their distance is a little too large, never too small.
      EXPECT_NEAR(std::abs(found.distance), sampled_distance(kind, p), 0.004) << int(kind);
      const vec3 q = glm::abs(p);
      const bool inside = kind == kBox      ? std::max({q.x, q.y, q.z}) < 0.5f
                          : kind == kSphere ? glm::length(p) < 0.5f
                                            : std::hypot(p.x, p.z) < 0.5f && q.y < 0.5f;
      EXPECT_EQ(found.distance < 0, inside);
    }
  }
}

TEST(Shapes, NormalsLeadOutOfTheBodyToItsSurface) {
  const ObstacleShape bumpy = bumpy_mesh(24);
  for (const auto& shape : {shape_of(kBox, {1, 0.4f, 0.7f}), shape_of(kSphere, vec3(0.8f)),
                            shape_of(kCylinder, {0.6f, 0.9f, 0}), make_shape(bumpy)})
    for (const vec3 p : points_in(0.9f, 400, 2)) {
      const NearestSurface found = shape->nearest(p);
      EXPECT_NEAR(glm::length(found.normal), 1, 1e-4);
      const NearestSurface on = shape->nearest(p - found.normal * found.distance);
      EXPECT_NEAR(on.distance, 0, 2e-6);
    }
}

TEST(Shapes, WithinAReachIsTheSameAsTheDistanceItself) {
  const ObstacleShape bumpy = bumpy_mesh(24);
  for (const auto& shape : {shape_of(kBox, {1, 0.4f, 0.7f}), make_shape(bumpy)})
    for (const float reach : {0.0f, 0.03f, 0.3f})
      for (const vec3 p : points_in(1.0f, 1500, 3)) {
        const NearestSurface all = shape->nearest(p);
        NearestSurface near;
        ASSERT_EQ(shape->nearest_within(p, reach, near), all.distance <= reach);
        if (all.distance <= reach) {
          ASSERT_EQ(near.distance, all.distance);
          ASSERT_EQ(near.normal, all.normal);
        }
      }
}

TEST(MeshDistance, OfABoxIsThatOfTheBox) {
  const vec3 size{0.5f, 0.8f, 0.3f};
  const auto box = shape_of(kBox, size);
  const auto mesh = make_shape(box_triangles(size));
  EXPECT_NEAR(mesh->volume(), box->volume(), 1e-6);
  for (const vec3 p : points_in(0.8f, 4000, 4)) {
    const NearestSurface a = box->nearest(p), b = mesh->nearest(p);
    ASSERT_NEAR(a.distance, b.distance, 1e-6) << p.x << " " << p.y << " " << p.z;
    // Where two faces are about as near, either normal will do.
    if (glm::distance(a.normal, b.normal) > 1e-3f) {
      ASSERT_NEAR(box->nearest(p - b.normal * b.distance).distance, 0, 1e-6);
    }
  }
}

/// Double precision, every triangle; the sign by the solid angle that the surface fills.
double brute_force(const ObstacleShape& mesh, glm::dvec3 p) {
  double least = 1e9, angle = 0;
  for (std::size_t i = 0; i < mesh.corners.size(); i += 3) {
    glm::dvec3 a = mesh.positions[mesh.corners[i]], b = mesh.positions[mesh.corners[i + 1]],
               c = mesh.positions[mesh.corners[i + 2]];
    a -= p;
    b -= p;
    c -= p;
    // The nearest point by sides: of the plane if its foot is inside, else of the three edges.
    const glm::dvec3 n = glm::cross(b - a, c - a);
    if (glm::dot(glm::cross(b - a, -a), n) >= 0 && glm::dot(glm::cross(c - b, -b), n) >= 0 &&
        glm::dot(glm::cross(a - c, -c), n) >= 0)
      least = std::min(least, std::abs(glm::dot(a, n)) / glm::length(n));
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
      const double t = glm::clamp(-glm::dot(from, to - from) / glm::dot(to - from, to - from), 0.0, 1.0);
      least = std::min(least, glm::length(from + t * (to - from)));
    }
    const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
    angle += 2 * std::atan2(glm::dot(a, glm::cross(b, c)),
                            la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb);
  }
  return std::abs(angle) > 2 * std::numbers::pi ? -least : least;
}

TEST(MeshDistance, OfABumpyBodyIsThatOfEveryTriangleAndItsSolidAngle) {
  const ObstacleShape bumpy = bumpy_mesh(20);
  const auto shape = make_shape(bumpy);
  int inside = 0;
  for (const vec3 p : points_in(0.7f, 1500, 5)) {
    const double expected = brute_force(bumpy, p);
    inside += expected < 0;
    ASSERT_NEAR(shape->nearest(p).distance, expected, 2e-6);
  }
  EXPECT_GT(inside, 100);
}

TEST(MeshDistance, KeepsItsSignBesideEdgesAndCorners) {
  // A thin wedge: beside its sharp edges the nearest triangle alone tells the wrong side.
  const ObstacleShape wedge = wedge_mesh();
  const auto shape = make_shape(wedge);
  for (const vec3 p : points_in(0.8f, 4000, 6)) {
    const double expected = brute_force(wedge, p);
    if (std::abs(expected) > 1e-5) {
      ASSERT_NEAR(shape->nearest(p).distance, expected, 2e-6);
    }
  }
}

TEST(MeshDistance, OfAMeshThatIsInsideOutIsTurnedBack) {
  ObstacleShape box = box_triangles(vec3(1.0f));
  for (std::size_t i = 0; i < box.corners.size(); i += 3) std::swap(box.corners[i], box.corners[i + 1]);
  EXPECT_NEAR(make_shape(box)->nearest(vec3(0.0f)).distance, -0.5f, 1e-6);
}

TEST(MeshDistance, TakesCornersOfOnePlaceAsOne) {
  const ObstacleShape box = box_triangles(vec3(1.0f));
  ObstacleShape soup;
  soup.kind = ObstacleShape::Kind::mesh;
  for (const std::uint32_t corner : box.corners) {
    soup.corners.push_back(static_cast<std::uint32_t>(soup.positions.size()));
    soup.positions.push_back(box.positions[corner]);
  }
  EXPECT_NEAR(make_shape(soup)->nearest({0.1f, 0.9f, 0.2f}).distance, 0.4f, 1e-6);
}

std::string refusal(const ObstacleShape& shape) {
  try {
    make_shape(shape);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
    return error.what();
  }
  return {};
}

TEST(MeshDistance, RefusesWhatIsNotAClosedBody) {
  ObstacleShape open = box_triangles(vec3(1.0f));
  open.corners.resize(open.corners.size() - 3);
  EXPECT_NE(refusal(open).find("its surface is open (expected a closed surface, found 3 open edges, one from ("),
            std::string::npos)
      << refusal(open);

  ObstacleShape turned = box_triangles(vec3(1.0f));
  std::swap(turned.corners[0], turned.corners[1]);
  EXPECT_NE(refusal(turned).find("not turned alike"), std::string::npos) << refusal(turned);

  ObstacleShape flat = box_triangles({1, 1, 0});
  EXPECT_NE(refusal(flat), "");
  ObstacleShape wrong = box_triangles(vec3(1.0f));
  wrong.corners[4] = 8;
  EXPECT_NE(refusal(wrong).find("not in the list"), std::string::npos);
  ObstacleShape lost = box_triangles(vec3(1.0f));
  lost.positions[2].y = std::nanf("");
  EXPECT_NE(refusal(lost).find("out of range"), std::string::npos);
  EXPECT_NE(refusal({ObstacleShape::Kind::mesh, vec3(1.0f), {}, {}}).find("no list of triangles"), std::string::npos);
}

TEST(Shapes, RefuseSizesThatAreNone) {
  for (const float bad : {0.0f, -1.0f, std::nanf(""), std::numeric_limits<float>::infinity()}) {
    EXPECT_NE(refusal({kBox, {1, bad, 1}, {}, {}}), "");
    EXPECT_NE(refusal({kSphere, {bad, 1, 1}, {}, {}}), "");
    EXPECT_NE(refusal({kCylinder, {1, bad, 1}, {}, {}}), "");
    EXPECT_EQ(refusal({kCylinder, {1, 1, bad}, {}, {}}), "");
  }
}

}  // namespace
}  // namespace meniscus
