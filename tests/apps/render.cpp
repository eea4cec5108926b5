#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "meniscus/output.h"
#include "program.h"

namespace meniscus {
namespace {

using nlohmann::json;

Outcome render(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "render");
  if (std::find(arguments.begin(), arguments.end(), "--size") == arguments.end())
    arguments.insert(arguments.end(), {"--size", "96x64"});
  return run_program(arguments);
}

/// Three frames, one of them hardly readable as a number sequence: 8, 9, 10.
void write_three(const Folder& folder) {
  folder.write_block("in/f_8.xyz", 5, 0);
  folder.write_block("in/f_9.xyz", 5, 0.1f);
  folder.write_block("in/f_10.xyz", 5, 0.2f);
}

TEST(Render, DrawsOneFrameAsPng) {
  const Folder folder;
  folder.write_block("block.xyz");
  const Outcome run = render({folder / "block.xyz", "-o", folder / "out/deep/block.png"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Image<Rgb8> picture = read_png(folder / "out/deep/block.png");
  EXPECT_EQ(picture.width(), 96);
  EXPECT_EQ(picture.height(), 64);
  EXPECT_NE(run.out.find("march"), std::string::npos) << run.out;
}

TEST(Render, WritesLayersForCompositors) {
  const Folder folder;
  folder.write_block("block.xyz");
  ASSERT_EQ(render({folder / "block.xyz", "-o", folder / "block.exr"}).exit_code, 0);
  std::vector<std::string> names;
  for (const auto& [name, image] : read_exr(folder / "block.exr")) names.push_back(name);
  for (const char* name : {"R", "G", "B", "Z", "normal.X", "normal.Y", "normal.Z", "thickness", "coverage"})
    EXPECT_NE(std::find(names.begin(), names.end(), name), names.end()) << name;
  ASSERT_EQ(render({folder / "block.xyz", "-o", folder / "few.exr", "--layers", "depth,coverage"}).exit_code, 0);
  EXPECT_EQ(read_exr(folder / "few.exr").size(), 2u);
}

TEST(Render, DrawsASequenceIntoAPatternByItsFrameNumbers) {
  const Folder folder;
  write_three(folder);
  const Outcome run = render({folder / "in", "-o", folder / "out/{:03}.png", "--report", folder / "report.json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  for (const char* name : {"out/008.png", "out/009.png", "out/010.png"}) EXPECT_TRUE(folder.has(name)) << name;
  EXPECT_NE(run.err.find("3/3 f_10.xyz"), std::string::npos) << "a line for each picture: " << run.err;
  const json report = json::parse(folder.read("report.json"));
  ASSERT_EQ(report["frames"].size(), 3u);
  EXPECT_GT(report["peak_rss_bytes"].get<double>(), 1e6);
  for (const json& frame : report["frames"]) {
    EXPECT_EQ(frame["particles"], 125);
    EXPECT_EQ(frame["width"], 96);
    EXPECT_EQ(frame["height"], 64);
    EXPECT_GT(frame["frame_ms"].get<double>(), 0);
    EXPECT_TRUE(frame["stages_ms"].contains("march"));
    EXPECT_EQ(frame["path"].get<std::string>().rfind(folder / "in", 0), 0u);
  }
}

TEST(Render, DrawsASequenceIntoAFilm) {
  const Folder folder;
  write_three(folder);
  const Outcome run = render({folder / "in", "-o", folder / "film.mp4", "--fps", "30", "--quiet"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.out + run.err, "") << "quiet";
  const std::string film = folder.read("film.mp4");
  EXPECT_EQ(film.substr(4, 4), "ftyp");
}

TEST(Render, PicksFrames) {
  const Folder folder;
  write_three(folder);
  ASSERT_EQ(render({folder / "in", "-o", folder / "out/{}.png", "--frames", "0:3:2"}).exit_code, 0);
  EXPECT_TRUE(folder.has("out/8.png") && folder.has("out/10.png"));
  EXPECT_FALSE(folder.has("out/9.png"));
}

TEST(Render, TurnsAboutOneFrame) {
  const Folder folder;
  folder.write_block("block.xyz");
  ASSERT_EQ(render({folder / "block.xyz", "-o", folder / "turn/{}.png", "--orbit", "360", "--frames", "4"}).exit_code,
            0);
  EXPECT_TRUE(folder.has("turn/0.png") && folder.has("turn/3.png"));
  EXPECT_FALSE(folder.has("turn/4.png"));
  EXPECT_NE(folder.read("turn/0.png"), folder.read("turn/1.png"));
}

TEST(Render, FollowsACameraFile) {
  const Folder folder;
  folder.write_block("block.xyz");
  folder.write("camera.json", R"({"keys": [{"frame": 0, "eye": [3, 1, 3], "target": [0, 0, 0]},
                                           {"frame": 2, "eye": [0, 2, 4], "target": [0, 0, 0], "fov": 20}]})");
  const Outcome run =
      render({folder / "block.xyz", "-o", folder / "{}.png", "--camera", folder / "camera.json", "--frames", "3"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(folder.has("2.png"));
}

TEST(Render, ResumesWhereItStopped) {
  const Folder folder;
  write_three(folder);
  folder.write("out/9.png", "finished before");
  const Outcome run = render({folder / "in", "-o", folder / "out/{}.png", "--resume"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(folder.read("out/9.png"), "finished before");
  EXPECT_TRUE(folder.has("out/8.png") && folder.has("out/10.png"));
  folder.write("film.mp4", "finished before");
  ASSERT_EQ(render({folder / "in", "-o", folder / "film.mp4", "--resume"}).exit_code, 0);
  EXPECT_EQ(folder.read("film.mp4"), "finished before");
}

TEST(Render, LeavesOutWhatCannotBeReadAndSaysSo) {
  const Folder folder;
  write_three(folder);
  folder.write("in/f_9.xyz", "0 0 0\nbroken\n");
  const Outcome run = render({folder / "in", "-o", folder / "film.mp4"});
  EXPECT_EQ(run.exit_code, 1) << run.err;
  EXPECT_NE(run.err.find("f_9.xyz"), std::string::npos);
  EXPECT_TRUE(folder.has("film.mp4"));
  const Outcome strict = render({folder / "in", "-o", folder / "strict.mp4", "--strict"});
  EXPECT_EQ(strict.exit_code, 1);
  EXPECT_NE(strict.err.find("f_9.xyz"), std::string::npos);
  EXPECT_FALSE(folder.has("strict.mp4"));
}

TEST(Render, LeavesNothingHalfWrittenBehind) {
  const Folder folder;
  folder.write_block("in/f_1.xyz");
  folder.write("in/f_2.xyz", "broken\n");
  EXPECT_EQ(render({folder / "in", "-o", folder / "out/film.mp4", "--strict"}).exit_code, 1);
  EXPECT_TRUE(!folder.has("out") || std::filesystem::is_empty(folder / "out"));
}

TEST(Render, DrawsTheSceneOfAnEmptyFrame) {
  const Folder folder;
  folder.write("empty.xyz", "");
  const Outcome run = render({folder / "empty.xyz", "-o", folder / "empty.png"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(read_png(folder / "empty.png").width(), 96);
}

TEST(Render, TellsOfParticlesThatAreNowhere) {
  const Folder folder;
  folder.write_block("block.xyz", 4);
  folder.write("broken.xyz", folder.read("block.xyz") + "nan 0 0\n-inf 2 1\n1 1 nan\n");
  const Outcome run = render({folder / "broken.xyz", "-o", folder / "out.png"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.err.find("3 particles"), std::string::npos) << run.err;
}

TEST(Render, DrawsTwoParticlesAndAllInOnePointAndAFlatSheet) {
  const Folder folder;
  folder.write("two.xyz", "0 0 0\n0.1 0 0\n");
  std::string point, sheet;
  for (int i = 0; i < 400; ++i) {
    point += "1 2 3\n";
    sheet += std::to_string(0.1 * (i % 20)) + " 0 " + std::to_string(0.1 * (i / 20)) + "\n";
  }
  folder.write("point.xyz", point);
  folder.write("sheet.xyz", sheet);
  folder.write("empty_scene.xyz", "");
  ASSERT_EQ(render({folder / "empty_scene.xyz", "-o", folder / "none.png"}).exit_code, 0);
  for (const std::string name : {"two", "point", "sheet"}) {
    const Outcome run = render({folder / (name + ".xyz"), "-o", folder / (name + ".exr")});
    ASSERT_EQ(run.exit_code, 0) << name << run.err;
    double wet = 0;
    for (const auto& [channel, image] : read_exr(folder / (name + ".exr"))) {
      if (channel == "coverage")
        for (const float c : image) wet += c;
    }
    EXPECT_GT(wet, 20) << name;
  }
}

TEST(Render, GivesTheSamePictureForAnyNumberOfThreads) {
  const Folder folder;
  folder.write_block("block.xyz");
  for (const char* threads : {"1", "2", "5"})
    ASSERT_EQ(
        render({folder / "block.xyz", "-o", folder / (std::string(threads) + ".png"), "--threads", threads}).exit_code,
        0);
  EXPECT_EQ(folder.read("1.png"), folder.read("2.png"));
  EXPECT_EQ(folder.read("1.png"), folder.read("5.png"));
}

TEST(Render, HeedsItsOptions) {
  const Folder folder;
  folder.write_block("block.xyz");
  ASSERT_EQ(render({folder / "block.xyz", "-o", folder / "plain.png"}).exit_code, 0);
  const std::string plain = folder.read("plain.png");
  const std::vector<std::vector<std::string>> changes = {{"--iso", "0.3"},
                                                         {"--normals", "gradient"},
                                                         {"--filter-radius", "0"},
                                                         {"--material", "milk"},
                                                         {"--tint", "0.9,0.2,0.1"},
                                                         {"--ground", "plain"},
                                                         {"--ground", "none"},
                                                         {"--no-shadow"},
                                                         {"--sun", "200,30"},
                                                         {"--exposure", "1"},
                                                         {"--tone", "linear"},
                                                         {"--antialias", "off"},
                                                         {"--antialias", "2x2"},
                                                         {"--azimuth", "-70"},
                                                         {"--elevation", "60"},
                                                         {"--distance", "9"},
                                                         {"--fov", "20"},
                                                         {"--orthographic", "1"},
                                                         {"--eye", "-1,2,-3"},
                                                         {"--target", "0,0,0"},
                                                         {"--up", "z"},
                                                         {"--spacing", "0.15"},
                                                         {"--kernel", "poly6"},
                                                         {"--ground-height", "-1"},
                                                         {"--extinction", "9,1,1"},
                                                         {"--smoothing-length", "0.3"}};
  for (std::vector<std::string> change : changes) {
    const std::string name = change.front() + " " + change.back();
    change.insert(change.begin(), {folder / "block.xyz", "-o", folder / "changed.png"});
    const Outcome run = render(change);
    EXPECT_EQ(run.exit_code, 0) << name << run.err;
    EXPECT_NE(folder.read("changed.png"), plain) << name;
  }
}

}  // namespace
}  // namespace meniscus
