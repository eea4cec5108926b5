/// Options on what is read, the same for every command that reads particles.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "meniscus/render.h"
#include "parse.h"

namespace meniscus::apps {

struct InputOptions {
  std::vector<std::string> what;
  FrameSelection selection;
  std::optional<float> spacing;           ///< m
  std::optional<float> smoothing_length;  ///< m
  std::optional<Axis> up;
  bool strict = false;

  void add_to(CLI::App& command);
  /// The frames that are meant, after the selection. Notes of the search go to stderr unless quiet.
  /// @throws Error not_found, unsupported: a scene file
  FrameSequence find(bool quiet) const;
  SurveyOptions survey_options() const;
};

}  // namespace meniscus::apps
