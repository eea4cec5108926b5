/// Options on what is around the water: light, caustics, solids.
#include "commands.h"
#include "option_group.h"

namespace meniscus::apps {

void PictureArguments::add_light(CLI::App& command) {
  OptionGroup group(command, "Light", setters_);
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
  group.number<float>(
      "--clouds", "COVER", [](PictureOptions& p, float v) { p.cloud_cover = in_range("--clouds", v, 0.0f, 1.0f); },
      "Of the analytic sky: 0 clear, 1 overcast without a sun (default: 0; in the rain 1)");
  group.number<float>(
      "--sky-scale", "FACTOR", [](PictureOptions& p, float v) { p.sky_scale = in_range("--sky-scale", v, 0.0f, 1e6f); },
      "Factor of the light of sky and sun (default: 1)");
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
      "--caustics", "NAME",
      [](PictureOptions& p, const std::string& name) {
        p.caustics_options.method = caustics_method_of(name);
        p.caustics = true;
      },
      "triangles (light followed through the surface), simple (made up from heights and gradients), light_map (traced "
      "backwards into a map), combined (simple and light_map) (default: triangles)");
  group.text(
      "--simple-caustics", "A,B,C",
      [](PictureOptions& p, const std::string& text) {
        const vec3 abc = parse_vec3("--simple-caustics", text);
        p.caustics_options.simple_a = abc.x;
        p.caustics_options.simple_b = abc.y;
        p.caustics_options.simple_c = abc.z;
      },
      "Weights of height, gradient and the constant in simple caustics (default: 1.5,-0.8,0.35)");
  group.flag(
      "--simple-as-published", [](PictureOptions& p) { p.caustics_options.simple_keeps_mean = false; },
      "Simple caustics are not scaled to the light that arrives under still water");
  group.flag(
      "--no-wall-light", [](PictureOptions& p) { p.caustics_options.on_walls = false; },
      "No light mirrored by the water onto what stands above it");
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
  OptionGroup group(command, "Solids", setters_);
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

}  // namespace meniscus::apps
