#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "meniscus/render.h"

namespace meniscus {
namespace {

/// The scene files of a folder; lists of transforms beside them have no schema.
std::vector<std::string> scenes_in(const std::string& folder) {
  std::vector<std::string> scenes;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".json") continue;
    std::ifstream file(entry.path());
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    if (text.find("scene.schema.json") != std::string::npos) scenes.push_back(entry.path().string());
  }
  return scenes;
}

TEST(Examples, AreReadAndHaveWater) {
  const std::string folder = std::string(MENISCUS_SOURCE_DIR) + "/examples";
  std::vector<std::string> scenes = scenes_in(folder);
  EXPECT_GE(scenes.size(), 9u);
  for (const char* figures : {"/cords", "/rain"})
    for (const std::string& scene : scenes_in(folder + figures)) scenes.push_back(scene);
  EXPECT_GE(scenes.size(), 23u);
  for (const std::string& path : scenes) {
    try {
      const SceneFile scene = read_scene_file(path);
      EXPECT_EQ(scene.frames.empty(), scene.waves || scene.simulation || scene.heights || scene.picture.rain) << path;
      if (scene.simulation) {
        EXPECT_GT(simulated_sequence(*scene.simulation, scene.picture.bodies).frames.size(), 1u) << path;
      }
    } catch (const Error& error) {
      ADD_FAILURE() << path << ": " << error.what();
    }
  }
}

TEST(Examples, AfterTheFiguresOfCordsHaveTheirNumbersOfParticles) {
  const std::string folder = std::string(MENISCUS_SOURCE_DIR) + "/examples/cords/";
  const std::pair<const char*, double> published[] = {
      {"fig9", 2000}, {"fig12a", 2000}, {"fig12b", 3000}, {"fig12c", 2000}};
  for (const auto& [name, particles] : published) {
    const SceneFile scene = read_scene_file(folder + name + ".json");
    SimulatedScene simulated(*scene.simulation, scene.picture.bodies);
    EXPECT_NEAR(static_cast<double>(simulated.frame(0).size()), particles, 0.12 * particles) << name;
  }
}

}  // namespace
}  // namespace meniscus
