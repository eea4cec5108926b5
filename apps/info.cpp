#include <fmt/format.h>
#include <fmt/ranges.h>

#include <iostream>
#include <memory>

#include "commands.h"
#include "json.h"
#include "meniscus/render.h"
#include "picture_options.h"

namespace meniscus::apps {
namespace {

struct InfoArguments {
  InputOptions input;
  bool json = false;
};

/// One frame as it was read, or why it was not.
struct FrameInfo {
  std::string path;
  Particles particles;
  Survey survey;
  std::string problem;
};

std::vector<std::string> attribute_names(const Particles& particles) {
  std::vector<std::string> names;
  for (const Attribute& a : particles.attributes)
    names.push_back(a.components == 1 ? a.name : fmt::format("{}[{}]", a.name, a.components));
  return names;
}

Json frame_json(const FrameInfo& frame, const PictureOptions& options) {
  Json json;
  json["path"] = frame.path;
  if (!frame.problem.empty()) {
    json["error"] = frame.problem;
    return json;
  }
  const Particles& particles = frame.particles;
  json["format"] = particles.format;
  json["particles"] = particles.size();
  json["attributes"] = Json::array();
  for (const Attribute& attribute : particles.attributes) json["attributes"].push_back(attribute.name);
  const Bounds bounds = particles.bounds();
  json["bounds"] = bounds.empty() ? Json() : Json::array({json_of(bounds.low), json_of(bounds.high)});
  const float spacing = frame.survey.spacing.spacing;
  json["spacing"] = json_of(spacing);
  json["radius"] = json_of(spacing / 2);
  json["smoothing_length"] =
      json_of(options.surface.smoothing_length > 0 ? options.surface.smoothing_length : 2 * spacing);
  json["up"] = std::string(name_of(frame.survey.up.axis));
  json["time"] = particles.time ? Json(*particles.time) : Json();
  json["dropped_non_finite"] = particles.dropped_non_finite;
  json["notes"] = particles.notes;
  json["reasoning"] = {{"spacing", frame.survey.spacing.reasoning}, {"up", frame.survey.up.reasoning}};
  return json;
}

Json guess_json(const Guess& guess) {
  return {{"what", guess.what}, {"value", guess.value}, {"reasoning", guess.reasoning}, {"option", guess.option}};
}

void print(const FrameInfo& frame) {
  if (!frame.problem.empty()) return;  // told on stderr
  const Particles& particles = frame.particles;
  const Bounds bounds = particles.bounds();
  std::cout << fmt::format("{}\n  {} particles, {}", frame.path, particles.size(), particles.format);
  if (particles.time) std::cout << fmt::format(", t = {:.6g} s", *particles.time);
  std::cout << '\n';
  if (!bounds.empty())
    std::cout << fmt::format("  from ({:.4g}, {:.4g}, {:.4g}) to ({:.4g}, {:.4g}, {:.4g}) m, spacing {:.4g} m\n",
                             bounds.low.x, bounds.low.y, bounds.low.z, bounds.high.x, bounds.high.y, bounds.high.z,
                             frame.survey.spacing.spacing);
  if (!particles.attributes.empty())
    std::cout << fmt::format("  attributes: {}\n", fmt::join(attribute_names(particles), ", "));
  if (particles.dropped_non_finite > 0)
    std::cout << fmt::format("  {} particles with NaN or infinite positions are left out\n",
                             particles.dropped_non_finite);
  for (const std::string& note : particles.notes) std::cout << "  " << note << '\n';
}

void print(const Guess& guess) {
  std::cout << fmt::format("  {:<17} {}\n  {:<17}   {}\n  {:<17}   set with {}\n", guess.what, guess.value, "",
                           guess.reasoning, "", guess.option);
}

std::string motion_of(const ObstacleRole& role) {
  if (role.dynamic) return fmt::format("dynamic, {:g} kg/m^3", role.density);
  return role.path.empty() ? "fixed" : "path";
}

/// Frames a second of frames that are made up or simulated.
double frames_per_second_of(const SceneFile& scene) {
  if (scene.simulation) return scene.simulation->frames_per_second;
  return scene.heights ? scene.heights->frames_per_second : scene.picture.rain->frames_per_second;
}

/// What is known of frames that are made up or simulated, without making any.
Json foreseen_json(const FrameSequence& sequence, const SceneFile& scene) {
  const Foreseen& foreseen = *sequence.foreseen;
  Json json;
  json["kind"] = scene.simulation ? "simulation" : scene.heights ? "heights" : "rain";
  json["frames"] = sequence.frames.size();
  json["fps"] = frames_per_second_of(scene);
  json["bounds"] = Json::array({json_of(foreseen.bounds.low), json_of(foreseen.bounds.high)});
  json["up"] = std::string(name_of(foreseen.up));
  if (!scene.simulation) {
    if (scene.heights) json["waves"] = scene.heights->waves.size();
    if (!scene.heights) json["rate_mm_h"] = json_of(scene.picture.rain->rain.rate_mm_h);
    return json;
  }
  const SimulationOptions& simulation = scene.simulation->simulation;
  json["solver"] = simulation.fluid.solver == Solver::sph ? "sph" : "pbf";
  json["particles_at_start"] = foreseen.particles;
  json["spacing"] = json_of(foreseen.spacing);
  json["events"] = {{"pour", simulation.pours.size()},
                    {"stir", simulation.stirs.size()},
                    {"tilt", simulation.tilts.size()},
                    {"drag", simulation.drags.size()}};
  json["obstacles"] = Json::array();
  for (const BodyOptions& body : scene.picture.bodies)
    if (body.role)
      json["obstacles"].push_back(
          {{"name", body.name}, {"motion", motion_of(*body.role)}, {"appears", body.role->appears}});
  return json;
}

void print_foreseen(const FrameSequence& sequence, const SceneFile& scene) {
  const Foreseen& foreseen = *sequence.foreseen;
  const Bounds& box = foreseen.bounds;
  const double fps = frames_per_second_of(scene);
  const std::size_t frames = sequence.frames.size();
  std::cout << fmt::format("{} {} frames, {:g} a second: {:.3g} s\n", frames,
                           scene.simulation ? "simulated"
                           : scene.heights  ? "made-up"
                                            : "rainy",
                           fps, static_cast<double>(frames) / fps);
  if (scene.simulation)
    std::cout << fmt::format("  {} particles at the start, spacing {:.4g} m, solver {}\n", foreseen.particles,
                             foreseen.spacing,
                             scene.simulation->simulation.fluid.solver == Solver::sph ? "sph" : "pbf");
  std::cout << fmt::format("  {} from ({:.4g}, {:.4g}, {:.4g}) to ({:.4g}, {:.4g}, {:.4g}) m\n",
                           scene.simulation ? "tank"
                           : scene.heights  ? "water"
                                            : "ground",
                           box.low.x, box.low.y, box.low.z, box.high.x, box.high.y, box.high.z);
  if (!scene.simulation && !scene.heights) {
    std::cout << fmt::format("  {:g} mm of rain an hour\n", scene.picture.rain->rain.rate_mm_h);
    return;
  }
  if (!scene.simulation) {
    std::cout << fmt::format("  {} trains of waves{}\n", scene.heights->waves.size(),
                             scene.heights->image.empty() ? "" : " on " + scene.heights->image);
    return;
  }
  for (const BodyOptions& body : scene.picture.bodies)
    if (body.role)
      std::cout << fmt::format("  obstacle {}: {}\n", body.name.empty() ? "without a name" : body.name,
                               motion_of(*body.role));
  const SimulationOptions& simulation = scene.simulation->simulation;
  const auto tell = [](std::size_t count, const char* what) {
    if (count > 0) std::cout << fmt::format("  {} x {}\n", count, what);
  };
  tell(simulation.pours.size(), "pour");
  tell(simulation.stirs.size(), "stir");
  tell(simulation.tilts.size(), "tilt");
  tell(simulation.drags.size(), "drag");
}

FrameInfo read(const FrameSequence& sequence, const FramePath& path, const SurveyOptions& options) {
  FrameInfo frame;
  frame.path = path.path;
  try {
    frame.particles = read_frame(sequence, path);
    frame.survey = survey_particles(frame.particles, options);
  } catch (const Error& error) {
    if (options.strict) throw;
    frame.problem = error.what();
    std::cerr << "meniscus: error: " << frame.problem << '\n';
  }
  return frame;
}

void info(InfoArguments& arguments) {
  SceneFile scene;
  if (const std::optional<std::string> path = arguments.input.scene_file()) {
    scene = read_scene_file(*path);
    arguments.input.take(scene);
  }
  const FrameSequence sequence = arguments.input.find_in(scene, arguments.json);
  const SurveyOptions survey_options = arguments.input.survey_options();
  PictureOptions options = scene.picture;
  if (arguments.input.spacing) options.surface.spacing = *arguments.input.spacing;
  if (arguments.input.smoothing_length) options.surface.smoothing_length = *arguments.input.smoothing_length;

  Json frames = Json::array();
  std::size_t failed = 0;
  if (sequence.foreseen && !arguments.json) print_foreseen(sequence, scene);
  for (const FramePath& path : sequence.frames) {
    if (sequence.foreseen) break;  // they are made when they are drawn
    const FrameInfo frame = read(sequence, path, survey_options);
    failed += frame.problem.empty() ? 0 : 1;
    if (arguments.json)
      frames.push_back(frame_json(frame, options));
    else
      print(frame);
  }

  // What the pictures of the sequence would have in common.
  std::vector<Guess> guesses;
  if (failed < sequence.frames.size() && !scene.heights)
    guesses = guesses_of(survey_frames(sequence, survey_options), options);
  if (arguments.json) {
    Json json;
    json["frames"] = std::move(frames);
    if (sequence.foreseen) json["foreseen"] = foreseen_json(sequence, scene);
    json["guesses"] = Json::array();
    for (const Guess& guess : guesses) json["guesses"].push_back(guess_json(guess));
    json["notes"] = sequence.notes;
    std::cout << text_of(json, 2) << '\n';
  } else if (!guesses.empty()) {
    std::cout << (sequence.frames.size() > 1 ? fmt::format("For all {} frames\n", sequence.frames.size())
                                             : "Guesses\n");
    for (const Guess& guess : guesses) print(guess);
  }
  if (failed > 0) throw CLI::RuntimeError(kFailed);
}

}  // namespace

void add_info(CLI::App& program) {
  CLI::App* command =
      program.add_subcommand("info", "Tell what is in frames of particles, and what is guessed from it");
  const auto arguments = std::make_shared<InfoArguments>();
  arguments->input.add_to(*command);
  command->add_flag("--json", arguments->json, "Print one JSON object");
  command->footer("Exits with 1 if one of the frames cannot be read.");
  command->callback([arguments] { info(*arguments); });
}

}  // namespace meniscus::apps
