/// Options on how the picture looks: surface, colour, picture, camera.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <optional>
#include <string>

#include "input_options.h"
#include "meniscus/render.h"

namespace meniscus::apps {

/// Sets what one option says.
using PictureSetter = std::function<void(PictureOptions&)>;

/// What the command line says about the picture. It must stay where it is while the arguments are parsed.
class PictureArguments {
 public:
  void add_to(CLI::App& command);
  /// @throws Error what reading the camera file throws; UsageError
  /// @param base  what a scene file says; the command line goes before it
  PictureOptions options(const InputOptions& input, PictureOptions base = {}) const;

 private:
  void add_surface(CLI::App& command);
  void add_colour(CLI::App& command);
  void add_picture(CLI::App& command);
  void add_optics(CLI::App& command);
  void add_eyes(CLI::App& command);
  void add_light(CLI::App& command);
  void add_solids(CLI::App& command);
  void add_rain(CLI::App& command);
  void add_camera(CLI::App& command);

  std::vector<PictureSetter> setters_;
  std::string color_by_;
  Colormap colormap_ = Colormap::viridis;
  std::optional<std::pair<float, float>> range_;
  std::string camera_file_;
};

}  // namespace meniscus::apps
