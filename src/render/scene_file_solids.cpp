/// The section on solid bodies.
#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "render/body_placement.h"
#include "render/numbered_path.h"
#include "render/scene_file_fields.h"

namespace meniscus::scene_file {
namespace {

BodyOptions& body(Draft& d) { return d.scene.picture.bodies.back(); }

/// The way of an obstacle, with what its keys leave out as the body is placed.
void finish_way(Draft& draft) {
  const Pose placed = placement_of(body(draft).world_from_body).pose;
  for (const Draft::WayKey& key : draft.way) {
    Pose pose = placed;
    if (key.position) pose.position = *key.position;
    if (key.rotation) pose.rotation = glm::normalize(glm::quat_cast(glm::mat3(*key.rotation)));
    body(draft).role->path.push_back({key.time, pose});
  }
  draft.way.clear();
}

void finish_mesh(const JsonValue& value, Draft& draft) {
  if (value.has("file") == value.has("shape"))
    value.refuse("needs either a file or a shape", "one of them", value.has("file") ? "both" : "neither");
  body(draft).world_from_body = transform_of(value, draft);
  std::vector<bool>& absent = body(draft).absent;
  if (std::find(absent.begin(), absent.end(), true) == absent.end()) absent.clear();
  if (!body(draft).role) return;
  if (value.has("frames"))
    value.refuse_key("frames", "cannot stand beside obstacle", "say the way as obstacle.path, in seconds");
  if (NumberedPath(body(draft).path).is_numbered())
    value.member("file").refuse("is another mesh in each frame, which cannot be an obstacle", "one file",
                                value.member("file").dump());
  if (body(draft).role->dynamic && value.has("file"))
    value.refuse_key("file", "cannot float freely", "dynamic obstacles are shapes: a box, a sphere or a cylinder");
  finish_way(draft);
}

void store_name(const JsonValue& value, Draft& draft) {
  const std::string name = value.text();
  if (name.empty()) value.refuse("is empty", "a name", value.dump());
  const std::vector<BodyOptions>& bodies = draft.scene.picture.bodies;
  if (std::any_of(bodies.begin(), bodies.end(), [&](const BodyOptions& other) { return other.name == name; }))
    value.refuse("is the name of another mesh", "a name of its own", value.dump());
  body(draft).name = name;
}

void store_mesh_file(const JsonValue& value, Draft& draft) {
  const NumberedPath path(draft.resolved(value.text()));
  if (!path.understood())
    value.refuse("has a pattern that cannot be understood", "{} or {:04} for the frame's number", value.dump());
  if (!path.is_numbered()) check_file(value, draft);
  body(draft).path = path.pattern();
}

}  // namespace

const Section& mesh_section() {
  static const Section section = [] {
    Section mesh{"meshes[]",
                 "A solid body: a mesh from a file, or a simple shape.",
                 {{"file",
                   {{Kind::path}},
                   "(none)",
                   "OBJ, PLY, glTF ...; with `{}` or `{:04}` for the frame's number: one file a frame",
                   store_mesh_file},
                  {"shape",
                   {a_name({"box", "sphere", "cylinder"})},
                   "(none)",
                   "Instead of a file: 1 m in size around the origin; the cylinder along y",
                   [](const JsonValue& v, Draft& d) { body(d).shape = v.text(); }},
                  {"name", {{Kind::text}}, "(none)", "By which a simulation's events call it", store_name},
                  {"obstacle",
                   {an_object(obstacle_section())},
                   "(the water does not meet it)",
                   "What it is in a simulation",
                   [](const JsonValue&, Draft& d) { body(d).role.emplace(); }},
                  // Before the body's own placement, which is read into the same place.
                  {"frames",
                   {objects(transform_section()), {Kind::file}},
                   "(it stands still)",
                   "One transform a frame, a list or a JSON file of one; the last one holds on",
                   store_mesh_frames}},
                 [](Draft& d) {
                   forget_transform(d);
                   d.scene.picture.bodies.emplace_back();
                 },
                 finish_mesh};
    for (Field& field : transform_fields()) mesh.fields.push_back(std::move(field));
    mesh.fields.push_back({"material", {an_object(material_section())}, "(the file's)", "What it is made of", nullptr});
    return mesh;
  }();
  return section;
}

}  // namespace meniscus::scene_file
