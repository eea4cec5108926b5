/// Options on what is read, the same for every command that reads particles.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "meniscus/render.h"
#include "parse.h"
#include "reading_options.h"

namespace meniscus::apps {

struct InputOptions {
  std::vector<std::string> what;
  FrameSelection selection;
  std::optional<float> spacing;           ///< m
  std::optional<float> smoothing_length;  ///< m
  std::optional<Axis> up;
  bool strict = false;
  ReadOptions reading;
  std::optional<std::int64_t> first_number, last_number, every;  ///< of a scene file

  void add_to(CLI::App& command);
  /// The frames that are meant, after the selection. Notes of the search go to stderr unless quiet.
  /// @throws Error not_found
  FrameSequence find(bool quiet) const;
  /// The frames of `found` that --frames picks. @throws UsageError if none
  FrameSequence select(FrameSequence found) const;
  /// The scene file, where the only argument is one.
  /// @throws UsageError  a scene file among other arguments
  std::optional<std::string> scene_file() const;
  /// The frames of a scene file after take(), files or made up.
  FrameSequence find_in(const SceneFile& scene, bool quiet) const;
  /// Takes from a scene file what the arguments do not say.
  void take(const SceneFile& scene);
  SurveyOptions survey_options() const;
};

}  // namespace meniscus::apps
