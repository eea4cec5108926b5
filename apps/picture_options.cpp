#include "picture_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "commands.h"
#include "option_group.h"

namespace meniscus::apps {
namespace {

ToneCurve tone_curve_of(const std::string& name) {
  if (name == "filmic") return ToneCurve::filmic;
  if (name == "linear") return ToneCurve::linear;
  throw UsageError("--tone: filmic or linear was expected, not '" + name + "'");
}

/// A camera that is set by hand goes before a scene file's path.
CameraOptions& set_camera(PictureOptions& options) {
  options.path.reset();
  return options.camera;
}

}  // namespace

void PictureArguments::add_picture(CLI::App& command) {
  OptionGroup group(command, "Picture", setters_);
  group.text(
      "--size", "WIDTHxHEIGHT",
      [](PictureOptions& p, const std::string& text) {
        const PictureSize size = parse_size("--size", text);
        p.width = size.width;
        p.height = size.height;
      },
      "Size of the picture, px (default: 1280x720)");
  group.text(
      "--show", "NAME", [](PictureOptions& p, const std::string& name) { p.show = show_of(name); },
      "water, or one of the buffers behind it: normals, thickness, depth (default: water)");
  group.text(
      "--material", "NAME", [](PictureOptions& p, const std::string& name) { p.material = name; },
      fmt::format("{} (default: water; plastic with --color-by and for spheres)", fmt::join(material_names(), ", ")));
  group.text(
      "--extinction", "R,G,B",
      [](PictureOptions& p, const std::string& text) { p.extinction = parse_vec3("--extinction", text); },
      "Absorption in red, green and blue, 1/m (default: the material's, by the depth of the scene)");
  group.text(
      "--tint", "R,G,B", [](PictureOptions& p, const std::string& text) { p.tint = parse_vec3("--tint", text); },
      "Linear colour, 0 to 1, that white light has after the depth of the scene");
  group.number<float>(
      "--exposure", "STOPS", [](PictureOptions& p, float v) { p.tone.exposure_ev = v; },
      "Brighter by this many stops (default: 0)");
  group.text(
      "--tone", "filmic|linear", [](PictureOptions& p, const std::string& name) { p.tone.curve = tone_curve_of(name); },
      "Tone curve (default: filmic)");
  group.text(
      "--antialias", "edges|2x2|off",
      [](PictureOptions& p, const std::string& name) { p.antialias = antialias_of(name); },
      "16 rays in pixels on outlines, the whole picture at twice its size, or one ray a pixel (default: edges)");
}

void PictureArguments::add_camera(CLI::App& command) {
  OptionGroup group(command, "Camera", setters_);
  group.text(
      "--eye", "X,Y,Z",
      [](PictureOptions& p, const std::string& text) { set_camera(p).eye = parse_vec3("--eye", text); },
      "Where the camera stands, m (default: so that all water of the sequence is seen)");
  group.text(
      "--target", "X,Y,Z",
      [](PictureOptions& p, const std::string& text) { set_camera(p).target = parse_vec3("--target", text); },
      "Where it looks, m (default: the middle of the water)");
  group.number<float>(
      "--azimuth", "DEGREES", [](PictureOptions& p, float v) { set_camera(p).azimuth_deg = v; },
      "Direction that it looks from, about the up axis; at 90 from +x where y or z is up (default: 30 off the longer "
      "side)");
  group.number<float>(
      "--elevation", "DEGREES", [](PictureOptions& p, float v) { set_camera(p).elevation_deg = v; },
      "Above the horizon, -90 to 90 degrees (default: 16)");
  group.number<float>(
      "--distance", "METRES", [](PictureOptions& p, float v) { set_camera(p).distance = v; },
      "From the target, m (default: fitted)");
  group.number<float>(
      "--fov", "DEGREES", [](PictureOptions& p, float v) { p.camera.fov_deg = v; },
      "Full vertical field of view (default: 35)");
  group.number<float>(
      "--orthographic", "METRES", [](PictureOptions& p, float v) { set_camera(p).orthographic_height = v; },
      "Parallel rays; the picture is this high, m");
  group.number<float>(
      "--orbit", "DEGREES", [](PictureOptions& p, float v) { p.camera.orbit_deg = v; },
      "Go around the water by this angle over the sequence; 360 closes the circle (default: 0)");
  group.text(
      "--camera", "FILE.json", [this](PictureOptions&, const std::string& path) { camera_file_ = path; },
      "Camera path through keys {frame or time, eye, target, fov} (see docs/guide.md)");
}

void PictureArguments::add_to(CLI::App& command) {
  add_surface(command);
  add_colour(command);
  add_picture(command);
  add_optics(command);
  add_eyes(command);
  add_light(command);
  add_solids(command);
  add_rain(command);
  add_camera(command);
}

PictureOptions PictureArguments::options(const InputOptions& input, PictureOptions options) const {
  for (const PictureSetter& set : setters_) set(options);
  if (input.spacing) options.surface.spacing = *input.spacing;
  if (input.smoothing_length) options.surface.smoothing_length = *input.smoothing_length;
  if (!color_by_.empty()) options.colour = ColourBy{color_by_, colormap_, range_};
  if (!options.colour && (range_ || options.legend)) throw UsageError("--range and --legend need --color-by");
  if (!camera_file_.empty()) options.path = read_camera_path(camera_file_, options.camera.fov_deg);
  return options;
}

}  // namespace meniscus::apps
