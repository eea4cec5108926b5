/// The section on virtual eyes.
#include "render/scene_file_fields.h"

namespace meniscus::scene_file {
namespace {

VirtualEyeOptions& eyes(Draft& d) { return d.scene.picture.optics.eyes; }

}  // namespace

const Section& eyes_section() {
  static const Section section{
      "optics.eyes",
      "Virtual eyes: how objects in and behind the water are drawn into maps. Each switch turns one part of the method "
      "off.",
      {{"map_size",
        {an_integer(0, 8192)},
        "0",
        "Edge of a face of the maps, px; 0: by the picture",
        [](const JsonValue& v, Draft& d) { eyes(d).map_size = static_cast<int>(v.integer()); }},
       {"displaced_eye",
        {a_boolean()},
        "true",
        "Off: maps are drawn from the camera itself",
        [](const JsonValue& v, Draft& d) { eyes(d).displaced_eye = v.boolean(); }},
       {"scale_correction",
        {a_boolean()},
        "true",
        "Of the refracted part's length along the object's main axis",
        [](const JsonValue& v, Draft& d) { eyes(d).scale_correction = v.boolean(); }},
       {"adaptation",
        {a_boolean()},
        "true",
        "The surface is bent to the plane around an object",
        [](const JsonValue& v, Draft& d) { eyes(d).adaptation = v.boolean(); }},
       {"adaptation_width",
        {a_number(at_least(0))},
        "0",
        "How far beyond the object's outline, m; 0: by its size",
        [](const JsonValue& v, Draft& d) { eyes(d).adaptation_width = v.real(); }},
       {"trapezium",
        {a_boolean()},
        "true",
        "Objects are seen only in a trapezium towards the eye",
        [](const JsonValue& v, Draft& d) { eyes(d).trapezium = v.boolean(); }},
       {"trapezium_a",
        {a_number(at_least(0))},
        "0",
        "Its half width at the object, m; 0: by the object's size",
        [](const JsonValue& v, Draft& d) { eyes(d).trapezium_a = v.real(); }},
       {"trapezium_b",
        {a_number(at_least(0))},
        "0",
        "Its half width at the eye's end, m; 0: by the object's size",
        [](const JsonValue& v, Draft& d) { eyes(d).trapezium_b = v.real(); }},
       {"per_point",
        {a_boolean()},
        "false",
        "Each point of the surface has a virtual eye of its own: for wide objects",
        [](const JsonValue& v, Draft& d) { eyes(d).per_point = v.boolean(); }},
       {"object_position",
        {a_boolean()},
        "true",
        "Objects are looked up where the ray passes them, so that they keep together under waves; off: by its "
        "direction alone, as published",
        [](const JsonValue& v, Draft& d) { eyes(d).object_position = v.boolean(); }},
       {"static_position",
        {a_boolean()},
        "true",
        "Floor and walls are found where the ray meets them; off: looked up by its direction alone, as published",
        [](const JsonValue& v, Draft& d) { eyes(d).static_position = v.boolean(); }},
       {"combine_distance",
        {a_number(at_least(0))},
        "(by the objects' sizes)",
        "Objects nearer to each other than this share an eye, m",
        [](const JsonValue& v, Draft& d) { eyes(d).combine_distance = v.real(); }}}};
  return section;
}

}  // namespace meniscus::scene_file
