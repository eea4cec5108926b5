/// The sections on what is around the water: ground and tank.
#include <algorithm>

#include "render/scene_file_fields.h"

namespace meniscus::scene_file {

Bounds box_of(const JsonValue& value) {
  Bounds box;
  box.add(value.at(0).three());
  box.add(value.at(1).three());
  const vec3 extent = box.extent();
  if (!(std::min({extent.x, extent.y, extent.z}) > 0))
    value.refuse("has no space inside", "two corners that differ along x, y and z", value.dump());
  return box;
}

const Section& ground_section() {
  static const Section section{
      "ground",
      "The plane under the water.",
      {{"style",
        {a_name({"chequer", "plain", "none"})},
        "\"chequer\"",
        "What it looks like",
        [](const JsonValue& v, Draft& d) { d.scene.picture.ground = ground_style_of(v.text()); }},
       {"height",
        {a_number()},
        "(the lowest point of the water)",
        "Along the up axis, m",
        [](const JsonValue& v, Draft& d) { d.scene.picture.ground_height = v.real(); }},
       {"albedo",
        {numbers(3, between(0, 1))},
        "[0.5, 0.5, 0.5]",
        "Linear colour; of a chequer the brighter squares, the others have 0.7 of it",
        [](const JsonValue& v, Draft& d) { d.scene.picture.ground_albedo = v.three(); }}}};
  return section;
}

const Section& tank_section() {
  static const Section section{"tank",
                               "A box around the water, open at the top.",
                               {{"style",
                                 {a_name({"none", "glass", "tiled"})},
                                 "\"none\"",
                                 "Clear panes, or walls and floor with tiles, which are seen from inside only",
                                 [](const JsonValue& v, Draft& d) { d.scene.picture.tank = tank_style_of(v.text()); }},
                                {"inside",
                                 {{Kind::rows, {}, 2, 2, 3}},
                                 "(around the particles of all frames)",
                                 "Two opposite corners of the space for the water, m",
                                 [](const JsonValue& v, Draft& d) { d.scene.picture.tank_inside = box_of(v); }},
                                {"albedo",
                                 {numbers(3, between(0, 1))},
                                 "[0.55, 0.72, 0.78]",
                                 "Linear colour of the tiles",
                                 [](const JsonValue& v, Draft& d) { d.scene.picture.tank_albedo = v.three(); }}}};
  return section;
}

}  // namespace meniscus::scene_file
