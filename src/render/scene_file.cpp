/// The whole scene file.
#include <filesystem>

#include "render/scene_file_fields.h"

namespace meniscus {
namespace scene_file {

const Section& file_section() {
  static const Section section{
      "",
      "The whole file.",
      {{"$schema", {{Kind::text}}, "(none)", "Where an editor finds `scene.schema.json`; not looked at", nullptr},
       {"water", {an_object(water_section())}, "{}", "The water", nullptr},
       {"colour", {an_object(colour_section())}, "{}", "Its colours by a quantity of the particles", nullptr},
       {"meshes", {objects(mesh_section())}, "[]", "Solid bodies", nullptr},
       {"ground", {an_object(ground_section())}, "{}", "The plane under the water", nullptr},
       {"tank", {an_object(tank_section())}, "{}", "A box around the water", nullptr},
       {"lights", {an_object(lights_section())}, "{}", "Sun and lamps", nullptr},
       {"environment", {an_object(environment_section())}, "{}", "The sky", nullptr},
       {"camera", {an_object(camera_section())}, "{}", "Where the picture is taken from", nullptr},
       {"optics", {an_object(optics_section())}, "{}", "Reflection and refraction", nullptr},
       {"caustics",
        {a_boolean(), an_object(caustics_section())},
        "true",
        "Light bent by the water",
        [](const JsonValue& v, Draft& d) { d.scene.picture.caustics = !v.is_boolean() || v.boolean(); }},
       {"rain", {an_object(rain_section())}, "(none)", "Rain over all of it", nullptr},
       {"picture", {an_object(picture_section())}, "{}", "Size, tone, and what is shown", nullptr},
       {"output", {an_object(output_section())}, "{}", "Where pictures go", nullptr}},
      nullptr,
      finish_file};
  return section;
}

}  // namespace scene_file

SceneFile read_scene_file(const std::string& path) {
  const JsonText text(path);
  const JsonValue root(text);
  if (!root.is_object()) root.refuse("a scene is an object", "{...}", root.dump());
  scene_file::Draft draft;
  draft.folder = std::filesystem::path(path).parent_path().string();
  if (!draft.folder.empty() && draft.folder.back() != '/') draft.folder += '/';
  scene_file::read_section(root, scene_file::file_section(), draft);
  return std::move(draft.scene);
}

}  // namespace meniscus
