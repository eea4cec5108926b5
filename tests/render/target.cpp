#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "meniscus/render.h"

namespace meniscus {
namespace {

TEST(OutputTarget, KnowsItsFormatByItsExtension) {
  EXPECT_EQ(OutputTarget("a.png").format(), PictureFormat::png);
  EXPECT_EQ(OutputTarget("dir.mp4/a.EXR").format(), PictureFormat::exr);
  EXPECT_TRUE(OutputTarget("film.mp4").is_film());
  for (const char* path : {"", "a", "a.jpg", "dir.png/a", "film_{}.mp4"})
    EXPECT_THROW(OutputTarget{path}, Error) << path;
}

TEST(OutputTarget, PutsTheFrameNumberIntoItsPattern) {
  EXPECT_EQ(OutputTarget("a/{}.png").path_of(7), "a/7.png");
  EXPECT_EQ(OutputTarget("a/{:04}.png").path_of(7), "a/0007.png");
  EXPECT_EQ(OutputTarget("a/{:04d}.png").path_of(12345), "a/12345.png");
  EXPECT_EQ(OutputTarget("{}/f_{:2}.exr").path_of(3), "3/f_03.exr");
  EXPECT_EQ(OutputTarget("still.png").path_of(3), "still.png");
  EXPECT_FALSE(OutputTarget("still.png").is_pattern());
  for (const char* path : {"{.png", "{x}.png", "{:x}.png", "{:04", "{:999}.png"})
    EXPECT_THROW(OutputTarget{path}, Error) << path;
}

TEST(OutputTarget, MakesItsDirectoryAndLeavesNothingElseThere) {
  const std::string directory = ::testing::TempDir() + "target_" + std::to_string(::getpid()) + "/deep/er";
  OutputTarget(directory + "/{}.png").prepare();
  EXPECT_TRUE(std::filesystem::is_directory(directory));
  EXPECT_TRUE(std::filesystem::is_empty(directory));
  std::filesystem::remove_all(::testing::TempDir() + "target_" + std::to_string(::getpid()));
}

TEST(OutputTarget, RefusesAPlaceThatCannotBeWrittenAndNamesIt) {
  const std::string file = ::testing::TempDir() + "target_" + std::to_string(::getpid()) + "_file";
  std::ofstream(file) << "x";
  for (const std::string& path : {file + "/still.png", std::string("/proc/nowhere/still.png")}) {
    try {
      OutputTarget(path).prepare();
      ADD_FAILURE() << path;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::io_failed);
      EXPECT_NE(std::string(error.what()).find(path), std::string::npos) << error.what();
    }
  }
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace meniscus
