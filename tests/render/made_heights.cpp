#include <gtest/gtest.h>

#include "meniscus/render.h"

namespace meniscus {
namespace {

/// Waves in a tiled tank, by rays through the water.
Image<vec3> drawn(const Bounds& water) {
  const Bounds inside{{-0.4f, 0, -0.2f}, {2.4f, 0.75f, 2.9f}};
  MadeHeights made;
  made.region = water;
  made.step = 0.02f;
  made.frames = 1;
  made.waves.resize(1);
  made.waves[0].amplitude = 0.014f;
  PictureOptions options;
  options.width = options.height = 64;
  options.method = SurfaceMethod::height_field;
  options.heights = made_heights(made, Axis::y);
  options.tank = TankStyle::tiled;
  options.tank_inside = inside;
  options.optics.refraction = RefractionMethod::ray_traced;
  options.caustics = options.shadow = false;
  options.antialias = Antialias::off;
  options.camera.eye = vec3(1.3f, 1.8f, 3.7f);
  options.camera.target = vec3(1, 0.46f, 1);
  const FrameSequence sequence = heights_sequence(made, Axis::y);
  const Survey survey = survey_frames(sequence);
  FrameSettings settings = settings_of(survey, options);
  settings.heights = options.heights;
  settings.view = view_of(survey, options, 0, 1, 25);
  return render_frame(sequence.source(sequence.frames[0]), settings).radiance;
}

TEST(MadeHeights, StandAgainstWallsAsWaterThatReachesBehindThem) {
  const Bounds exact{{-0.4f, 0, -0.2f}, {2.4f, 0.5f, 2.9f}},
      behind{{-0.402f, -0.002f, -0.202f}, {2.402f, 0.5f, 2.902f}};
  const Image<vec3> pictures[] = {drawn(exact), drawn(behind)};
  std::size_t different = 0;
  for (std::size_t i = 0; i < pictures[0].size(); ++i) {
    const vec3 difference = glm::abs(pictures[0][i] - pictures[1][i]);
    different += std::max({difference.x, difference.y, difference.z}) > 0.05f;
  }
  EXPECT_LT(different, pictures[0].size() / 50) << "joints and the waterline move by a little, and nothing else";
}

}  // namespace
}  // namespace meniscus
