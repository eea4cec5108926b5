/// Scene files in a folder of their own.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "meniscus/render.h"

namespace meniscus {

class SceneFileTest : public testing::Test {
 protected:
  SceneFileTest() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::path(testing::TempDir()) / (std::string("scene_") + test->name());
    std::filesystem::create_directories(folder_);
  }
  ~SceneFileTest() override { std::filesystem::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return path_of(name);
  }
  std::string path_of(const std::string& name) const { return (folder_ / name).string(); }
  SceneFile read(const std::string& text) const { return read_scene_file(write("scene.json", text)); }
  Error error_of(const std::string& text) const {
    try {
      read(text);
    } catch (const Error& error) {
      return error;
    }
    return {ErrorCode::invalid_argument, "nothing was refused"};
  }

 private:
  std::filesystem::path folder_;
};

}  // namespace meniscus
