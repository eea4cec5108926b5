/// The scene file that draws the frames of a simulation that have been written.
#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "meniscus/render.h"
#include "render/json_text.h"

namespace meniscus {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;
namespace fs = std::filesystem;

/// Moves the paths of a scene file from one folder to another.
class Moved {
 public:
  Moved(const fs::path& from, const fs::path& to) : from_(fs::absolute(from)), to_(fs::absolute(to)) {}
  /// A path of a field, if it is one.
  void operator()(ordered_json& object, const char* field) const {
    if (object.is_object() && object.contains(field) && object[field].is_string())
      object[field] = (from_ / object[field].get<std::string>())
                          .lexically_normal()
                          .lexically_relative(to_.lexically_normal())
                          .string();
  }

 private:
  fs::path from_, to_;
};

ordered_json corners_of(const Bounds& box) {
  const auto point = [](vec3 p) { return ordered_json::array({p.x, p.y, p.z}); };
  return ordered_json::array({point(box.low), point(box.high)});
}

/// A member that is an object, made if it is not there.
ordered_json& object_in(ordered_json& scene, const char* name) {
  if (!scene.contains(name)) scene[name] = ordered_json::object();
  return scene[name];
}

/// A pattern as frames are found by: {} stands for a number of any width.
std::string with_plain_braces(std::string pattern) {
  const std::size_t begin = pattern.find("{:");
  const std::size_t end = begin == std::string::npos ? begin : pattern.find('}', begin);
  if (end != std::string::npos) pattern.replace(begin, end - begin + 1, "{}");
  return pattern;
}

void move_paths(ordered_json& scene, const Moved& moved) {
  if (scene.contains("environment")) moved(scene["environment"], "hdr");
  if (scene.contains("camera")) moved(scene["camera"], "path");
  if (scene.contains("output")) moved(scene["output"], "path");
  if (!scene.contains("meshes")) return;
  for (ordered_json& mesh : scene["meshes"]) {
    moved(mesh, "file");
    moved(mesh, "frames");
    if (mesh.contains("material")) moved(mesh["material"], "texture");
  }
}

}  // namespace

std::string scene_of_written_frames(const std::string& scene_path, const std::string& folder, const std::string& output,
                                    const SimulationReport& report) {
  const SceneFile read = read_scene_file(scene_path);
  if (!read.simulation) throw Error(ErrorCode::invalid_argument, "this scene file simulates nothing");
  const SimulationOptions& simulation = read.simulation->simulation;
  const JsonText text(scene_path);
  ordered_json scene = ordered_json::parse(text.root().dump());
  scene.erase("$schema");
  const fs::path to = fs::absolute(folder.empty() ? "." : folder).lexically_normal();
  move_paths(scene, Moved(fs::absolute(scene_path).parent_path(), to));

  // The water comes from files, and what was taken from the simulation is said.
  ordered_json& water = scene["water"];
  water.erase("simulation");
  water["frames"] = with_plain_braces(fs::absolute(output).lexically_normal().lexically_relative(to).string());
  const std::size_t last = report.frames.empty() ? 0 : report.frames.size() - 1;
  if (report.frames.size() > 1 && !water.contains("last")) water["last"] = last;
  water["spacing"] = read.spacing.value_or(simulation.fluid.spacing);
  water["up"] = std::string(name_of(simulation.up));
  ordered_json& tank = object_in(scene, "tank");
  if (!tank.contains("inside")) tank["inside"] = corners_of(simulation.tank);
  ordered_json& ground = object_in(scene, "ground");
  if (!ground.contains("height")) ground["height"] = *read.picture.ground_height;
  object_in(scene, "output")["fps"] = read.video.frames_per_second;

  // Bodies go their ways.
  if (scene.contains("meshes"))
    for (std::size_t i = 0; i < scene["meshes"].size(); ++i) {
      ordered_json& mesh = scene["meshes"][i];
      mesh.erase("obstacle");
      if (i < report.ways.size() && !report.ways[i].empty())
        mesh["frames"] = fs::absolute(report.ways[i]).lexically_normal().lexically_relative(to).string();
    }
  return scene.dump(2) + "\n";
}

}  // namespace meniscus
