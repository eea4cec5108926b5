#include <gtest/gtest.h>

#include <filesystem>

#include "meniscus/io.h"
#include "meniscus/output.h"
#include "program.h"

namespace meniscus {
namespace {

const char* kScene =
    "{\"water\": {\"extinction\": [0.5, 0.2, 0.1], \"simulation\": {\"solver\": \"pbf\", \"spacing\": 0.05, "
    "\"frames\": 3, \"tank\": [[0, 0, 0], "
    "[0.6, 0.6, 0.4]], \"blocks\": [[[0, 0, 0], [0.3, 0.3, 0.4]]]}}, \"meshes\": [{\"name\": \"ball\", \"shape\": "
    "\"sphere\", \"scale\": 0.1, \"translate\": [0.45, 0.4, 0.2], \"obstacle\": {\"motion\": \"dynamic\"}}], "
    "\"ground\": {\"style\": \"plain\"}, \"lights\": {\"sun\": {\"azimuth\": 40, \"elevation\": 60}}, \"camera\": "
    "{\"eye\": [0.3, 0.5, 1.6], \"target\": [0.3, 0.2, 0.2]}, \"picture\": {\"size\": [48, 32]}}";

TEST(Simulate, WritesFramesThatAreReadAndDrawn) {
  const Folder folder;
  folder.write("scene.json", kScene);
  const Outcome run = run_program(
      {"simulate", folder / "scene.json", "-o", folder / "frames/{:02}.ply", "--report", folder / "report.json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.out.find("frames/draw.json"), std::string::npos) << "it says how to draw them: " << run.out;
  EXPECT_TRUE(folder.has("report.json"));
  EXPECT_TRUE(folder.has("frames/ball_way.json"));
  const Particles last = read_particles(folder / "frames/02.ply");
  EXPECT_EQ(last.size(), 288u);
  EXPECT_TRUE(last.find("velocity"));
  const Outcome told = run_program({"info", folder / "frames/02.ply", "--json"});
  EXPECT_EQ(told.exit_code, 0) << told.err;
  EXPECT_NE(told.out.find("velocity"), std::string::npos);

  // Where nothing is left to guesses: drawn from files or while it is simulated, it is the same picture.
  const Outcome written = run_program({"render", folder / "frames/draw.json", "-o", folder / "a_{}.png"});
  ASSERT_EQ(written.exit_code, 0) << written.err;
  const Outcome live = run_program({"render", folder / "scene.json", "-o", folder / "b_{}.png", "--frames", "2:3"});
  ASSERT_EQ(live.exit_code, 0) << live.err;
  EXPECT_TRUE(folder.has("a_0.png"));
  EXPECT_FALSE(folder.has("b_1.png")) << "only the frames that were asked for";
  const ImageDifference difference = compare(read_png(folder / "a_2.png"), read_png(folder / "b_2.png"));
  EXPECT_GT(difference.psnr_db, 30);
}

TEST(Simulate, LeavesFramesThatAreThere) {
  const Folder folder;
  folder.write("scene.json", kScene);
  ASSERT_EQ(run_program({"simulate", folder / "scene.json", "-o", folder / "{}.ply", "--frames", "2"}).exit_code, 0);
  std::string kept = folder.read("1.ply");
  kept.back() = static_cast<char>(kept.back() ^ 1);  // another frame of the same length
  folder.write("1.ply", kept);
  folder.write("0.ply", kept.substr(0, kept.size() - 1));
  const Outcome run = run_program({"simulate", folder / "scene.json", "-o", folder / "{}.ply", "--resume"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.err.find("is there already"), std::string::npos) << run.err;
  EXPECT_EQ(read_particles(folder / "2.ply").size(), 288u);
  EXPECT_EQ(read_particles(folder / "0.ply").size(), 288u) << "what was cut off is written anew";
  EXPECT_TRUE(folder.read("1.ply") == kept);
  EXPECT_NE(run.out.find("2 frames written, 1 kept"), std::string::npos) << run.out;
}

TEST(Simulate, TakesNamesWithoutFolders) {
  const Folder folder;
  folder.write("scene.json", kScene);
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(folder / "");
  const Outcome run = run_program({"simulate", "scene.json", "-o", "{}.ply", "--frames", "2"});
  std::filesystem::current_path(before);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(folder.has("draw.json"));
}

TEST(Simulate, RefusesWhatCannotBeMeant) {
  const Folder folder;
  folder.write("scene.json", kScene);
  folder.write("still.json", "{}");
  const std::string scene = folder / "scene.json";
  EXPECT_EQ(run_program({"simulate", scene, "-o", folder / "one.ply"}).exit_code, 2) << "three frames in one file";
  EXPECT_EQ(run_program({"simulate", scene, "-o", folder / "film.mp4"}).exit_code, 2);
  EXPECT_EQ(run_program({"simulate", scene}).exit_code, 2);
  EXPECT_EQ(run_program({"simulate", scene, "-o", folder / "{}.ply", "--solver", "euler"}).exit_code, 2);
  EXPECT_EQ(run_program({"simulate", folder / "still.json", "-o", folder / "{}.ply"}).exit_code, 2);
  EXPECT_FALSE(folder.has("0.ply"));
}

TEST(Info, TellsOfASimulationWithoutRunningIt) {
  const Folder folder;
  folder.write("scene.json", kScene);
  const Outcome run = run_program({"info", folder / "scene.json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  for (const char* part : {"3 simulated frames", "288 particles at the start", "spacing 0.05 m", "0.6, 0.6, 0.4",
                           "obstacle ball: dynamic"})
    EXPECT_NE(run.out.find(part), std::string::npos) << part << " in " << run.out;
  const Outcome json = run_program({"info", folder / "scene.json", "--json"});
  EXPECT_NE(json.out.find("\"particles_at_start\": 288"), std::string::npos) << json.out;
}

}  // namespace
}  // namespace meniscus
