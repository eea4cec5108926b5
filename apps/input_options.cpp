#include "input_options.h"

#include <fmt/format.h>

#include <algorithm>
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
  command
      .add_option(
          "WHAT", what,
          "Frames: files, a directory, a glob, or a pattern with {} for the frame number; or one scene file (.json)")
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
  add_reading_options(command, reading);
}

FrameSequence InputOptions::find(bool quiet) const {
  for (const std::string& path : what)
    if (is_scene_file(path)) throw UsageError(path + ": frames of particles were expected here, not a scene file");
  FrameSequence found = find_frames(what, reading);
  if (!quiet)
    for (const std::string& note : found.notes) std::cerr << "meniscus: " << note << '\n';
  return select(std::move(found));
}

FrameSequence InputOptions::find_in(const SceneFile& scene, bool quiet) const {
  if (scene.waves) return select(waves_sequence(*scene.waves));
  if (scene.heights) return select(heights_sequence(*scene.heights, scene.up.value_or(Axis::y)));
  if (scene.simulation) return select(simulated_sequence(*scene.simulation, scene.picture.bodies));
  if (scene.frames.empty() && scene.picture.rain)
    return select(rain_sequence(*scene.picture.rain, scene.up.value_or(Axis::y)));
  return find(quiet);
}

FrameSequence InputOptions::select(FrameSequence found) const {
  for (std::size_t i = 0; i < found.frames.size(); ++i) found.frames[i].place = i;
  if (first_number || last_number)
    std::erase_if(found.frames, [&](const FramePath& frame) {
      return frame.number && (*frame.number < first_number.value_or(*frame.number) ||
                              *frame.number > last_number.value_or(*frame.number));
    });
  const auto [begin, end] = bounds_of(selection, found.frames.size());
  std::vector<FramePath> picked;
  const auto step = static_cast<std::size_t>(selection.step) * static_cast<std::size_t>(every.value_or(1));
  for (std::size_t i = begin; i < end; i += step) picked.push_back(found.frames[i]);
  if (picked.empty()) throw UsageError(fmt::format("--frames picks none of the {} frames", found.frames.size()));
  found.frames = std::move(picked);
  return found;
}

std::optional<std::string> InputOptions::scene_file() const {
  if (std::none_of(what.begin(), what.end(), is_scene_file)) return std::nullopt;
  if (what.size() > 1) throw UsageError("a scene file stands alone: it says itself which frames are meant");
  return what.front();
}

void InputOptions::take(const SceneFile& scene) {
  what = scene.frames;
  first_number = scene.first;
  last_number = scene.last;
  every = scene.every;
  if (!spacing) spacing = scene.spacing;
  if (!up) up = scene.up;
  // What an argument says holds.
  const ReadOptions standard, own = reading;
  reading = scene.reading;
  if (!own.positions.empty()) reading.positions = own.positions;
  if (!own.columns.empty()) reading.columns = own.columns;
  if (!own.raw.empty()) reading.raw = own.raw;
  if (!own.where.empty()) reading.where = own.where;
  if (own.scale != standard.scale) reading.scale = own.scale;
  if (own.origin) reading.origin = own.origin;
  reading.boundaries |= own.boundaries;
  reading.allow_outside |= own.allow_outside;
}

SurveyOptions InputOptions::survey_options() const {
  SurveyOptions options;
  options.spacing = spacing;
  options.up = up;
  options.strict = strict;
  return options;
}

}  // namespace meniscus::apps
