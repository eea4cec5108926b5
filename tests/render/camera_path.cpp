#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>

#include "meniscus/render.h"

namespace meniscus {
namespace {

CameraPath uneven_path() {
  return {{{0, {0, 1, 5}, {0, 0, 0}, 35},
           {10, {3, 2, 4}, {1, 0, 0}, 30},
           {12, {5, 2, 0}, {1, 1, 0}, 50},
           {40, {0, 9, 0}, {0, 0, 1}, 20}},
          false};
}

TEST(CameraPath, PassesThroughItsKeys) {
  const CameraPath path = uneven_path();
  for (const CameraKey& key : path.keys()) {
    const CameraKey there = path.at(key.at);
    EXPECT_NEAR(glm::length(there.eye - key.eye), 0, 1e-5f);
    EXPECT_NEAR(glm::length(there.target - key.target), 0, 1e-5f);
    EXPECT_NEAR(there.fov_deg, key.fov_deg, 1e-4f);
  }
}

TEST(CameraPath, GoesThroughItsKeysWithoutAKink) {
  const CameraPath path = uneven_path();
  const double step = 2e-3;
  for (const double at : {10.0, 12.0}) {
    const vec3 before = (path.at(at).eye - path.at(at - step).eye) / static_cast<float>(step);
    const vec3 after = (path.at(at + step).eye - path.at(at).eye) / static_cast<float>(step);
    EXPECT_LT(glm::length(after - before), 0.05f * glm::length(after));
  }
}

TEST(CameraPath, KeepsAStraightEvenPathStraightAndEven) {
  const CameraPath path({{0, {0, 0, 0}, {9, 0, 0}, 35}, {1, {1, 2, 3}, {9, 0, 0}, 35}, {2, {2, 4, 6}, {9, 0, 0}, 35}},
                        false);
  for (double at = 0; at <= 2; at += 0.125)
    EXPECT_NEAR(glm::length(path.at(at).eye - static_cast<float>(at) * vec3(1, 2, 3)), 0, 1e-5f) << at;
}

TEST(CameraPath, EqualsTheFormulaOfCatmullAndRomBetweenEvenKeys) {
  const vec3 p0{0, 0, 0}, p1{1, 0, 2}, p2{3, 1, 0}, p3{4, 4, 4};
  const CameraPath path({{0, p0, vec3{9}, 35}, {1, p1, vec3{9}, 35}, {2, p2, vec3{9}, 35}, {3, p3, vec3{9}, 35}},
                        false);
  for (float u = 0; u <= 1; u += 0.25f) {
    const vec3 expected = 0.5f * (2.0f * p1 + (p2 - p0) * u + (2.0f * p0 - 5.0f * p1 + 4.0f * p2 - p3) * u * u +
                                  (3.0f * p1 - p0 - 3.0f * p2 + p3) * u * u * u);
    EXPECT_NEAR(glm::length(path.at(1.0 + u).eye - expected), 0, 1e-5f) << u;
  }
}

TEST(CameraPath, StandsStillBeforeItsFirstKeyAndAfterItsLast) {
  const CameraPath path = uneven_path();
  EXPECT_EQ(path.at(-5).eye, path.keys().front().eye);
  EXPECT_EQ(path.at(99).eye, path.keys().back().eye);
}

/// Reads a camera file of this text; returns the error's message, empty if there was none.
std::string error_of(const std::string& text) {
  const std::string path = ::testing::TempDir() + "camera_path_" + std::to_string(::getpid()) + ".json";
  std::ofstream(path) << text;
  std::string message;
  try {
    static_cast<void>(read_camera_path(path));
  } catch (const Error& error) {
    message = error.what();
    EXPECT_NE(message.find(path), std::string::npos) << message;
  }
  std::filesystem::remove(path);
  return message;
}

TEST(CameraFile, IsRead) {
  EXPECT_EQ(error_of(R"({"keys": [{"frame": 0, "eye": [0,1,5], "target": [0,0,0], "fov": 40},
                                  {"frame": 9, "eye": [0,1,6], "target": [0,0,0]}]})"),
            "");
}

TEST(CameraFile, ErrorsNameTheField) {
  const auto names = [](const std::string& text, const std::string& field) {
    const std::string message = error_of(text);
    EXPECT_NE(message.find(field), std::string::npos) << message;
  };
  names("[]", "keys");
  names(R"({"keys": []})", "keys");
  names(R"({"keys": [{"frame": 0, "target": [0,0,0]}]})", "keys[0].eye");
  names(R"({"keys": [{"frame": 0, "eye": [0,1], "target": [0,0,0]}]})", "keys[0].eye");
  names(R"({"keys": [{"frame": 0, "eye": [0,1,"x"], "target": [0,0,0]}]})", "keys[0].eye[2]");
  names(R"({"keys": [{"eye": [0,1,1], "target": [0,0,0]}]})", "keys[0]");
  names(R"({"keys": [{"frame": 0, "eye": [0,1,1], "target": [0,0,0], "fov": 200}]})", "keys[0].fov");
  names(R"({"keys": [{"frame": 3, "eye": [0,1,1], "target": [0,0,0]},
                     {"frame": 3, "eye": [0,1,2], "target": [0,0,0]}]})",
        "keys[1].frame");
  names("{ nonsense", "JSON");
}

}  // namespace
}  // namespace meniscus
