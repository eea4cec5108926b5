#include <gtest/gtest.h>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <random>

#include "meniscus/render.h"

namespace meniscus {
namespace {

class Boxes {
 public:
  Bounds next() {
    std::uniform_real_distribution<float> place(-5, 5), size(0.01f, 8);
    const vec3 low{place(random_), place(random_), place(random_)};
    return {low, low + vec3{size(random_), size(random_), size(random_)}};
  }

 private:
  std::mt19937 random_{7};
};

std::vector<vec3> corners_of(const Bounds& b) {
  std::vector<vec3> corners;
  for (const float x : {b.low.x, b.high.x})
    for (const float y : {b.low.y, b.high.y})
      for (const float z : {b.low.z, b.high.z}) corners.emplace_back(x, y, z);
  return corners;
}

/// How much of the picture's half size is left at the tightest side; negative: a corner is outside.
float room_left(const View& view, const Bounds& bounds) {
  float room = 1;
  for (const vec3 corner : corners_of(bounds)) {
    const vec3 p = view.project(corner);
    if (!(p.z > 0)) return -1;
    const float half_width = 0.5f * static_cast<float>(view.width),
                half_height = 0.5f * static_cast<float>(view.height);
    room = std::min({room, 1 - std::abs(p.x - half_width) / half_width, 1 - std::abs(p.y - half_height) / half_height});
  }
  return room;
}

constexpr std::pair<int, int> kSizes[] = {{1280, 720}, {720, 1280}, {512, 512}, {2000, 200}, {3, 1000}};

TEST(FittedView, ShowsEveryCornerOfAnyBoxAndTouchesTheMargin) {
  Boxes boxes;
  for (int i = 0; i < 50; ++i)
    for (const auto& [width, height] : kSizes)
      for (const Axis up : {Axis::x, Axis::y, Axis::z}) {
        const Bounds box = boxes.next();
        const float room = room_left(fitted_view(box, up, {}, 0, width, height), box);
        EXPECT_GE(room, 0.06f - 1e-3f) << i << " " << width << "x" << height;
        EXPECT_LE(room, 0.06f + 1e-3f) << "the water could be larger";
      }
}

TEST(FittedView, LeavesAsMuchRoomAboveAsBelowAndOnTheLeftAsOnTheRight) {
  Boxes boxes;
  for (int i = 0; i < 20; ++i)
    for (const auto& [width, height] : kSizes) {
      const Bounds box = boxes.next();
      const View view = fitted_view(box, Axis::y, {}, 0, width, height);
      vec2 low{1e9f}, high{-1e9f};
      for (const vec3 corner : corners_of(box)) {
        const vec2 at{view.project(corner)};
        low = glm::min(low, at);
        high = glm::max(high, at);
      }
      const vec2 size{static_cast<float>(width), static_cast<float>(height)};
      EXPECT_NEAR(low.x / size.x, 1 - high.x / size.x, 2e-3f);
      EXPECT_NEAR(low.y / size.y, 1 - high.y / size.y, 2e-3f);
    }
}

TEST(FittedView, ShowsEveryCornerFromAnySide) {
  Boxes boxes;
  for (int azimuth = -180; azimuth <= 180; azimuth += 45)
    for (int elevation = -90; elevation <= 90; elevation += 30) {
      CameraOptions options;
      options.azimuth_deg = static_cast<float>(azimuth);
      options.elevation_deg = static_cast<float>(elevation);
      const Bounds box = boxes.next();
      EXPECT_GE(room_left(fitted_view(box, Axis::z, options, 0, 640, 360), box), 0.059f) << azimuth << " " << elevation;
    }
}

TEST(FittedView, ShowsEveryCornerWithATargetOfOnesOwn) {
  Boxes boxes;
  for (int i = 0; i < 50; ++i) {
    const Bounds box = boxes.next();
    CameraOptions options;
    options.target = box.low;
    const View view = fitted_view(box, Axis::y, options, 0, 640, 360);
    EXPECT_GE(room_left(view, box), 0.059f);
    const vec3 at = view.project(box.low);
    EXPECT_NEAR(at.x, 320, 0.1f);
    EXPECT_NEAR(at.y, 180, 0.1f);
  }
}

TEST(FittedView, KeepsItsDistanceThroughAWholeOrbitAndLosesNothing) {
  Boxes boxes;
  const Bounds box = boxes.next();
  CameraOptions options;
  options.orbit_deg = 360;
  const float distance = glm::length(fitted_view(box, Axis::y, options, 0, 640, 360).eye - box.centre());
  for (float turned = 0; turned < 360; turned += 20) {
    const View view = fitted_view(box, Axis::y, options, turned, 640, 360);
    EXPECT_NEAR(glm::length(view.eye - box.centre()), distance, 1e-3f * distance);
    EXPECT_GE(room_left(view, box), 0.05f) << turned;
  }
}

TEST(FittedView, TakesAnEyeAsGivenAndTurnsItAboutTheTarget) {
  CameraOptions options;
  options.eye = vec3{3, 1, 0};
  options.target = vec3{0};
  const Bounds box{vec3{-1}, vec3{1}};
  EXPECT_EQ(fitted_view(box, Axis::y, options, 0, 64, 64).eye, vec3(3, 1, 0));
  options.orbit_deg = 90;
  const vec3 turned = fitted_view(box, Axis::y, options, 90, 64, 64).eye;
  EXPECT_NEAR(glm::length(turned - vec3(0, 1, -3)), 0, 1e-5f);
}

TEST(FittedView, AzimuthNinetyStandsOnTheSideOfX) {
  for (const Axis up : {Axis::y, Axis::z}) {
    CameraOptions options;
    options.azimuth_deg = 90;
    options.elevation_deg = 0;
    const View view = fitted_view({vec3{-1}, vec3{1}}, up, options, 0, 64, 64);
    EXPECT_NEAR(view.forward.x, -1, 1e-5f);
    EXPECT_NEAR(glm::dot(view.up, direction_of(up)), 1, 1e-5f);
  }
}

TEST(FittedView, ParallelRaysKeepTheHeightThatIsAskedFor) {
  CameraOptions options;
  options.orthographic_height = 4;
  const View view = fitted_view({vec3{-1}, vec3{1}}, Axis::y, options, 0, 640, 360);
  EXPECT_EQ(view.projection, Projection::orthographic);
  EXPECT_FLOAT_EQ(view.half_height, 2);
  for (const vec3 corner : corners_of({vec3{-1}, vec3{1}})) EXPECT_GT(view.project(corner).z, 0);
}

TEST(FittedView, IsFiniteForNothingAndForOnePoint) {
  for (const Bounds& bounds : {Bounds{}, Bounds{vec3{2}, vec3{2}}}) {
    const View view = fitted_view(bounds, Axis::y, {}, 0, 64, 64);
    EXPECT_TRUE(std::isfinite(glm::length(view.eye)));
    EXPECT_NEAR(glm::length(view.forward), 1, 1e-5f);
  }
}

TEST(FittedView, RefusesWhatNoCameraCanDo) {
  const auto refused = [](auto change) {
    CameraOptions options;
    change(options);
    EXPECT_THROW(fitted_view({vec3{-1}, vec3{1}}, Axis::y, options, 0, 64, 64), Error);
  };
  refused([](auto& o) { o.fov_deg = 0; });
  refused([](auto& o) { o.fov_deg = 180; });
  refused([](auto& o) { o.elevation_deg = 91; });
  refused([](auto& o) { o.distance = -1; });
  refused([](auto& o) { o.orthographic_height = 0; });
  refused([](auto& o) { o.eye = o.target = vec3{1}; });
}

}  // namespace
}  // namespace meniscus
