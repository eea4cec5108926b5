/// The section on what a solid body is made of.
#include "meniscus/image.h"
#include "render/scene_file_fields.h"

namespace meniscus::scene_file {
namespace {

vec3 colour_of(const JsonValue& value) {
  const std::string text = value.text();
  const bool good =
      text.size() == 7 && text[0] == '#' && text.find_first_not_of("0123456789abcdefABCDEF", 1) == std::string::npos;
  if (!good) value.refuse("is no colour", "\"#rrggbb\" in hexadecimal digits", value.dump());
  const auto channel = [&](std::size_t at) {
    return linear_from_srgb(static_cast<float>(std::stoi(text.substr(at, 2), nullptr, 16)) / 255.0f);
  };
  return {channel(1), channel(3), channel(5)};
}

}  // namespace

const Section& material_section() {
  static const Section section{"meshes[].material",
                               "What the body is made of, instead of what its file says.",
                               {{"albedo",
                                 {numbers(3, between(0, 1))},
                                 "[0.6, 0.6, 0.6]",
                                 "Linear colour; where there is a texture, a factor of it (then 1 if it is not given)",
                                 [](const JsonValue& v, Draft& d) { d.solid_material.albedo = v.three(); }},
                                {"color",
                                 {{Kind::text}},
                                 "(none)",
                                 "The same as a colour of the screen, `\"#rrggbb\"`",
                                 [](const JsonValue& v, Draft& d) { d.solid_material.albedo = colour_of(v); }},
                                {"texture",
                                 {{Kind::file}},
                                 "(none)",
                                 "A PNG, JPEG, TGA or BMP file",
                                 [](const JsonValue& v, Draft& d) { d.solid_material.texture = d.resolved(v.text()); }},
                                {"roughness",
                                 {a_number(between(0, 1))},
                                 "1",
                                 "Of the clear coat's mirror image; 1: no coat",
                                 [](const JsonValue& v, Draft& d) { d.solid_material.roughness = v.real(); }},
                                {"ior",
                                 {a_number({1, 4, true})},
                                 "1.5",
                                 "Index of refraction of the coat",
                                 [](const JsonValue& v, Draft& d) { d.solid_material.ior = v.real(); }}},
                               [](Draft& d) { d.solid_material = {}; },
                               [](const JsonValue& value, Draft& draft) {
                                 if (value.has("albedo") && value.has("color"))
                                   value.refuse_key("color", "cannot stand beside albedo", "leave one of them out");
                                 if (value.has("texture") && !value.has("albedo") && !value.has("color"))
                                   draft.solid_material.albedo = vec3(1);
                                 draft.scene.picture.bodies.back().material = draft.solid_material;
                               }};
  return section;
}

}  // namespace meniscus::scene_file
