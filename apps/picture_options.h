/// Options on how the picture looks: surface, colour, picture, camera.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "input_options.h"
#include "meniscus/render.h"

namespace meniscus::apps {

/// What the command line says about the picture. It must stay where it is while the arguments are parsed.
class PictureArguments {
 public:
  void add_to(CLI::App& command);
  /// @throws Error what reading the camera file throws; UsageError
  PictureOptions options(const InputOptions& input) const;

 private:
  void add_surface(CLI::App& command);
  void add_colour(CLI::App& command);
  void add_picture(CLI::App& command);
  void add_camera(CLI::App& command);

  PictureOptions picture_;
  std::string color_by_;
  Colormap colormap_ = Colormap::viridis;
  std::optional<std::pair<float, float>> range_;
  std::string camera_file_;
};

}  // namespace meniscus::apps
