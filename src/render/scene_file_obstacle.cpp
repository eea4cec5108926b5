/// The section on what a body is in a simulation.
#include <fmt/format.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "render/scene_file_fields.h"

namespace meniscus::scene_file {
namespace {

ObstacleRole& role(Draft& d) { return *d.scene.picture.bodies.back().role; }

/// Degrees about the axes, or a quaternion.
void store_rotation(const JsonValue& value, Draft& draft) {
  if (!value.is_list()) return;  // rotate_section stores it
  if (value.size() == 3) {
    draft.rotate = turned_by(value.three());
    return;
  }
  const glm::quat turn(value.at(0).real(), value.at(1).real(), value.at(2).real(), value.at(3).real());
  const float length = glm::length(turn);
  if (!(length > 1e-10f && length < 1e10f)) value.refuse("is no rotation", "a length above 0", value.dump());
  draft.rotate = glm::mat4_cast(turn / length);
}

void finish_key(const JsonValue& value, Draft& draft) {
  Draft::WayKey& key = draft.way.back();
  if (!value.has("time")) value.refuse("has no time", "seconds", "none");
  const std::size_t count = draft.way.size();
  if (count > 1 && !(key.time > draft.way[count - 2].time))
    value.refuse("does not come after the key before it", fmt::format("more than {} s", draft.way[count - 2].time),
                 fmt::format("{} s", key.time));
  key.rotation = draft.rotate;
  draft.rotate.reset();
}

const Section& way_section() {
  static const Section section{
      "meshes[].obstacle.path[]",
      "Where a body is at a time. Between two keys it moves smoothly; it is still before the first and after the last.",
      {{"time",
        {a_number(between(-1e9, 1e9))},
        "(must be said)",
        "s of the water's time",
        [](const JsonValue& v, Draft& d) { d.way.back().time = v.number(); }},
       {"position",
        {numbers(3)},
        "(where the mesh is placed)",
        "Instead of `translate`, m",
        [](const JsonValue& v, Draft& d) { d.way.back().position = v.three(); }},
       {"rotation",
        {{Kind::numbers, between(-36000, 36000), 3, 4}, an_object(rotate_section())},
        "(as the mesh is placed)",
        "Instead of `rotate`: degrees about x, then y, then z; or a quaternion w, x, y, z; or an axis and degrees",
        store_rotation}},
      [](Draft& d) {
        d.way.emplace_back();
        d.rotate.reset();
      },
      finish_key};
  return section;
}

void finish_obstacle(const JsonValue& value, Draft&) {
  const std::string motion = value.has("motion") ? value.member("motion").text() : "";
  const bool has_way = value.has("path") && value.member("path").size() > 0;
  if (motion == "path" && !has_way)
    value.refuse("has no path", "path: [{\"time\": 0, \"position\": [x, y, z]}, ...]", "none");
  if (has_way && !motion.empty() && motion != "path")
    value.refuse_key("path", fmt::format("cannot stand beside motion {}", motion), "leave one of them out");
  if (value.has("density") && motion != "dynamic")
    value.refuse_key("density", "is of dynamic obstacles only", "say \"motion\": \"dynamic\"");
}

}  // namespace

const Section& obstacle_section() {
  static const Section section{
      "meshes[].obstacle",
      "A body that the water of a simulation runs against. It is closed, with normals outwards.",
      {{"motion",
        {a_name({"fixed", "path", "dynamic"})},
        "(path where there is one, else fixed)",
        "It stands still, moves along a path, or is moved by water and gravity",
        [](const JsonValue& v, Draft& d) { role(d).dynamic = v.text() == "dynamic"; }},
       {"density",
        {a_number(between(1, 1e5))},
        "500",
        "dynamic: kg/m^3; what is lighter than the water floats",
        [](const JsonValue& v, Draft& d) { role(d).density = v.real(); }},
       {"appears",
        {a_number(between(0, 1e9))},
        "0",
        "It is not there before, s: so an object is dropped in",
        [](const JsonValue& v, Draft& d) { role(d).appears = v.number(); }},
       {"path", {objects(way_section())}, "[]", "Its way", nullptr}},
      [](Draft& d) { d.way.clear(); },
      finish_obstacle};
  return section;
}

}  // namespace meniscus::scene_file
