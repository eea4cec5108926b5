#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "meniscus/output.h"
#include "program.h"

namespace meniscus {
namespace {

/// The block of Folder::write_block in a scene file with these sections besides.
std::string with_block(const std::string& sections) {
  return "{\n  \"water\": {\"frames\": \"block.xyz\"},\n  \"picture\": {\"size\": [48, 32]}" +
         (sections.empty() ? "" : ",\n  " + sections) + "\n}\n";
}

double mean_difference(const Image<Rgb8>& a, const Image<Rgb8>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    sum += std::abs(a[i].r - b[i].r) + std::abs(a[i].g - b[i].g) + std::abs(a[i].b - b[i].b);
  return sum / static_cast<double>(a.size());
}

TEST(SceneFile, IsDrawnFromWhereverItStands) {
  const Folder folder;
  folder.write_block("deep/block.xyz");
  folder.write("deep/scene.json", with_block(""));
  const Outcome run = run_program({"render", folder / "deep/scene.json", "-o", folder / "out.png"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(read_png(folder / "out.png").width(), 48);
}

TEST(SceneFile, GivesTheSamePictureAsItsOptions) {
  const Folder folder;
  folder.write_block("block.xyz");
  folder.write("scene.json", with_block("\"camera\": {\"azimuth\": 70, \"elevation\": 40}"));
  ASSERT_EQ(run_program({"render", folder / "scene.json", "-o", folder / "scene.png"}).exit_code, 0);
  ASSERT_EQ(run_program({"render", folder / "block.xyz", "-o", folder / "options.png", "--size", "48x32", "--azimuth",
                         "70", "--elevation", "40"})
                .exit_code,
            0);
  EXPECT_EQ(mean_difference(read_png(folder / "scene.png"), read_png(folder / "options.png")), 0);
}

TEST(SceneFile, IsOverriddenByOptions) {
  const Folder folder;
  folder.write_block("block.xyz");
  folder.write("scene.json", with_block("\"camera\": {\"azimuth\": 70}, \"output\": {\"path\": \"said.png\"}"));
  ASSERT_EQ(run_program({"render", folder / "scene.json"}).exit_code, 0);
  ASSERT_TRUE(folder.has("said.png")) << "beside the scene file";
  const Outcome run = run_program({"render", folder / "scene.json", "-o", folder / "other.png", "--size", "48x30"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(read_png(folder / "other.png").height(), 30);
}

TEST(SceneFile, ShowsItsMeshes) {
  const Folder folder;
  folder.write_block("block.xyz");
  folder.write("empty.json", with_block(""));
  folder.write("ball.json", with_block("\"meshes\": [{\"shape\": \"sphere\", \"translate\": [1.2, 0.4, 0.4], "
                                       "\"material\": {\"albedo\": [0.8, 0.05, 0.05]}}]"));
  ASSERT_EQ(run_program({"render", folder / "empty.json", "-o", folder / "empty.png"}).exit_code, 0);
  const Outcome run = run_program({"render", folder / "ball.json", "-o", folder / "ball.png"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_GT(mean_difference(read_png(folder / "empty.png"), read_png(folder / "ball.png")), 1.0);
}

TEST(SceneFile, PlacesBodiesByTheWholeSequenceWhateverPartIsDrawn) {
  const Folder folder;
  const auto scene = [](const std::string& frames) {
    return "{\"water\": {\"waves\": {\"particles\": 500, \"frames\": 3}}, \"picture\": {\"size\": [48, 32]},\n"
           "\"camera\": {\"target\": [1, 0.4, 0.5], \"distance\": 4}, \"meshes\": [{\"shape\": \"sphere\", "
           "\"frames\": [" +
           frames + "]}]}\n";
  };
  const std::string far_off = "{\"translate\": [500, 0, 0]}", here = "{\"translate\": [1, 0.8, 0.5]}";
  folder.write("moving.json", scene(far_off + ", " + far_off + ", " + here));
  folder.write("still.json", scene(here));
  for (const std::string name : {"moving", "still"}) {
    const Outcome run =
        run_program({"render", folder / (name + ".json"), "-o", folder / (name + ".png"), "--frames", "2:3"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }
  EXPECT_EQ(mean_difference(read_png(folder / "moving.png"), read_png(folder / "still.png")), 0);
}

TEST(SceneFile, NamesLineAndFieldOfAMistake) {
  const Folder folder;
  folder.write_block("block.xyz");
  folder.write("scene.json", with_block("\"camera\": {\"azimut\": 70}"));
  const Outcome run = run_program({"render", folder / "scene.json", "-o", folder / "out.png"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.err.find("scene.json:4"), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("camera.azimut"), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("azimuth"), std::string::npos) << run.err;
  EXPECT_FALSE(folder.has("out.png"));
}

TEST(SceneFile, StandsAlone) {
  const Folder folder;
  folder.write_block("block.xyz");
  folder.write("scene.json", with_block(""));
  EXPECT_EQ(run_program({"render", folder / "scene.json", folder / "block.xyz", "-o", folder / "out.png"}).exit_code,
            2);
  EXPECT_EQ(run_program({"render", folder / "missing.json", "-o", folder / "out.png"}).exit_code, 1);
  EXPECT_EQ(run_program({"render", folder / "scene.json"}).exit_code, 2) << "nobody says where the picture goes";
}

TEST(Surfels, AreWrittenAsPointsThatCanBeReadBack) {
  const Folder folder;
  folder.write_block("block.xyz", 8);
  const Outcome run =
      run_program({"render", folder / "block.xyz", "--surface", "surfels", "-o", folder / "surfels.ply"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Outcome told = run_program({"info", folder / "surfels.ply", "--json"});
  ASSERT_EQ(told.exit_code, 0) << told.err;
  for (const char* name : {"normal", "radius"}) EXPECT_NE(told.out.find(name), std::string::npos) << told.out;
  EXPECT_EQ(run_program({"render", folder / "block.xyz", "-o", folder / "surfels.ply"}).exit_code, 2)
      << "a ray-cast surface has none";
}

TEST(Refraction, HasThreeWays) {
  const Folder folder;
  folder.write_block("block.xyz", 8);
  Image<Rgb8> thickness;
  for (const char* way : {"thickness", "image_space", "ray_traced"}) {
    const Outcome run =
        run_program({"render", folder / "block.xyz", "-o", folder / "out.png", "--size", "64x48", "--refraction", way});
    ASSERT_EQ(run.exit_code, 0) << way << run.err;
    const Image<Rgb8> picture = read_png(folder / "out.png");
    if (thickness.empty())
      thickness = picture;
    else
      EXPECT_GT(mean_difference(thickness, picture), 0.1) << way;
  }
  EXPECT_EQ(run_program({"render", folder / "block.xyz", "-o", folder / "out.png", "--refraction", "none"}).exit_code,
            2);
}

}  // namespace
}  // namespace meniscus
