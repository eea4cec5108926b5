/// The section on foam beside the water.
#include "render/scene_file_fields.h"

namespace meniscus::scene_file {
namespace {

FoamOptions& foam(Draft& d) { return d.scene.picture.foam; }

void store_files(const JsonValue& value, Draft& draft) {
  foam(draft).files.clear();
  if (value.is_text()) foam(draft).files.push_back(draft.resolved(value.text()));
  if (value.is_list())
    for (std::size_t i = 0; i < value.size(); ++i) foam(draft).files.push_back(draft.resolved(value.at(i).text()));
}

}  // namespace

const Section& foam_section() {
  static const Section section{
      "water.foam",
      "Spray, foam and bubbles as particles in files of their own, drawn as soft white discs.",
      {{"files",
        {{Kind::path}, {Kind::texts}},
        "(none)",
        "Files with `{}` for the number of the water's frame",
        store_files},
       {"radius",
        {a_number(above(0))},
        "(0.3 spacings)",
        "Of a particle's disc, m",
        [](const JsonValue& v, Draft& d) { foam(d).look.radius = v.real(); }},
       {"opacity",
        {a_number(between(0, 1))},
        "0.6",
        "In the middle of a disc",
        [](const JsonValue& v, Draft& d) { foam(d).look.opacity = v.real(); }},
       {"albedo", {numbers(3, between(0, 1))}, "[0.9, 0.9, 0.9]", "Linear", [](const JsonValue& v, Draft& d) {
          foam(d).look.albedo = v.three();
        }}}};
  return section;
}

}  // namespace meniscus::scene_file
