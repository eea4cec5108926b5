#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <random>

#include "meniscus/base.h"

namespace meniscus {
namespace {

constexpr float kPi = 3.14159265f;

void expect_near(vec3 a, vec3 b, float tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

void expect_right_handed_frame(const View& view) {
  EXPECT_NEAR(glm::length(view.right), 1.0f, 1e-5f);
  EXPECT_NEAR(glm::length(view.up), 1.0f, 1e-5f);
  EXPECT_NEAR(glm::length(view.forward), 1.0f, 1e-5f);
  expect_near(glm::cross(view.right, view.up), -view.forward, 1e-5f);
}

/// Random views of one projection; the seed is fixed.
void for_each_random_view(Projection projection, const std::function<void(const View&, std::mt19937&)>& body) {
  std::mt19937 random(20240607);
  std::uniform_real_distribution<float> place(-4.0f, 4.0f), angle(0.2f, 2.0f), size(0.5f, 20.0f);
  for (int i = 0; i < 40; ++i) {
    const vec3 eye{place(random), place(random), place(random)};
    const vec3 target{place(random), place(random), place(random)};
    const vec3 up_hint{place(random), place(random), place(random)};
    const View view = projection == Projection::perspective
                          ? perspective_view(eye, target, up_hint, angle(random), 640, 360)
                          : orthographic_view(eye, target, up_hint, size(random), 640, 360);
    SCOPED_TRACE(testing::Message() << "view " << i);
    body(view, random);
  }
}

class EachProjection : public testing::TestWithParam<Projection> {};
INSTANTIATE_TEST_SUITE_P(View, EachProjection, testing::Values(Projection::perspective, Projection::orthographic),
                         [](const auto& info) {
                           return info.param == Projection::perspective ? "perspective" : "orthographic";
                         });

TEST_P(EachProjection, AxesAreARightHandedFrame) {
  for_each_random_view(GetParam(), [](const View& view, std::mt19937&) { expect_right_handed_frame(view); });
}

TEST_P(EachProjection, APointOnARayProjectsToWhereTheRayStarted) {
  for_each_random_view(GetParam(), [](const View& view, std::mt19937& random) {
    std::uniform_real_distribution<float> x(0.0f, 640.0f), y(0.0f, 360.0f), distance(0.5f, 50.0f);
    for (int i = 0; i < 25; ++i) {
      const vec2 point{x(random), y(random)};
      const float t = distance(random);
      const Ray ray = view.ray(point);
      EXPECT_NEAR(glm::length(ray.direction), 1.0f, 1e-5f);
      const vec3 seen = view.project(ray.origin + t * ray.direction);
      EXPECT_NEAR(seen.x, point.x, 0.02f);
      EXPECT_NEAR(seen.y, point.y, 0.02f);
      EXPECT_NEAR(seen.z, t * glm::dot(ray.direction, view.forward), 1e-4f * t);
    }
  });
}

TEST_P(EachProjection, TheTargetIsInTheMiddleOfThePicture) {
  const View view = GetParam() == Projection::perspective
                        ? perspective_view({3, 4, 5}, {0, 1, -1}, {0, 1, 0}, 0.8f, 320, 200)
                        : orthographic_view({3, 4, 5}, {0, 1, -1}, {0, 1, 0}, 7.0f, 320, 200);
  expect_near(view.project({0, 1, -1}), {160, 100, std::sqrt(54.0f)}, 1e-3f);
  expect_near(view.ray({160, 100}).direction, glm::normalize(vec3{-3, -3, -6}), 1e-5f);
}

TEST_P(EachProjection, RowsGoDownAndColumnsGoRight) {
  const View view = GetParam() == Projection::perspective
                        ? perspective_view({0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 0.8f, 320, 200)
                        : orthographic_view({0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 7.0f, 320, 200);
  expect_near(view.right, {1, 0, 0}, 1e-6f);
  expect_near(view.up, {0, 1, 0}, 1e-6f);
  EXPECT_LT(view.project({0, 1, 0}).y, 100.0f);
  EXPECT_GT(view.project({1, 0, 0}).x, 160.0f);
}

TEST_P(EachProjection, PixelSizeIsTheDistanceOfNeighbouringRays) {
  for_each_random_view(GetParam(), [](const View& view, std::mt19937& random) {
    const float depth = std::uniform_real_distribution<float>(1.0f, 30.0f)(random);
    const auto at_depth = [&](vec2 point) {
      const Ray ray = view.ray(point);
      return ray.origin + depth / glm::dot(ray.direction, view.forward) * ray.direction;
    };
    const float tolerance = 0.01f * view.pixel_size(depth);
    EXPECT_NEAR(view.pixel_size(depth), glm::distance(at_depth({320, 180}), at_depth({321, 180})), tolerance);
    EXPECT_NEAR(view.pixel_size(depth), glm::distance(at_depth({320, 180}), at_depth({320, 181})), tolerance);
  });
}

TEST_P(EachProjection, AnotherResolutionShowsTheSame) {
  for_each_random_view(GetParam(), [](const View& view, std::mt19937&) {
    const View twice = view.resized(1280, 720);
    const vec3 point = view.eye + 3.0f * view.forward + 0.3f * view.right - 0.2f * view.up;
    const vec3 once = view.project(point);
    expect_near(twice.project(point), {2 * once.x, 2 * once.y, once.z}, 1e-2f);
    EXPECT_NEAR(twice.pixel_size(2.0f), 0.5f * view.pixel_size(2.0f), 1e-6f);
  });
}

TEST_P(EachProjection, LooksStraightDownAndUpWhateverTheUpAxis) {
  for (const Axis axis : {Axis::x, Axis::y, Axis::z})
    for (const float sign : {-1.0f, 1.0f}) {
      const vec3 up = direction_of(axis);
      const View view = GetParam() == Projection::perspective
                            ? perspective_view(sign * 2.0f * up, vec3{0}, up, 1.0f, 64, 64)
                            : orthographic_view(sign * 2.0f * up, vec3{0}, up, 1.0f, 64, 64);
      SCOPED_TRACE(testing::Message() << name_of(axis) << " " << sign);
      expect_right_handed_frame(view);
      expect_near(view.forward, -sign * up, 1e-6f);
      expect_near(view.project({0, 0, 0}), {32, 32, 2}, 1e-4f);
    }
}

TEST_P(EachProjection, RefusesWhatCannotBeDrawn) {
  const auto code_of = [](vec3 eye, vec3 target, float size, int width, int height) {
    try {
      if (GetParam() == Projection::perspective)
        perspective_view(eye, target, {0, 1, 0}, size, width, height);
      else
        orthographic_view(eye, target, {0, 1, 0}, size, width, height);
    } catch (const Error& error) {
      return static_cast<int>(error.code());
    }
    return -1;
  };
  const int refused = static_cast<int>(ErrorCode::invalid_argument);
  const vec3 eye{0, 0, 5}, target{0};
  EXPECT_EQ(code_of(eye, target, 1.0f, 1, 1), -1);
  EXPECT_EQ(code_of(eye, eye, 1.0f, 4, 4), refused);
  EXPECT_EQ(code_of({NAN, 0, 5}, target, 1.0f, 4, 4), refused);
  EXPECT_EQ(code_of({INFINITY, 0, 5}, target, 1.0f, 4, 4), refused);
  EXPECT_EQ(code_of(eye, target, 1.0f, 0, 4), refused);
  EXPECT_EQ(code_of(eye, target, 1.0f, 4, -1), refused);
  EXPECT_EQ(code_of(eye, target, 0.0f, 4, 4), refused);
  EXPECT_EQ(code_of(eye, target, -1.0f, 4, 4), refused);
  EXPECT_EQ(code_of(eye, target, NAN, 4, 4), refused);
}

TEST(PerspectiveView, RefusesHalfATurn) {
  EXPECT_THROW(perspective_view({0, 0, 5}, vec3{0}, {0, 1, 0}, kPi, 4, 4), Error);
}

TEST(PerspectiveView, TopEdgeIsHalfTheFieldOfViewFromTheMiddle) {
  const View view = perspective_view({0, 0, 5}, vec3{0}, {0, 1, 0}, kPi / 2, 100, 100);
  expect_near(view.ray({50, 0}).direction, glm::normalize(vec3{0, 1, -1}), 1e-5f);
  expect_near(view.ray({100, 50}).direction, glm::normalize(vec3{1, 0, -1}), 1e-5f);
}

TEST(PerspectiveView, PointsBehindTheEyeHaveNegativeDepth) {
  const View view = perspective_view({0, 0, 5}, vec3{0}, {0, 1, 0}, 1.0f, 100, 100);
  EXPECT_FLOAT_EQ(view.project({1, 1, 7}).z, -2.0f);
}

TEST(OrthographicView, PictureIsAsHighAsAskedFor) {
  const View view = orthographic_view({0, 0, 5}, vec3{0}, {0, 1, 0}, 6.0f, 200, 100);
  expect_near(view.ray({100, 0}).origin, {0, 3, 5}, 1e-5f);
  expect_near(view.ray({0, 100}).origin, {-6, -3, 5}, 1e-5f);
  EXPECT_FLOAT_EQ(view.pixel_size(1.0f), 0.06f);
  EXPECT_FLOAT_EQ(view.pixel_size(100.0f), 0.06f);
}

TEST(CubeView, ProjectsARayBackToItsPoint) {
  const View view = cube_view({1, 2, 3}, 16);
  EXPECT_EQ(view.width, 96);
  for (int y = 0; y < view.height; y += 3)
    for (int x = 0; x < view.width; ++x) {
      const vec2 point{static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f};
      const Ray ray = view.ray(point);
      EXPECT_NEAR(glm::length(ray.direction), 1.0f, 1e-6f);
      const vec3 back = view.project(ray.origin + 2.5f * ray.direction);
      EXPECT_NEAR(back.x, point.x, 1e-3f);
      EXPECT_NEAR(back.y, point.y, 1e-3f);
      EXPECT_GT(back.z, 0.0f);
    }
}

TEST(CubeView, ShowsEachDirectionInItsOwnFace) {
  const View view = cube_view(vec3{0}, 8);
  const vec3 towards[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, -1}, {0, 0, 1}};
  for (int k = 0; k < 6; ++k) {
    expect_near(view.ray({8.0f * static_cast<float>(k) + 4.0f, 4.0f}).direction, towards[k], 1e-6f);
    EXPECT_FLOAT_EQ(view.project(3.0f * towards[k]).z, 3.0f);
  }
}

TEST(CubeView, FacesMeetWithoutATurn) {
  // The right edge of the front face and the left edge of the right face are one line, the same way up.
  const View view = cube_view(vec3{0}, 8);
  for (const float y : {1.0f, 4.0f, 7.0f})
    expect_near(view.ray({39.9999f, y}).direction, view.ray({0.0001f, y}).direction, 1e-3f);
}

}  // namespace
}  // namespace meniscus
