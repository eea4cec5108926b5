/// What may stand in a scene file: one table that is read by, documented from, and turned into a JSON Schema.
#pragma once

#include <limits>

#include "meniscus/render.h"
#include "render/json_value.h"

namespace meniscus::scene_file {

/// What is being put together while a file is read.
struct Draft {
  SceneFile scene;
  std::string folder;  ///< of the file, with its last '/'; or ""
  // The list item that is being read.
  std::optional<glm::mat4> translate, rotate, scale, matrix;
  bool has_albedo = false;
  SolidMaterial solid_material;
  std::optional<double> key_frame, key_time;
  CameraKey key;
  std::vector<CameraKey> keys;
  bool keys_in_seconds = false;
  std::vector<glm::mat4>* transforms = nullptr;  ///< where transforms of a list go
  ColourBy colour;
  std::optional<vec3> gravity;  ///< m/s^2
  // The way of an obstacle: what a key leaves out is as the body is placed.
  struct WayKey {
    double time = 0;
    std::optional<vec3> position;
    std::optional<glm::mat4> rotation;
  };
  std::vector<WayKey> way;

  /// A path of the file as seen from the working directory.
  std::string resolved(const std::string& path) const;
};

struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool above_low = false;   ///< the low end itself is out of it
  bool below_high = false;  ///< the high end itself is out of it

  bool holds(double value) const;
  /// "0 to 1", "above 0"; empty for all numbers.
  std::string words() const;
};

struct Section;

enum class Kind {
  boolean,
  integer,
  number,
  numbers,  ///< a list of `least` to `most` numbers
  text,
  name,     ///< one of `names`
  file,     ///< a path of a file that exists
  path,     ///< a path, of whatever
  object,   ///< with the fields of `section`
  objects,  ///< a list of them
  texts,    ///< a list of texts
  rows,     ///< a list of `least` to `most` lists of `columns` numbers
  boxes,    ///< a list of pairs of corners of three numbers
};

/// One form that a field's value may have.
struct Form {
  Kind kind;
  Range range = {};  ///< of each number
  std::size_t least = 0, most = 0;
  std::size_t columns = 0;
  std::vector<std::string> names = {};
  const Section* section = nullptr;
  bool whole = false;  ///< whole numbers only

  bool fits(const JsonValue& value) const;  ///< by its JSON kind alone
  std::string words() const;
};

/// A field: `store` is called once its value has been checked, for objects before what is inside them.
struct Field {
  std::string name;
  std::vector<Form> forms;
  std::string standard;  ///< the default, as JSON; or words in parentheses
  std::string help;
  void (*store)(const JsonValue& value, Draft& draft);
};

/// An object: `finish` is called after its fields, and checks what concerns several of them.
struct Section {
  std::string title;  ///< "meshes[].material"; "" is the whole file
  std::string help;
  std::vector<Field> fields;
  void (*begin)(Draft& draft) = nullptr;
  void (*finish)(const JsonValue& value, Draft& draft) = nullptr;
};

/// The whole file; the other sections hang on it.
const Section& file_section();
const Section& water_section();
const Section& reading_section();
const Section& foam_section();
const Section& waves_section();
const Section& simulation_section();
const Section& pour_section();
const Section& stir_section();
const Section& tilt_section();
const Section& drag_section();
const Section& heights_section();
const Section& height_field_section();
const Section& colour_section();
const Section& mesh_section();
const Section& material_section();
const Section& transform_section();
const Section& rotate_section();
const Section& obstacle_section();
const Section& ground_section();
const Section& tank_section();
const Section& lights_section();
const Section& environment_section();
const Section& camera_section();
const Section& optics_section();
const Section& eyes_section();
const Section& caustics_section();
const Section& rain_section();
const Section& rain_ground_section();
const Section& picture_section();
const Section& output_section();

/// Reads an object by a section.
/// @throws Error malformed_file, not_found
void read_section(const JsonValue& value, const Section& section, Draft& draft);

/// What concerns several sections: where the water comes from, what a simulation needs, who is dragged.
void finish_file(const JsonValue& value, Draft& draft);

/// How a body is placed; in meshes and in each of their frames.
std::vector<Field> transform_fields();
void forget_transform(Draft& draft);
/// The placement that those fields of this object describe.
glm::mat4 transform_of(const JsonValue& value, const Draft& draft);
/// Transforms of the last mesh, one a frame: a list, or a file of one.
void store_mesh_frames(const JsonValue& value, Draft& draft);
/// Three Euler angles, degrees about x, then y, then z.
glm::mat4 turned_by(vec3 degrees);
/// Two corners of a box with space inside, or a refusal.
Bounds box_of(const JsonValue& value);

/// Refuses a path that names no file. @throws Error not_found with line and field
void check_file(const JsonValue& value, const Draft& draft);

/// Forms in short.
Form a_boolean();
Form an_integer(double low, double high);
Form a_number(Range range = {});
Form numbers(std::size_t count, Range range = {});
Form whole_numbers(std::size_t count, Range range);
Form a_name(std::vector<std::string> names);
Form an_object(const Section& section);
Form objects(const Section& section);
/// Ranges in short.
Range above(double low);
Range at_least(double low);
Range between(double low, double high);

/// All sections in the order of a document.
std::vector<const Section*> all_sections();
/// Tables of all fields in Markdown, as docs/scene_file.md has them.
std::string field_tables();

}  // namespace meniscus::scene_file
