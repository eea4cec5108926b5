#include "picture_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "commands.h"

namespace meniscus::apps {
namespace {

/// Adds options of one group; each hands its value to a function.
class Group {
 public:
  Group(CLI::App& command, const char* name) : command_(command), name_(name) {}
  template <class Take>
  void text(const char* option, const char* type, Take take, const std::string& description) {
    command_.add_option_function<std::string>(option, take, description)->type_name(type)->group(name_);
  }
  template <class Number, class Take>
  void number(const char* option, const char* type, Take take, const std::string& description) {
    command_.add_option_function<Number>(option, take, description)->type_name(type)->group(name_);
  }
  template <class Take>
  void flag(const char* option, Take take, const std::string& description) {
    command_.add_flag_callback(option, take, description)->group(name_);
  }

 private:
  CLI::App& command_;
  const char* name_;
};

ToneCurve tone_curve_of(const std::string& name) {
  if (name == "filmic") return ToneCurve::filmic;
  if (name == "linear") return ToneCurve::linear;
  throw UsageError("--tone: filmic or linear was expected, not '" + name + "'");
}

}  // namespace

void PictureArguments::add_surface(CLI::App& command) {
  Group group(command, "Surface");
  RaycastOptions& surface = picture_.surface;
  group.text(
      "--surface", "NAME", [&](const std::string& name) { picture_.method = surface_method_of(name); },
      "What represents the water: raycast, or spheres to see the particles themselves (default: raycast)");
  group.text(
      "--kernel", "NAME", [&](const std::string& name) { surface.kernel = kernel_of(name); },
      "Smoothing kernel: cubic_spline, poly6 or wyvill (default: cubic_spline)");
  group.number<float>(
      "--iso", "FRACTION", [&](float v) { surface.iso = v; },
      "Density of the surface as a fraction of that inside the water, 0 to 1 (default: 0.5)");
  group.number<float>(
      "--step", "LENGTHS", [&](float v) { surface.step = v; },
      "Step of the march, in smoothing lengths, up to 1 (default: 0.25)");
  group.text(
      "--refinement", "NAME", [&](const std::string& name) { surface.refinement = refinement_of(name); },
      "How the crossing is closed in on: secant or bisection (default: secant)");
  group.number<int>(
      "--refinement-steps", "N", [&](int v) { surface.refinement_steps = v; },
      "Evaluations after the crossing has been bracketed, 0 to 32 (default: 2)");
  group.text(
      "--normals", "NAME", [&](const std::string& name) { surface.normals = normal_method_of(name); },
      "Normals: gradient, pca or blend of both (default: blend)");
  group.number<float>(
      "--normal-radius", "METRES", [&](float v) { surface.normal_radius = v; },
      "Reach of the normals' sums, m (default: 3 spacings)");
  group.number<float>(
      "--blend-sharpness", "D", [&](float v) { surface.blend_sharpness = v; },
      "How fast the blend turns to the gradient where both normals differ (default: 10)");
  group.number<float>(
      "--blend-agreement", "K", [&](float v) { surface.blend_agreement = v; },
      "Cosine between both normals from which on pca alone is taken (default: 0.998)");
  group.number<int>(
      "--filter-radius", "PIXELS", [&](int v) { surface.filter_radius = v; },
      "Radius of the filter that smooths the normals, px; 0 switches it off (default: 4)");
  group.flag(
      "--no-keep-thin", [&] { surface.keep_thin = false; },
      "Particles of equal mass, as published: drops, jets and thin sheets shrink or vanish");
  group.number<int>(
      "--drop-isolated", "N",
      [&](int v) {
        if (v < 0) throw UsageError("--drop-isolated: 0 or more was expected");
        picture_.drop_isolated = v;
      },
      "Leave out particles with fewer than N others within a smoothing length (default: 0, none)");
}

void PictureArguments::add_colour(CLI::App& command) {
  Group group(command, "Colour");
  group.text(
      "--color-by", "ATTRIBUTE", [&](const std::string& name) { color_by_ = name; },
      "Colour the water by a particle attribute; of vectors the magnitude (see meniscus info for their names)");
  group.text(
      "--colormap", "NAME", [&](const std::string& name) { colormap_ = colormap_of(name); },
      "viridis, magma, turbo, coolwarm or grey (default: viridis)");
  group.text(
      "--range", "LOW:HIGH", [&](const std::string& text) { range_ = parse_range("--range", text); },
      "Values at the ends of the map (default: the smallest and largest of the whole sequence)");
  group.flag(
      "--legend", [&] { picture_.legend = true; }, "Draw a colour bar");
}

void PictureArguments::add_picture(CLI::App& command) {
  Group group(command, "Picture");
  group.text(
      "--size", "WIDTHxHEIGHT",
      [&](const std::string& text) {
        const PictureSize size = parse_size("--size", text);
        picture_.width = size.width;
        picture_.height = size.height;
      },
      "Size of the picture, px (default: 1280x720)");
  group.text(
      "--show", "NAME", [&](const std::string& name) { picture_.show = show_of(name); },
      "water, or one of the buffers behind it: normals, thickness, depth (default: water)");
  group.text(
      "--material", "NAME", [&](const std::string& name) { picture_.material = name; },
      fmt::format("{} (default: water; plastic with --color-by and for spheres)", fmt::join(material_names(), ", ")));
  group.text(
      "--extinction", "R,G,B", [&](const std::string& text) { picture_.extinction = parse_vec3("--extinction", text); },
      "Absorption in red, green and blue, 1/m (default: the material's, by the depth of the scene)");
  group.text(
      "--tint", "R,G,B", [&](const std::string& text) { picture_.tint = parse_vec3("--tint", text); },
      "Linear colour, 0 to 1, that white light has after the depth of the scene");
  group.text(
      "--environment", "FILE.hdr", [&](const std::string& path) { picture_.environment_hdr = path; },
      "Environment map, equirectangular Radiance .hdr (default: an analytic sky)");
  group.text(
      "--sun", "AZIMUTH,ELEVATION", [&](const std::string& text) { picture_.sun_deg = parse_vec2("--sun", text); },
      "Where the sun stands, degrees; azimuth as for the camera (default: behind the water to the right)");
  group.text(
      "--ground", "chequer|plain|none", [&](const std::string& name) { picture_.ground = ground_style_of(name); },
      "The ground under the water (default: chequer)");
  group.number<float>(
      "--ground-height", "METRES", [&](float v) { picture_.ground_height = v; },
      "Height of the ground along the up axis, m (default: at the lowest particles)");
  group.flag(
      "--no-shadow", [&] { picture_.shadow = false; }, "The water casts no shadow on the ground");
  group.number<float>(
      "--exposure", "STOPS", [&](float v) { picture_.tone.exposure_ev = v; },
      "Brighter by this many stops (default: 0)");
  group.text(
      "--tone", "filmic|linear", [&](const std::string& name) { picture_.tone.curve = tone_curve_of(name); },
      "Tone curve (default: filmic)");
  group.text(
      "--antialias", "edges|2x2|off", [&](const std::string& name) { picture_.antialias = antialias_of(name); },
      "16 rays in pixels on outlines, the whole picture at twice its size, or one ray a pixel (default: edges)");
}

void PictureArguments::add_camera(CLI::App& command) {
  Group group(command, "Camera");
  CameraOptions& camera = picture_.camera;
  group.text(
      "--eye", "X,Y,Z", [&](const std::string& text) { camera.eye = parse_vec3("--eye", text); },
      "Where the camera stands, m (default: so that all water of the sequence is seen)");
  group.text(
      "--target", "X,Y,Z", [&](const std::string& text) { camera.target = parse_vec3("--target", text); },
      "Where it looks, m (default: the middle of the water)");
  group.number<float>(
      "--azimuth", "DEGREES", [&](float v) { camera.azimuth_deg = v; },
      "Direction that it looks from, about the up axis; at 90 from +x where y or z is up (default: 30 off the longer "
      "side)");
  group.number<float>(
      "--elevation", "DEGREES", [&](float v) { camera.elevation_deg = v; },
      "Above the horizon, -90 to 90 degrees (default: 16)");
  group.number<float>(
      "--distance", "METRES", [&](float v) { camera.distance = v; }, "From the target, m (default: fitted)");
  group.number<float>(
      "--fov", "DEGREES", [&](float v) { camera.fov_deg = v; }, "Full vertical field of view (default: 35)");
  group.number<float>(
      "--orthographic", "METRES", [&](float v) { camera.orthographic_height = v; },
      "Parallel rays; the picture is this high, m");
  group.number<float>(
      "--orbit", "DEGREES", [&](float v) { camera.orbit_deg = v; },
      "Go around the water by this angle over the sequence; 360 closes the circle (default: 0)");
  group.text(
      "--camera", "FILE.json", [&](const std::string& path) { camera_file_ = path; },
      "Camera path through keys {frame or time, eye, target, fov} (see docs/guide.md)");
}

void PictureArguments::add_to(CLI::App& command) {
  add_surface(command);
  add_colour(command);
  add_picture(command);
  add_camera(command);
}

PictureOptions PictureArguments::options(const InputOptions& input) const {
  PictureOptions options = picture_;
  if (input.spacing) options.surface.spacing = *input.spacing;
  if (input.smoothing_length) options.surface.smoothing_length = *input.smoothing_length;
  if (!color_by_.empty()) options.colour = ColourBy{color_by_, colormap_, range_};
  if (color_by_.empty() && (range_ || options.legend)) throw UsageError("--range and --legend need --color-by");
  if (!camera_file_.empty()) options.path = read_camera_path(camera_file_, options.camera.fov_deg);
  return options;
}

}  // namespace meniscus::apps
