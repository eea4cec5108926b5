// The iteration in the geometry map against rays and planes in closed form.
#include <gtest/gtest.h>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <random>

#include "shading/image_space.h"

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Depth of the plane dot(p, normal) = height; infinite where the ray does not meet it.
float plane_depth(const Ray& ray, vec3 normal, float height) {
  const float t = (height - glm::dot(ray.origin, normal)) / glm::dot(ray.direction, normal);
  return t > 0 ? t : kInfinity;
}

template <class Depth>
Image<float> drawn(const View& view, Depth depth) {
  Image<float> image(view.width, view.height);
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x)
      image(x, y) = depth(view.ray({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f}));
  return image;
}

Image<float> floor_of(const View& view) {
  return drawn(view, [](const Ray& ray) { return plane_depth(ray, {0, 1, 0}, 0.0f); });
}

vec2 seen_at(const View& view, vec3 point) {
  const vec3 at = view.project(point);
  return {at.x, at.y};
}

View above(int size = 200) { return perspective_view({0, 4, 1}, {0, 0, 0}, {0, 1, 0}, 0.8f, size, size); }
View grazing() { return perspective_view({0, 0.9f, 4}, {0, 0.2f, 0}, {0, 1, 0}, 0.8f, 400, 200); }
View plan() { return orthographic_view({0, 4, 0}, {0.5f, 0, 0.3f}, {0, 0, 1}, 4.0f, 160, 160); }

TEST(ImageSpace, MeetsAFloorWhereTheRayDoes) {
  for (const View& view : {above(), plan()}) {
    const Image<float> depth = floor_of(view);
    for (const vec3 direction : {vec3{0, -1, 0}, vec3{0.3f, -1, 0.2f}, vec3{-0.8f, -1, 0.4f}}) {
      const Ray ray{{0.1f, 0.7f, 0.15f}, glm::normalize(direction)};
      const ImageSpaceHit hit = image_space_hit({view, &depth}, ray, seen_at(view, ray.origin), 0.001f, 8);
      ASSERT_TRUE(hit.met);
      EXPECT_TRUE(hit.in_picture);
      EXPECT_NEAR(hit.distance, plane_depth(ray, {0, 1, 0}, 0), 0.003f);
      EXPECT_LT(glm::length(hit.point - (ray.origin + hit.distance * ray.direction)), 1e-6f);
      EXPECT_LT(glm::length(hit.picture - seen_at(view, hit.point)), 0.01f);
      EXPECT_LE(hit.iterations, 4);
    }
  }
}

TEST(ImageSpace, MovesByThePublishedProjectionFirst) {
  const View view = above();
  const Image<float> depth = floor_of(view);
  const Ray ray{{0.1f, 0.7f, 0.15f}, glm::normalize(vec3{0.5f, -1, 0.2f})};
  const vec2 start = seen_at(view, ray.origin);
  const Ray look = view.ray(start);
  const vec3 p1 = look.origin + plane_depth(look, {0, 1, 0}, 0) * look.direction;
  const ImageSpaceHit hit = image_space_hit({view, &depth}, ray, start, 1e-6f, 1);
  EXPECT_EQ(hit.iterations, 1);
  EXPECT_NEAR(hit.distance, glm::dot(p1 - ray.origin, ray.direction), 1e-4f);
}

TEST(ImageSpace, ConvergesWhereProjectionsAloneDiverge) {
  const View view = grazing();
  const Image<float> depth = floor_of(view);
  const Ray ray{{0.2f, 0.4f, 0.5f}, glm::normalize(vec3{0, -1, -0.4f})};
  const vec2 start = seen_at(view, ray.origin);
  // The published steps by themselves, on the plane in closed form.
  double t = 0;
  for (int n = 0; n < 8; ++n) {
    const vec3 point = ray.origin + static_cast<float>(t) * ray.direction;
    const Ray look{view.eye, glm::normalize(point - view.eye)};
    const vec3 p = look.origin + (view.eye.y / -look.direction.y) * look.direction;
    t = glm::dot(p - ray.origin, ray.direction);
  }
  const float exact = plane_depth(ray, {0, 1, 0}, 0);
  EXPECT_GT(std::abs(t - static_cast<double>(exact)), 0.1) << "the test needs a ray on which they diverge";
  const ImageSpaceHit hit = image_space_hit({view, &depth}, ray, start, 0, 8);
  ASSERT_TRUE(hit.met);
  EXPECT_NEAR(hit.distance, exact, view.pixel_size(4.0f));
}

TEST(ImageSpace, StaysAtTheStartWhereTheSceneIsThere) {
  const View view = above();
  const Image<float> depth = floor_of(view);
  const Ray ray{{0.1f, 0.0005f, 0.15f}, glm::normalize(vec3{0.5f, -1, 0.2f})};
  const ImageSpaceHit hit = image_space_hit({view, &depth}, ray, seen_at(view, ray.origin), 0.001f, 8);
  EXPECT_TRUE(hit.met);
  EXPECT_EQ(hit.iterations, 0);
  EXPECT_EQ(hit.distance, 0.0f);
}

TEST(ImageSpace, MeetsNothingInAnEmptyMap) {
  const View view = above(64);
  const Image<float> depth(64, 64, kInfinity);
  const Ray ray{{0, 1, 0}, glm::normalize(vec3{0.1f, -1, 0})};
  const ImageSpaceHit hit = image_space_hit({view, &depth}, ray, {32, 32}, 0, 16);
  EXPECT_FALSE(hit.met);
  EXPECT_TRUE(std::isfinite(hit.distance));
}

TEST(ImageSpace, DoesNotMeetWhatLiesBehindAnEdgeThatHidesIt) {
  // A wide shelf over the floor; the ray goes under it, where the map shows the shelf only.
  const View view = orthographic_view({0, 4, 0}, {0, 0, 0}, {0, 0, 1}, 4.0f, 160, 160);
  const Image<float> depth = drawn(view, [](const Ray& ray) { return ray.origin.x > 0.2f ? 4.0f - 0.5f : 4.0f; });
  const Ray ray{{0.0f, 0.3f, 0}, glm::normalize(vec3{1, -0.25f, 0})};
  EXPECT_FALSE(image_space_hit({view, &depth}, ray, seen_at(view, ray.origin), 0.01f, 12).met);
  // Another that ends before the shelf is met on the floor.
  const Ray steep{{0.0f, 0.3f, 0}, glm::normalize(vec3{0.3f, -1, 0})};
  EXPECT_TRUE(image_space_hit({view, &depth}, steep, seen_at(view, steep.origin), 0.01f, 12).met);
}

TEST(ImageSpace, FindsWhatIsSeenBesideAnEmptyStart) {
  // The start is seen before the sky, the ray goes down to the floor.
  const View view = perspective_view({0, 1, 4}, {0, 0.8f, 0}, {0, 1, 0}, 0.8f, 200, 200);
  Image<float> depth = floor_of(view);
  for (float& d : depth)
    if (d > 30) d = kInfinity;
  const Ray ray{{0, 1.5f, 1}, glm::normalize(vec3{0.1f, -1, 0.1f})};
  const vec2 start = seen_at(view, ray.origin);
  ASSERT_EQ(depth_at({view, &depth}, start), kInfinity);
  const ImageSpaceHit hit = image_space_hit({view, &depth}, ray, start, 0, 16);
  ASSERT_TRUE(hit.met);
  EXPECT_NEAR(hit.distance, plane_depth(ray, {0, 1, 0}, 0), 2 * view.pixel_size(4.0f));
}

TEST(ImageSpace, IsFiniteForAnyRay) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> any(-1.0f, 1.0f);
  for (const View& view : {above(50), grazing(), plan(), cube_view({0, 1, 0}, 32)}) {
    Image<float> depth = floor_of(view);
    for (float& d : depth)
      if (any(random) > 0.6f) d = any(random) > 0 ? kInfinity : 3.0f + any(random);
    for (int i = 0; i < 2000; ++i) {
      const Ray ray{2.0f * vec3{any(random), any(random), any(random)},
                    glm::normalize(vec3{any(random), any(random), any(random)} + 1e-3f)};
      const vec2 start{400.0f * any(random), 400.0f * any(random)};
      const ImageSpaceHit hit = image_space_hit({view, &depth}, ray, start, 0, i % 20);
      ASSERT_TRUE(std::isfinite(hit.distance) && hit.distance >= 0);
      ASSERT_TRUE(std::isfinite(hit.picture.x) && std::isfinite(hit.picture.y));
      ASSERT_LE(hit.iterations, i % 20);
    }
  }
}

TEST(GeometryMap, IsExactBetweenPixelsOfAPlane) {
  for (const View& view : {above(), plan()}) {
    const Image<float> depth = floor_of(view);
    for (const vec2 point : {vec2{50.3f, 80.9f}, vec2{101.0f, 33.25f}, vec2{150.77f, 120.5f}})
      EXPECT_NEAR(depth_at({view, &depth}, point), plane_depth(view.ray(point), {0, 1, 0}, 0), 2e-5f);
  }
}

TEST(GeometryMap, DoesNotMixAcrossEdges) {
  const View view = plan();
  Image<float> depth(160, 160, 4.0f);
  for (int y = 0; y < 160; ++y)
    for (int x = 80; x < 160; ++x) depth(x, y) = 2.0f;
  EXPECT_EQ(depth_at({view, &depth}, {79.9f, 50.0f}), 4.0f);
  EXPECT_EQ(depth_at({view, &depth}, {80.1f, 50.0f}), 2.0f);
}

}  // namespace
}  // namespace meniscus
