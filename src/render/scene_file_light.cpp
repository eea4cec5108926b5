/// The sections on light: environment, lights, optics, caustics.
#include "render/scene_file_fields.h"

namespace meniscus::scene_file {
namespace {

PictureOptions& picture(Draft& d) { return d.scene.picture; }
CausticsOptions& caustics(Draft& d) { return d.scene.picture.caustics_options; }
PointLight& lamp(Draft& d) { return d.scene.picture.lamps.back(); }
int whole(const JsonValue& v) { return static_cast<int>(v.integer()); }

const Section& sun_section() {
  static const Section section{
      "lights.sun",
      "Where the sun stands and how bright it is. Azimuth and elevation are said together.",
      {{"azimuth",
        {a_number(between(-36000, 36000))},
        "(behind the water to the right)",
        "Degrees, as for the camera",
        nullptr},
       {"elevation", {a_number(between(-90, 90))}, "(42)", "Degrees above the horizon", nullptr},
       {"scale",
        {a_number(between(0, 1e6))},
        "1",
        "Factor of the sun's light",
        [](const JsonValue& v, Draft& d) { picture(d).sun_scale = v.real(); }}},
      nullptr,
      [](const JsonValue& value, Draft& draft) {
        const bool azimuth = value.has("azimuth"), elevation = value.has("elevation");
        if (azimuth != elevation)
          value.refuse("says only half of where the sun is", "azimuth and elevation",
                       azimuth ? "azimuth alone" : "elevation alone");
        if (azimuth) picture(draft).sun_deg = vec2(value.member("azimuth").real(), value.member("elevation").real());
      }};
  return section;
}

const Section& lamp_section() {
  static const Section section{
      "lights.lamps[]",
      "A lamp without extent.",
      {{"position",
        {numbers(3)},
        "(must be said)",
        "m",
        [](const JsonValue& v, Draft& d) { lamp(d).position = v.three(); }},
       {"intensity",
        {a_number(between(0, 1e12)), numbers(3, between(0, 1e12))},
        "1",
        "Irradiance that it gives at 1 m, as one number or as red, green and blue",
        [](const JsonValue& v, Draft& d) { lamp(d).intensity = v.is_list() ? v.three() : vec3(v.real()); }}},
      [](Draft& d) { picture(d).lamps.emplace_back(); },
      [](const JsonValue& value, Draft&) {
        if (!value.has("position")) value.refuse("has no position", "[x, y, z] in metres", "none");
      }};
  return section;
}

}  // namespace

const Section& lights_section() {
  static const Section section{
      "lights",
      "What shines on the scene beside the sky.",
      {{"sun", {an_object(sun_section())}, "(as below)", "The sun", nullptr},
       {"lamps", {objects(lamp_section())}, "[]", "Lamps", nullptr},
       {"shadow", {a_boolean()}, "true", "The water casts shadow or caustics", [](const JsonValue& v, Draft& d) {
          picture(d).shadow = v.boolean();
        }}}};
  return section;
}

const Section& environment_section() {
  static const Section section{
      "environment",
      "The sky.",
      {{"hdr",
        {{Kind::file}},
        "(an analytic sky)",
        "Environment map, equirectangular Radiance .hdr",
        [](const JsonValue& v, Draft& d) { picture(d).environment_hdr = d.resolved(v.text()); }},
       {"clouds",
        {a_number(between(0, 1))},
        "(0; in the rain 1)",
        "Of the analytic sky: 0 clear, 1 overcast without a sun",
        [](const JsonValue& v, Draft& d) { picture(d).cloud_cover = v.real(); }},
       {"scale",
        {a_number(between(0, 1e6))},
        "1",
        "Factor of the sky's light, the sun's included: little of it at night",
        [](const JsonValue& v, Draft& d) { picture(d).sky_scale = v.real(); }}}};
  return section;
}

const Section& optics_section() {
  static const Section section{
      "optics",
      "How rays go on behind the water's surface.",
      {{"refraction",
        {a_name({"thickness", "image_space", "ray_traced", "virtual_eye"})},
        "\"ray_traced\"",
        "One interface, the far side guessed; one interface, iteration in the picture of the scene; rays through the "
        "water; or one interface, maps of the objects drawn from virtual eyes",
        [](const JsonValue& v, Draft& d) { picture(d).optics.refraction = refraction_method_of(v.text()); }},
       {"bounces",
        {an_integer(1, 64)},
        "8",
        "ray_traced: interfaces in one path at most",
        [](const JsonValue& v, Draft& d) { picture(d).optics.bounces = whole(v); }},
       {"iterations",
        {an_integer(1, 256)},
        "8",
        "image_space: projections onto the ray at most",
        [](const JsonValue& v, Draft& d) { picture(d).optics.iterations = whole(v); }},
       {"threshold",
        {a_number(above(0))},
        "(from the pixels)",
        "image_space: distance from the scene that counts as met, m",
        [](const JsonValue& v, Draft& d) { picture(d).optics.threshold = v.real(); }},
       {"fresnel",
        {a_name({"exact", "schlick"})},
        "\"exact\"",
        "How much is mirrored: Fresnel's equations, or Schlick's approximation",
        [](const JsonValue& v, Draft& d) { picture(d).optics.fresnel = fresnel_formula_of(v.text()); }},
       {"dispersion",
        {a_boolean()},
        "false",
        "Red, green and blue are each bent by their own index of refraction",
        [](const JsonValue& v, Draft& d) { picture(d).optics.dispersion = v.boolean(); }},
       {"eyes", {an_object(eyes_section())}, "{}", "virtual_eye: how the maps are drawn", nullptr}}};
  return section;
}

const Section& caustics_section() {
  static const Section section{
      "caustics",
      "Light that the water bends onto the solids. `true` or an object: with caustics; `false`: a soft shadow instead.",
      {{"method",
        {a_name({"triangles", "simple", "light_map", "combined"})},
        "\"triangles\"",
        "Light followed through triangles of the surface; brightness made up from heights and gradients; a plane map "
        "traced backwards through the surface; or the last two superposed",
        [](const JsonValue& v, Draft& d) { caustics(d).method = caustics_method_of(v.text()); }},
       {"simple",
        {numbers(3, between(-1e6, 1e6))},
        "[1.5, -0.8, 0.35]",
        "simple, combined: factor of the height, factor of the gradient, and what is added",
        [](const JsonValue& v, Draft& d) {
          caustics(d).simple_a = v.at(0).real();
          caustics(d).simple_b = v.at(1).real();
          caustics(d).simple_c = v.at(2).real();
        }},
       {"simple_keeps_mean",
        {a_boolean()},
        "true",
        "simple, combined: scaled so that the floor gets as much light as under still water; off: as published",
        [](const JsonValue& v, Draft& d) { caustics(d).simple_keeps_mean = v.boolean(); }},
       {"on_walls",
        {a_boolean()},
        "true",
        "Light that the water mirrors onto the walls above it and onto bodies; triangles: where the surface is a "
        "height "
        "field",
        [](const JsonValue& v, Draft& d) { caustics(d).on_walls = v.boolean(); }},
       {"screen",
        {whole_numbers(2, between(0, 4096))},
        "[0, 0]",
        "Width and height of the virtual screen, px; 0: by the water's extent, 512 along the longer side, and square "
        "pixels",
        [](const JsonValue& v, Draft& d) {
          caustics(d).screen_width = whole(v.at(0));
          caustics(d).screen_height = whole(v.at(1));
        }},
       {"direction",
        {a_name({"light", "up"})},
        "\"light\"",
        "What the screen is perpendicular to",
        [](const JsonValue& v, Draft& d) {
          caustics(d).screen = v.text() == "up" ? ScreenDirection::up : ScreenDirection::light;
        }},
       {"iterations",
        {an_integer(1, 256)},
        "8",
        "Of the intersection with the geometry map",
        [](const JsonValue& v, Draft& d) { caustics(d).iterations = whole(v); }},
       {"threshold",
        {a_number(above(0))},
        "(half a pixel of the geometry map)",
        "Distance from the scene that counts as met, m",
        [](const JsonValue& v, Draft& d) { caustics(d).threshold = v.real(); }},
       {"exact_hits",
        {a_boolean()},
        "false",
        "Refracted light meets the scene by ray, not in the geometry map",
        [](const JsonValue& v, Draft& d) { caustics(d).exact_hits = v.boolean(); }},
       {"single_interface",
        {a_boolean()},
        "false",
        "Light goes on to the solids after the first interface, as published",
        [](const JsonValue& v, Draft& d) { caustics(d).single_interface = v.boolean(); }},
       {"map_size",
        {an_integer(0, 4096)},
        "0",
        "Texels along the longer side of the light map; 0: by the screen",
        [](const JsonValue& v, Draft& d) { caustics(d).map_size = whole(v); }},
       {"most_lights",
        {an_integer(0, 64)},
        "4",
        "Sun and lamps that make caustics, the brightest first",
        [](const JsonValue& v, Draft& d) { caustics(d).most_lights = whole(v); }}}};
  return section;
}

}  // namespace meniscus::scene_file
