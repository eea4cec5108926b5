#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>

#include "commands.h"
#include "json.h"
#include "meniscus/render.h"
#include "progress.h"

namespace meniscus::apps {
namespace {

struct SimulateArguments {
  std::string scene, output, report_path, solver;
  std::optional<std::size_t> frames;
  std::optional<double> frames_per_second;
  std::optional<float> spacing, step;
  bool resume = false, quiet = false;
  int threads = 0;
};

Json report_json(const SimulationReport& report) {
  Json json;
  json["frames"] = Json::array();
  for (const SimulatedFrame& frame : report.frames) {
    Json one;
    one["output"] = frame.output;
    one["particles"] = frame.particles;
    one["time"] = frame.time;
    one["steps"] = frame.steps;
    one["mean_neighbours"] = frame.mean_neighbours;
    one["kinetic_energy"] = frame.kinetic_energy;
    if (frame.skipped) one["skipped"] = true;
    one["stages_ms"] = json_of(frame.times);
    one["frame_ms"] = frame.frame_ms;
    json["frames"].push_back(std::move(one));
  }
  json["ways"] = Json::array();
  for (const std::string& way : report.ways)
    if (!way.empty()) json["ways"].push_back(way);
  json["peak_rss_bytes"] = peak_rss_bytes();
  return json;
}

/// The scene's simulation with what the arguments say instead.
SimulatedWater water_of(const SceneFile& scene, const SimulateArguments& arguments) {
  if (!scene.simulation)
    throw Error(
        ErrorCode::invalid_argument,
        {"the scene file simulates nothing", "\"water\": {\"simulation\": {...}}", {}, arguments.scene, {}, {}, {}});
  SimulatedWater water = *scene.simulation;
  if (arguments.frames) water.frames = *arguments.frames;
  if (arguments.frames_per_second) water.frames_per_second = *arguments.frames_per_second;
  if (arguments.spacing) water.simulation.fluid.spacing = *arguments.spacing;
  if (arguments.step) water.simulation.fluid.step = *arguments.step;
  if (!arguments.solver.empty()) water.simulation.fluid.solver = solver_of(arguments.solver);
  return water;
}

/// Where the scene file goes that draws the frames: beside them, over no other file of the user's.
std::string drawing_scene_path(const SimulateArguments& arguments) {
  const std::filesystem::path path = std::filesystem::path(arguments.output).parent_path() / "draw.json";
  std::error_code ignored;
  if (std::filesystem::equivalent(path, arguments.scene, ignored))
    throw UsageError(path.string() + " would be written over: write the frames to another folder");
  return path.string();
}

void tell(const SimulatedFrame& frame, std::size_t index, std::size_t count) {
  std::cerr << fmt::format("{}/{} {}{} (t = {:.4g} s, {} particles, {} steps, {:.2f} s)\n", index + 1, count,
                           frame.output, frame.skipped ? " is there already" : "", frame.time, frame.particles,
                           frame.steps, frame.frame_ms / 1000);
}

void simulate(const SimulateArguments& arguments) {
  const SceneFile scene = read_scene_file(arguments.scene);
  const SimulatedWater water = water_of(scene, arguments);
  const ThreadLimit limit(arguments.threads);
  SimulatedScene simulated(water, scene.picture.bodies);
  const std::string drawing = drawing_scene_path(arguments);
  auto on_frame = [&](const SimulatedFrame& frame, std::size_t index, std::size_t count) {
    if (!arguments.quiet) tell(frame, index, count);
  };
  FunctionRef<void(const SimulatedFrame&, std::size_t, std::size_t)> told(on_frame);
  const SimulationReport report =
      write_simulation(simulated, scene.picture.bodies, arguments.output, water.frames, arguments.resume, &told);
  const std::string folder = std::filesystem::path(drawing).parent_path().string();
  write_text(drawing, scene_of_written_frames(arguments.scene, folder, arguments.output, report));
  if (!arguments.report_path.empty()) write_text(arguments.report_path, text_of(report_json(report), 2) + "\n");
  if (arguments.quiet) return;
  for (const auto& [stage, ms] : report.times.rows()) std::cout << fmt::format("{:<14}{:>12.1f} ms\n", stage, ms);
  for (const std::string& way : report.ways)
    if (!way.empty()) std::cout << fmt::format("the way of a body: {}\n", way);
  const auto kept = std::count_if(report.frames.begin(), report.frames.end(),
                                  [](const SimulatedFrame& frame) { return frame.skipped; });
  const std::string also = kept > 0 ? fmt::format(", {} kept", kept) : "";
  std::cout << fmt::format("{} frames written{}. Draw them with: meniscus render {} -o film.mp4\n",
                           report.frames.size() - static_cast<std::size_t>(kept), also, drawing);
}

void add_options(CLI::App& command, SimulateArguments& arguments) {
  command.add_option("SCENE", arguments.scene, "A scene file (.json) with water.simulation")->required()->type_name("");
  command
      .add_option("-o,--output", arguments.output,
                  "Where frames go: a .ply file with {} or {:04} for the frame's number. Beside them come the ways of "
                  "bodies that move, and draw.json, a scene file that draws all of it")
      ->required()
      ->type_name("FILE");
  command.add_option("--frames", arguments.frames, "The first N frames (default: what the scene file says)")
      ->type_name("N")
      ->check(CLI::Range(1, 1000000).description(""));
  command.add_option("--fps", arguments.frames_per_second, "Frames a second of the water's time, 0.1 to 10000")
      ->type_name("N")
      ->check(CLI::Range(0.1, 10000.0).description(""));
  command.add_option("--solver", arguments.solver, "sph or pbf")
      ->type_name("NAME")
      ->check(CLI::IsMember({"sph", "pbf"}).description(""));
  command.add_option("--spacing", arguments.spacing, "Edge of the cube of water that one particle stands for, m")
      ->type_name("METRES")
      ->check(CLI::Range(1e-6, 1e6).description(""));
  command.add_option("--step", arguments.step, "Of time, s")
      ->type_name("SECONDS")
      ->check(CLI::Range(1e-9, 1.0).description(""));
  command.add_flag("--resume", arguments.resume,
                   "Leave frames that are there already as they are, if they are whole; the simulation runs through "
                   "them all the same");
  command
      .add_option("--report", arguments.report_path, "Write times, steps and energy of every frame into a JSON file")
      ->type_name("FILE.json");
  command.add_flag("--quiet", arguments.quiet, "Say nothing but errors");
  command.add_option("--threads", arguments.threads, "Threads, 0 to 1024; 0: one a core (default: 0)")
      ->type_name("N")
      ->check(CLI::Range(0, 1024).description(""));
}

}  // namespace

void add_simulate(CLI::App& program) {
  CLI::App* command = program.add_subcommand("simulate", "Simulate water and write its particles");
  const auto arguments = std::make_shared<SimulateArguments>();
  add_options(*command, *arguments);
  command->footer(
      "Examples:\n"
      "  meniscus simulate examples/glass.json -o frames/{:04}.ply\n"
      "  meniscus simulate examples/drag.json -o frames/{:04}.ply --frames 20 --solver pbf\n"
      "  meniscus render frames/draw.json -o film.mp4\n"
      "meniscus render SCENE -o film.mp4 simulates and draws at once.");
  command->callback([arguments] { simulate(*arguments); });
}

}  // namespace meniscus::apps
