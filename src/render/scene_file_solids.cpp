/// The sections on solid bodies: meshes, ground, tank.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>

#include "meniscus/image.h"
#include "render/body_placement.h"
#include "render/numbered_path.h"
#include "render/scene_file_fields.h"

namespace meniscus::scene_file {
namespace {

BodyOptions& body(Draft& d) { return d.scene.picture.bodies.back(); }

void forget_transform(Draft& draft) {
  draft.translate.reset();
  draft.rotate.reset();
  draft.scale.reset();
  draft.matrix.reset();
}

void store_scale(const JsonValue& value, Draft& draft) {
  const vec3 scale = value.is_list() ? value.three() : vec3(value.real());
  draft.scale = glm::scale(glm::mat4(1.0f), scale);
}

void store_matrix(const JsonValue& value, Draft& draft) {
  glm::mat4 matrix(1.0f);
  for (int row = 0; row < static_cast<int>(value.size()); ++row)
    for (int column = 0; column < 4; ++column)
      matrix[column][row] = value.at(static_cast<std::size_t>(row)).at(static_cast<std::size_t>(column)).real();
  if (matrix[0][3] != 0 || matrix[1][3] != 0 || matrix[2][3] != 0 || matrix[3][3] != 1)
    value.at(3).refuse("is no last row of a placement", "[0, 0, 0, 1]", value.at(3).dump());
  const float volume = std::abs(glm::dot(glm::cross(vec3(matrix[0]), vec3(matrix[1])), vec3(matrix[2])));
  if (!(volume > 0 && std::isfinite(volume)))
    value.refuse("flattens the body", "a matrix that can be inverted", value.dump());
  draft.matrix = matrix;
}

/// The placement that the fields of this object describe.
glm::mat4 transform_of(const JsonValue& value, const Draft& draft) {
  if (draft.matrix && (draft.translate || draft.rotate || draft.scale))
    value.refuse_key("matrix", "cannot stand beside translate, rotate or scale", "leave one or the other out");
  const glm::mat4 one(1.0f);
  return draft.matrix.value_or(draft.translate.value_or(one) * draft.rotate.value_or(one) * draft.scale.value_or(one));
}

/// How a body is placed; in meshes and in each of their frames.
std::vector<Field> transform_fields() {
  return {
      {"translate",
       {numbers(3)},
       "[0, 0, 0]",
       "Moved by this, m, after scaling and turning",
       [](const JsonValue& v, Draft& d) { d.translate = glm::translate(glm::mat4(1.0f), v.three()); }},
      {"rotate",
       {numbers(3, between(-36000, 36000)), an_object(rotate_section())},
       "[0, 0, 0]",
       "Turned: degrees about x, then y, then z; or an axis and degrees",
       [](const JsonValue& v, Draft& d) {
         if (v.is_list()) d.rotate = turned_by(v.three());
       }},
      {"scale", {a_number({1e-9, 1e9}), numbers(3, {1e-9, 1e9})}, "1", "Factor, or one along each axis", store_scale},
      {"matrix",
       {{Kind::rows, {}, 3, 4, 4}},
       "(none)",
       "Instead of translate, rotate and scale: rows of the matrix that places the body",
       store_matrix}};
}

std::vector<Field> frame_fields() {
  std::vector<Field> fields = transform_fields();
  fields.push_back({"present", {a_boolean()}, "true", "Whether it is there at all", nullptr});
  return fields;
}

/// Transforms from a file of their own: a list of them.
void read_transforms(const std::string& path, Draft& draft) {
  const JsonText text(path);
  const JsonValue root(text);
  if (!root.is_list() || root.size() == 0)
    root.refuse("this is no list of transforms", "[{\"translate\": [x, y, z], ...}, ...]", root.dump());
  for (std::size_t i = 0; i < root.size(); ++i) {
    if (!root.at(i).is_object()) root.at(i).refuse("is of the wrong kind", "an object", root.at(i).dump());
    read_section(root.at(i), transform_section(), draft);
  }
}

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
                                 body(draft).material = draft.solid_material;
                               }};
  return section;
}

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

void store_mesh_frames(const JsonValue& value, Draft& draft) {
  draft.transforms = &body(draft).frames;
  if (value.is_text())
    read_transforms(draft.resolved(value.text()), draft);
  else if (value.size() == 0)
    value.refuse("is empty", "at least one transform", "none");
}

}  // namespace

glm::mat4 turned_by(vec3 degrees) {
  const vec3 angles = degrees * 0.01745329252f;
  const glm::mat4 one(1.0f);
  return glm::rotate(one, angles.z, vec3(0, 0, 1)) * glm::rotate(one, angles.y, vec3(0, 1, 0)) *
         glm::rotate(one, angles.x, vec3(1, 0, 0));
}

Bounds box_of(const JsonValue& value) {
  Bounds box;
  box.add(value.at(0).three());
  box.add(value.at(1).three());
  const vec3 extent = box.extent();
  if (!(std::min({extent.x, extent.y, extent.z}) > 0))
    value.refuse("has no space inside", "two corners that differ along x, y and z", value.dump());
  return box;
}

const Section& rotate_section() {
  static const Section section{
      "meshes[].rotate",
      "A turn about an axis through the origin; or, in short, `[x, y, z]`: degrees about the x, then the y, then the z "
      "axis.",
      {{"axis", {numbers(3)}, "[0, 1, 0]", "Of the turn; any length but 0", nullptr},
       {"degrees", {a_number(between(-36000, 36000))}, "0", "Of the turn, by the right hand", nullptr}},
      nullptr,
      [](const JsonValue& value, Draft& draft) {
        const vec3 axis = value.has("axis") ? value.member("axis").three() : vec3(0, 1, 0);
        const float degrees = value.has("degrees") ? value.member("degrees").real() : 0.0f;
        if (!(glm::dot(axis, axis) > 1e-20f && glm::dot(axis, axis) < 1e20f))
          value.member("axis").refuse("is no direction", "a length above 0", value.member("axis").dump());
        draft.rotate = glm::rotate(glm::mat4(1.0f), degrees * 0.01745329252f, glm::normalize(axis));
      }};
  return section;
}

const Section& transform_section() {
  static const Section section{
      "meshes[].frames[]", "Where a body is in one frame, before its own translate, rotate and scale.", frame_fields(),
      forget_transform, [](const JsonValue& value, Draft& draft) {
        draft.transforms->push_back(transform_of(value, draft));
        body(draft).absent.push_back(value.has("present") && !value.member("present").boolean());
        forget_transform(draft);
      }};
  return section;
}

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
