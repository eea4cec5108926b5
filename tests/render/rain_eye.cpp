#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "meniscus/render.h"

namespace meniscus {
namespace {

/// Rain on a square metre of ground.
PictureOptions picture() {
  PictureOptions options;
  RainSettings& rain = options.rain.emplace();
  rain.ground.there = true;
  rain.ground.cells.low = {-0.5f, -0.5f};
  rain.ground.cells.high = {0.5f, 0.5f};
  rain.ground.cells.cell = 0.1f;
  rain.with_ripples = false;
  rain.frames = 50;
  return options;
}

RainOptions rain_for(const PictureOptions& options) {
  const Survey survey = survey_frames(rain_sequence(*options.rain, Axis::y));
  return settings_of(survey, options).rain->settings().rain;
}

CameraPath path(bool in_seconds) {
  CameraKey first, last;
  first.eye = {0, 1, 2};
  last.at = in_seconds ? 2 : 50;
  last.eye = {4, 1, 2};
  return CameraPath({first, last}, in_seconds);
}

TEST(RainEye, IsWhereTheCameraIsAtEachTime) {
  for (const bool in_seconds : {false, true}) {
    PictureOptions options = picture();
    options.path = path(in_seconds);
    const Survey survey = survey_frames(rain_sequence(*options.rain, Axis::y));
    const RainOptions rain = rain_for(options);
    ASSERT_TRUE(rain.eye);
    for (const std::size_t frame : {0u, 10u, 49u})
      EXPECT_LT(glm::distance(rain.eye(static_cast<double>(frame) / 25), view_of(survey, options, frame, 50, 25).eye),
                1e-5f);
    // It goes on between the pictures, and stays before and after.
    EXPECT_LT(glm::distance(rain.eye(0.5), rain.eye(0.501)), 0.01f);
    EXPECT_NE(rain.eye(0.5), rain.eye(0.501));
    EXPECT_EQ(rain.eye(-3), (vec3{0, 1, 2}));
    EXPECT_EQ(rain.eye(1000), (vec3{4, 1, 2}));
  }
}

TEST(RainEye, GoesRoundWithAnOrbitOrStaysWhereItIs) {
  PictureOptions options = picture();
  const Survey survey = survey_frames(rain_sequence(*options.rain, Axis::y));
  EXPECT_EQ(rain_for(options).eye(1), view_of(survey, options, 0, 1, 25).eye);
  options.camera.orbit_deg = 90;
  const RainOptions rain = rain_for(options);
  for (const std::size_t frame : {0u, 13u, 49u}) {
    const vec3 eye = view_of(survey, options, frame, 50, 25).eye;
    EXPECT_LT(glm::distance(rain.eye(static_cast<double>(frame) / 25), eye), 1e-3f * glm::length(eye));
  }
}

TEST(RainEye, IsNotThereWhereAllPlacesAreToBeAlike) {
  PictureOptions options = picture();
  options.rain->rain.whole_within = 0;
  EXPECT_FALSE(rain_for(options).eye);
  options = picture();
  options.rain->rain.share = 0.5f;
  EXPECT_FALSE(rain_for(options).eye);
}

}  // namespace
}  // namespace meniscus
