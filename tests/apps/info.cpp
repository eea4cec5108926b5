#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "program.h"

namespace meniscus {
namespace {

using nlohmann::json;

TEST(Info, PrintsWhatAFrameHolds) {
  const Folder folder;
  folder.write_block("block.xyz", 10);
  const Outcome run = run_program({"info", folder / "block.xyz", "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json frame = json::parse(run.out)["frames"][0];
  EXPECT_EQ(frame["path"], folder / "block.xyz");
  EXPECT_EQ(frame["format"], "xyz");
  EXPECT_EQ(frame["particles"], 1000);
  EXPECT_TRUE(frame["attributes"].is_array());
  EXPECT_NEAR(frame["bounds"][1][2].get<double>(), 0.9, 1e-6);
  const double spacing = frame["spacing"];
  EXPECT_NEAR(spacing, 0.1, 0.015);
  EXPECT_NEAR(frame["radius"].get<double>(), spacing / 2, 1e-6);
  EXPECT_NEAR(frame["smoothing_length"].get<double>(), 2 * spacing, 1e-6);
  EXPECT_EQ(frame["up"], "y");
}

TEST(Info, TakesWhatItIsTold) {
  const Folder folder;
  folder.write_block("block.xyz");
  const Outcome run = run_program({"info", folder / "block.xyz", "--json", "--spacing", "0.3", "--up", "z"});
  const json frame = json::parse(run.out)["frames"][0];
  EXPECT_EQ(frame["spacing"], 0.3);
  EXPECT_EQ(frame["radius"], 0.15);
  EXPECT_EQ(frame["up"], "z");
}

TEST(Info, TellsEveryGuessWithItsOption) {
  const Folder folder;
  folder.write_block("block.xyz");
  const std::string out = run_program({"info", folder / "block.xyz"}).out;
  for (const char* part : {"125 particles", "--spacing", "--smoothing-length", "--up", "--azimuth", "--ground-height"})
    EXPECT_NE(out.find(part), std::string::npos) << part << "\n" << out;
}

TEST(Info, CountsParticlesThatAreNowhere) {
  const Folder folder;
  folder.write_block("block.xyz", 3);
  folder.write("broken.xyz", folder.read("block.xyz") + "nan 0 0\n0 inf 0\n");
  const Outcome run = run_program({"info", folder / "broken.xyz", "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json frame = json::parse(run.out)["frames"][0];
  EXPECT_EQ(frame["particles"], 27);
  EXPECT_EQ(frame["dropped_non_finite"], 2);
}

TEST(Info, TellsOfAllFramesAndFailsIfOneCannotBeRead) {
  const Folder folder;
  folder.write_block("f_1.xyz");
  folder.write("f_2.xyz", "1 2 three\n");
  folder.write("f_3.xyz", "");
  const Outcome run = run_program({"info", folder.path(), "--json"});
  EXPECT_EQ(run.exit_code, 1);
  const json frames = json::parse(run.out)["frames"];
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames[0]["particles"], 125);
  EXPECT_TRUE(frames[1].contains("error"));
  EXPECT_NE(run.err.find("f_2.xyz"), std::string::npos);
}

}  // namespace
}  // namespace meniscus
