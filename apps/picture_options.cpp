#include "picture_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "commands.h"

namespace meniscus::apps {
namespace {

/// Adds options of one group. Each hands its value to a function that sets it in PictureOptions: at once, so that
/// wrong values show while the arguments are parsed, and again over what a scene file says.
class Group {
 public:
  Group(CLI::App& command, const char* name, std::vector<PictureSetter>& setters)
      : command_(command), name_(name), setters_(setters) {}
  template <class Take>
  CLI::Option* text(const char* option, const char* type, Take take, const std::string& description) {
    return number<std::string>(option, type, take, description);
  }
  template <class Value, class Take>
  CLI::Option* number(const char* option, const char* type, Take take, const std::string& description) {
    const auto given = [&setters = setters_, take](const Value& value) {
      PictureOptions trial;
      take(trial, value);
      setters.push_back([take, value](PictureOptions& options) { take(options, value); });
    };
    return command_.add_option_function<Value>(option, given, description)->type_name(type)->group(name_);
  }
  /// An option that may be repeated, one value each time.
  template <class Take>
  void list(const char* option, const char* type, Take take, const std::string& description) {
    number<std::vector<std::string>>(
        option, type,
        [take](PictureOptions& options, const std::vector<std::string>& values) {
          for (const std::string& value : values) take(options, value);
        },
        description)
        ->allow_extra_args(false);
  }
  template <class Take>
  void flag(const char* option, Take take, const std::string& description) {
    command_
        .add_flag_callback(
            option, [&setters = setters_, take] { setters.emplace_back(take); }, description)
        ->group(name_);
  }

 private:
  CLI::App& command_;
  const char* name_;
  std::vector<PictureSetter>& setters_;
};

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

template <class Number>
Number in_range(const char* option, Number value, Number low, Number high) {
  if (!(value >= low && value <= high))
    throw UsageError(fmt::format("{}: {} to {} was expected, not {}", option, low, high, value));
  return value;
}

}  // namespace

void PictureArguments::add_surface(CLI::App& command) {
  Group group(command, "Surface", setters_);
  group.text(
      "--surface", "NAME", [](PictureOptions& p, const std::string& name) { p.method = surface_method_of(name); },
      "What represents the water: raycast, surfels, or spheres to see the particles themselves (default: raycast)");
  group.text(
      "--kernel", "NAME",
      [](PictureOptions& p, const std::string& name) { p.surface.kernel = p.surfels.kernel = kernel_of(name); },
      "Smoothing kernel: cubic_spline, poly6 or wyvill (default: cubic_spline; wyvill for surfels)");
  group.number<float>(
      "--iso", "FRACTION", [](PictureOptions& p, float v) { p.surface.iso = v; },
      "Density of the surface as a fraction of that inside the water, 0 to 1 (default: 0.5)");
  group.number<float>(
      "--step", "LENGTHS", [](PictureOptions& p, float v) { p.surface.step = v; },
      "Step of the march, in smoothing lengths, up to 1 (default: 0.25)");
  group.text(
      "--refinement", "NAME",
      [](PictureOptions& p, const std::string& name) { p.surface.refinement = refinement_of(name); },
      "How the crossing is closed in on: secant or bisection (default: secant)");
  group.number<int>(
      "--refinement-steps", "N", [](PictureOptions& p, int v) { p.surface.refinement_steps = v; },
      "Evaluations after the crossing has been bracketed, 0 to 32 (default: 2)");
  group.text(
      "--normals", "NAME",
      [](PictureOptions& p, const std::string& name) { p.surface.normals = normal_method_of(name); },
      "Normals: gradient, pca or blend of both (default: blend)");
  group.number<float>(
      "--normal-radius", "METRES", [](PictureOptions& p, float v) { p.surface.normal_radius = v; },
      "Reach of the normals' sums, m (default: 3 spacings)");
  group.number<float>(
      "--blend-sharpness", "D", [](PictureOptions& p, float v) { p.surface.blend_sharpness = v; },
      "How fast the blend turns to the gradient where both normals differ (default: 10)");
  group.number<float>(
      "--blend-agreement", "K", [](PictureOptions& p, float v) { p.surface.blend_agreement = v; },
      "Cosine between both normals from which on pca alone is taken (default: 0.998)");
  group.number<int>(
      "--filter-radius", "PIXELS", [](PictureOptions& p, int v) { p.surface.filter_radius = v; },
      "Radius of the filter that smooths the normals, px; 0 switches it off (default: 4)");
  group.flag(
      "--no-keep-thin", [](PictureOptions& p) { p.surface.keep_thin = false; },
      "Particles of equal mass, as published: drops, jets and thin sheets shrink or vanish");
  group.number<float>(
      "--grid-step", "METRES", [](PictureOptions& p, float v) { p.surfels.grid_step = v; },
      "Surfels: between points of the density grid, m (default: half a spacing)");
  group.number<float>(
      "--gap-threshold", "METRES", [](PictureOptions& p, float v) { p.surfels.gap_threshold = v; },
      "Surfels: between neighbours beyond which points are added, m (default: 1.5 grid steps)");
  group.number<float>(
      "--epsilon", "METRES", [](PictureOptions& p, float v) { p.surfels.epsilon = v; },
      "Surfels: discs this close in depth are blended, m (default: a spacing)");
  group.number<int>(
      "--drop-isolated", "N",
      [](PictureOptions& p, int v) {
        if (v < 0) throw UsageError("--drop-isolated: 0 or more was expected");
        p.drop_isolated = v;
      },
      "Leave out particles with fewer than N others within a smoothing length (default: 0, none)");
}

void PictureArguments::add_colour(CLI::App& command) {
  Group group(command, "Colour", setters_);
  group.text(
      "--color-by", "ATTRIBUTE", [this](PictureOptions&, const std::string& name) { color_by_ = name; },
      "Colour the water by a particle attribute; of vectors the magnitude (see meniscus info for their names)");
  group.text(
      "--colormap", "NAME", [this](PictureOptions&, const std::string& name) { colormap_ = colormap_of(name); },
      "viridis, magma, turbo, coolwarm or grey (default: viridis)");
  group.text(
      "--range", "LOW:HIGH",
      [this](PictureOptions&, const std::string& text) { range_ = parse_range("--range", text); },
      "Values at the ends of the map (default: the smallest and largest of the whole sequence)");
  group.flag(
      "--legend", [](PictureOptions& p) { p.legend = true; }, "Draw a colour bar");
}

void PictureArguments::add_picture(CLI::App& command) {
  Group group(command, "Picture", setters_);
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
  Group group(command, "Camera", setters_);
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

void PictureArguments::add_light(CLI::App& command) {
  Group group(command, "Light", setters_);
  group.text(
      "--environment", "FILE.hdr", [](PictureOptions& p, const std::string& path) { p.environment_hdr = path; },
      "Environment map, equirectangular Radiance .hdr (default: an analytic sky)");
  group.text(
      "--sun", "AZIMUTH,ELEVATION",
      [](PictureOptions& p, const std::string& text) {
        p.sun_deg = parse_vec2("--sun", text);
        static_cast<void>(in_range("--sun: elevation", p.sun_deg->y, -90.0f, 90.0f));
      },
      "Where the sun stands, degrees; azimuth as for the camera (default: behind the water to the right)");
  group.number<float>(
      "--sun-scale", "FACTOR",
      [](PictureOptions& p, float v) {
        if (!(v >= 0 && v < 1e6f)) throw UsageError("--sun-scale: a factor from 0 up was expected");
        p.sun_scale = v;
      },
      "Factor of the sun's light (default: 1)");
  group.list(
      "--lamp", "X,Y,Z:INTENSITY",
      [](PictureOptions& p, const std::string& text) { p.lamps.push_back(parse_lamp("--lamp", text)); },
      "A point light, m; intensity (or R,G,B) is the irradiance that it gives at 1 m; may be repeated");
  group.flag(
      "--no-shadow", [](PictureOptions& p) { p.shadow = false; }, "The water casts no shadow and no caustics");
  group.flag(
      "--no-caustics", [](PictureOptions& p) { p.caustics = false; },
      "The water casts a soft shadow instead of caustics");
  group.text(
      "--caustics-screen", "WIDTHxHEIGHT",
      [](PictureOptions& p, const std::string& text) {
        const PictureSize size = parse_size("--caustics-screen", text);
        p.caustics_options.screen_width = size.width;
        p.caustics_options.screen_height = size.height;
      },
      "Size of the virtual screen that light is cast from, px (default: 512 along the longer side)");
  group.flag(
      "--caustics-single-interface", [](PictureOptions& p) { p.caustics_options.single_interface = true; },
      "Light goes on to the solids after the first interface, as published (default: out of drops, into others)");
  group.text(
      "--caustics-direction", "light|up",
      [](PictureOptions& p, const std::string& name) {
        if (name != "light" && name != "up") throw UsageError("--caustics-direction: light or up was expected");
        p.caustics_options.screen = name == "up" ? ScreenDirection::up : ScreenDirection::light;
      },
      "What the virtual screen is perpendicular to (default: light)");
}

void PictureArguments::add_solids(CLI::App& command) {
  Group group(command, "Solids", setters_);
  group.list(
      "--mesh", "FILE",
      [](PictureOptions& p, const std::string& path) {
        BodyOptions body;
        body.path = path;
        p.bodies.push_back(body);
      },
      "A solid body: OBJ, PLY, glTF; with {} one file a frame; may be repeated (see docs/scene_file.md for more)");
  group.text(
      "--tank", "glass|tiled|none", [](PictureOptions& p, const std::string& name) { p.tank = tank_style_of(name); },
      "A tank fitted around the water of all frames (default: none)");
  group.text(
      "--ground", "chequer|plain|none",
      [](PictureOptions& p, const std::string& name) { p.ground = ground_style_of(name); },
      "The ground under the water (default: chequer)");
  group.number<float>(
      "--ground-height", "METRES", [](PictureOptions& p, float v) { p.ground_height = v; },
      "Height of the ground along the up axis, m (default: at the lowest particles)");
}

void PictureArguments::add_optics(CLI::App& command) {
  Group group(command, "Optics", setters_);
  group.text(
      "--refraction", "NAME",
      [](PictureOptions& p, const std::string& name) { p.optics.refraction = refraction_method_of(name); },
      "How rays go on behind the surface: thickness (one interface, the far side guessed), image_space (one interface, "
      "iteration in the picture of the scene), ray_traced (through the water, best) (default: ray_traced)");
  group.number<int>(
      "--bounces", "N", [](PictureOptions& p, int v) { p.optics.bounces = in_range("--bounces", v, 1, 64); },
      "Interfaces in a ray-traced path at most, 1 to 64 (default: 8)");
  group.number<int>(
      "--iterations", "N",
      [](PictureOptions& p, int v) {
        p.optics.iterations = p.caustics_options.iterations = in_range("--iterations", v, 1, 256);
      },
      "Image-space refraction and caustics: projections onto the ray at most, 1 to 256 (default: 8)");
  group.number<float>(
      "--threshold", "METRES",
      [](PictureOptions& p, float v) {
        p.optics.threshold = p.caustics_options.threshold = in_range("--threshold", v, 0.0f, 1e30f);
      },
      "Image-space refraction and caustics: distance from the scene that counts as met, m (default: from the pixels)");
  group.number<float>(
      "--ior", "N", [](PictureOptions& p, float v) { p.ior = v; },
      "Index of refraction, above 1 (default: the material's; water 1.333)");
  group.number<float>(
      "--roughness", "R",
      [](PictureOptions& p, float v) {
        if (!(v >= 0 && v <= 1)) throw UsageError("--roughness: 0 to 1 was expected");
        p.roughness = v;
      },
      "Of the water's mirror image, 0 to 1 (default: the material's)");
}

void PictureArguments::add_to(CLI::App& command) {
  add_surface(command);
  add_colour(command);
  add_picture(command);
  add_optics(command);
  add_light(command);
  add_solids(command);
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
