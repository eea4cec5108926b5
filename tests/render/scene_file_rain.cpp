#include "scene_file_fixture.h"

namespace meniscus {
namespace {

using SceneFileRain = SceneFileTest;

TEST_F(SceneFileRain, IsReadWhole) {
  const SceneFile scene = read(R"({"rain": {
    "rate_mm_h": 50, "wind": [1, 0, -2], "gust": 0.5, "gust_period": 3, "seed": 9, "start": 1, "duration": 20,
    "rained_mm": 4, "smallest_mm": 0.4, "largest_mm": 5, "share": 0.5, "top": 12, "region": [[4, 3], [-1, -2]],
    "shutter": 0.02, "streak_reach": 9, "streak_strength": 3, "splash_size": 2, "whole_within": 6,
    "drops": [{"time": 0.5, "place": [1, 2, 3], "diameter_mm": 4}, {"time": 0.25}],
    "shown": "splashes", "ripples": false, "ripple_step": 0.02,
    "secondary": true, "bodies": "concrete", "frames": 7, "fps": 30,
    "ground": {"region": [[0, 0], [3, 2]], "cell": 0.05, "level": 0.5, "material": "steel", "ruts": 0.01,
               "slope": 0.02, "roughness": 0.001, "seed": 4}}})");
  ASSERT_TRUE(scene.picture.rain);
  const RainSettings& rain = *scene.picture.rain;
  EXPECT_EQ(rain.rain.rate_mm_h, 50);
  EXPECT_EQ(rain.rain.wind.velocity, vec3(1, 0, -2));
  EXPECT_EQ(rain.rain.low, vec2(-1, -2));
  EXPECT_EQ(rain.rain.high, vec2(4, 3));
  EXPECT_EQ(rain.shown, RainShown::splashes);
  EXPECT_FALSE(rain.with_ripples);
  EXPECT_TRUE(rain.splashes.secondary);
  EXPECT_EQ(rain.splashes.size, 2);
  EXPECT_EQ(rain.look.streak_strength, 3);
  EXPECT_EQ(rain.rain.whole_within, 6);
  ASSERT_EQ(rain.rain.drops.size(), 2u);
  EXPECT_EQ(rain.rain.drops[0].time, 0.5);
  EXPECT_EQ(rain.rain.drops[0].place, vec3(1, 2, 3));
  EXPECT_FLOAT_EQ(rain.rain.drops[0].diameter, 0.004f);
  EXPECT_FLOAT_EQ(rain.rain.drops[1].diameter, 0.002f);
  EXPECT_EQ(rain.bodies, GroundMaterial::concrete);
  EXPECT_TRUE(rain.ground.there);
  EXPECT_EQ(rain.ground.cells.material, GroundMaterial::steel);
  EXPECT_EQ(rain.ground.cells.high, vec2(3, 2));
  EXPECT_EQ(scene.video.frames_per_second, 30);
  EXPECT_EQ(rain_sequence(rain, Axis::y).frames.size(), 7u);
}

TEST_F(SceneFileRain, IsLeftOutUnlessItIsSaid) {
  EXPECT_FALSE(read(R"({"water": {"waves": {}}})").picture.rain);
  EXPECT_TRUE(read(R"({"water": {"waves": {}}, "rain": {}})").picture.rain);
}

TEST_F(SceneFileRain, SaysWhereItIsWrong) {
  const std::pair<const char*, const char*> cases[] = {
      {R"({"water": {"waves": {}}, "rain": {"rate": 5}})", "rate_mm_h"},
      {R"({"water": {"waves": {}}, "rain": {"rate_mm_h": -1}})", "rain.rate_mm_h"},
      {R"({"water": {"waves": {}}, "rain": {"wind": [0, 0]}})", "rain.wind"},
      {R"({"water": {"waves": {}}, "rain": {"shown": "splashs"}})", "splashes"},
      {R"({"water": {"waves": {}}, "rain": {"smallest_mm": 3, "largest_mm": 2}})", "rain"},
      {R"({"water": {"waves": {}}, "rain": {"frames": 3}})", "rain.frames"},
      {R"({"water": {"waves": {}}, "rain": {"wind_field": "none.xyz"}})", "rain.wind_field"},
      {R"({"rain": {}})", "nothing to fall on"},
      {R"({"rain": {"ground": {}}})", "region"},
      {R"({"rain": {"ground": {"region": [[0, 0], [0, 1]]}}})", "rain.ground.region"},
      {R"({"rain": {"ground": {"region": [[0, 0], [1, 1]], "material": "steal"}}})", "steel"},
      {R"({"rain": {"ground": {"mesh": "flor"}}, "meshes": [{"shape": "box", "name": "floor"}]})", "floor"},
      {R"({"environment": {"clouds": 2}})", "environment.clouds"},
  };
  for (const auto& [text, part] : cases) {
    const Error error = error_of(text);
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << text << "\n" << error.what();
    EXPECT_TRUE(error.detail().line) << text;
  }
}

}  // namespace
}  // namespace meniscus
