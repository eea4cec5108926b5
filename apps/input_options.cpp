#include "input_options.h"

#include <fmt/format.h>

#include <iostream>

#include "commands.h"

namespace meniscus::apps {
namespace {

float positive(const char* option, float value) {
  if (!(value > 0 && value < 1e30f)) throw UsageError(fmt::format("{}: a length above 0 m was expected", option));
  return value;
}

Axis axis_of(const std::string& name) {
  for (const Axis axis : {Axis::x, Axis::y, Axis::z})
    if (name == name_of(axis)) return axis;
  throw UsageError("--up: x, y or z was expected, not '" + name + "'");
}

bool is_scene_file(const std::string& path) { return path.size() > 5 && path.substr(path.size() - 5) == ".json"; }

}  // namespace

void InputOptions::add_to(CLI::App& command) {
  const char* group = "Input";
  command.add_option("WHAT", what, "Frames: files, a directory, a glob, or a pattern with {} for the frame number")
      ->required()
      ->type_name("");
  command
      .add_option_function<float>(
          "--spacing", [this](float v) { spacing = positive("--spacing", v); },
          "Distance between neighbouring particles, m; twice their radius (default: estimated)")
      ->type_name("METRES")
      ->group(group);
  command
      .add_option_function<float>(
          "--smoothing-length", [this](float v) { smoothing_length = positive("--smoothing-length", v); },
          "Reach of a particle's kernel, m (default: 2 spacings)")
      ->type_name("METRES")
      ->group(group);
  command
      .add_option_function<std::string>(
          "--up", [this](const std::string& name) { up = axis_of(name); }, "Axis that points up (default: guessed)")
      ->type_name("x|y|z")
      ->group(group);
  command
      .add_option_function<std::string>(
          "--frames", [this](const std::string& text) { selection = parse_selection("--frames", text); },
          "The first N frames, or places in the sequence from FROM (the first is 0) to before TO; negative counts "
          "from the end. Of one frame with --orbit or --camera: N pictures of it")
      ->type_name("N|FROM:TO:STEP")
      ->group(group);
  command.add_flag("--strict", strict, "Stop at the first frame that cannot be read")->group(group);
}

FrameSequence InputOptions::find(bool quiet) const {
  for (const std::string& path : what)
    if (is_scene_file(path))
      throw Error(ErrorCode::unsupported,
                  {"scene files are not read in this version", "frames of particles", {}, path, {}, {}, {}});
  FrameSequence found = find_frames(what);
  if (!quiet)
    for (const std::string& note : found.notes) std::cerr << "meniscus: " << note << '\n';
  const auto [begin, end] = bounds_of(selection, found.frames.size());
  std::vector<FramePath> picked;
  for (std::size_t i = begin; i < end; i += static_cast<std::size_t>(selection.step)) picked.push_back(found.frames[i]);
  if (picked.empty()) throw UsageError(fmt::format("--frames picks none of the {} frames", found.frames.size()));
  found.frames = std::move(picked);
  return found;
}

SurveyOptions InputOptions::survey_options() const {
  SurveyOptions options;
  options.spacing = spacing;
  options.up = up;
  options.strict = strict;
  return options;
}

}  // namespace meniscus::apps
