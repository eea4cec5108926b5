/// The sections on how a body is placed: in meshes, in each of their frames, and turned about an axis.
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "render/scene_file_fields.h"

namespace meniscus::scene_file {
namespace {

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

}  // namespace

glm::mat4 turned_by(vec3 degrees) {
  const vec3 angles = degrees * 0.01745329252f;
  const glm::mat4 one(1.0f);
  return glm::rotate(one, angles.z, vec3(0, 0, 1)) * glm::rotate(one, angles.y, vec3(0, 1, 0)) *
         glm::rotate(one, angles.x, vec3(1, 0, 0));
}

void forget_transform(Draft& draft) {
  draft.translate.reset();
  draft.rotate.reset();
  draft.scale.reset();
  draft.matrix.reset();
}

glm::mat4 transform_of(const JsonValue& value, const Draft& draft) {
  if (draft.matrix && (draft.translate || draft.rotate || draft.scale))
    value.refuse_key("matrix", "cannot stand beside translate, rotate or scale", "leave one or the other out");
  const glm::mat4 one(1.0f);
  return draft.matrix.value_or(draft.translate.value_or(one) * draft.rotate.value_or(one) * draft.scale.value_or(one));
}

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

void store_mesh_frames(const JsonValue& value, Draft& draft) {
  draft.transforms = &draft.scene.picture.bodies.back().frames;
  if (value.is_text())
    read_transforms(draft.resolved(value.text()), draft);
  else if (value.size() == 0)
    value.refuse("is empty", "at least one transform", "none");
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
        draft.scene.picture.bodies.back().absent.push_back(value.has("present") && !value.member("present").boolean());
        forget_transform(draft);
      }};
  return section;
}

}  // namespace meniscus::scene_file
