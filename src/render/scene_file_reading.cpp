/// The section on how files of particles are read.
#include "render/scene_file_fields.h"

namespace meniscus::scene_file {
namespace {

ReadOptions& reading(Draft& d) { return d.scene.reading; }

void store_columns(const JsonValue& value, Draft& draft) {
  reading(draft).columns.clear();
  for (std::size_t i = 0; i < value.size(); ++i) reading(draft).columns.push_back(value.at(i).text());
  if (value.size() != 3)
    value.refuse("is no position", "the names of three columns", std::to_string(value.size()) + " names");
}

}  // namespace

const Section& reading_section() {
  static const Section section{
      "water.reading",
      "Where the particles are in their files, which of them are meant, and their units.",
      {{"positions",
        {{Kind::text}},
        "(found by the usual names)",
        "Array of the positions inside an HDF5 or NPZ file: one of N x 3, or three separated by commas",
        [](const JsonValue& v, Draft& d) { reading(d).positions = v.text(); }},
       {"columns",
        {{Kind::texts}},
        "(found by the usual names)",
        "Columns of x, y and z in text, by name or by number from 1",
        store_columns},
       {"raw",
        {{Kind::text}},
        "(none)",
        "Files without a header: type and numbers a particle, such as `f32x3`",
        [](const JsonValue& v, Draft& d) { reading(d).raw = v.text(); }},
       {"where",
        {{Kind::text}},
        "(the fluid)",
        "Which particles are kept, such as `type==3 && density>=900`",
        [](const JsonValue& v, Draft& d) { reading(d).where = v.text(); }},
       {"boundaries",
        {{Kind::boolean}},
        "false",
        "Whether particles of boundaries are kept, too",
        [](const JsonValue& v, Draft& d) { reading(d).boundaries = v.boolean(); }},
       {"scale",
        {a_number(between(1e-12, 1e12))},
        "1",
        "Metres that a unit of the files' lengths has",
        [](const JsonValue& v, Draft& d) { reading(d).scale = v.number(); }},
       {"origin",
        {numbers(3)},
        "(zero; a round point amidst doubles that lie far from it)",
        "What positions are counted from, in the files' coordinates, m",
        [](const JsonValue& v, Draft& d) {
          reading(d).origin = glm::dvec3{v.at(0).number(), v.at(1).number(), v.at(2).number()};
        }},
       {"allow_outside",
        {{Kind::boolean}},
        "false",
        "Whether files that list others may name some outside of their own directory",
        [](const JsonValue& v, Draft& d) { reading(d).allow_outside = v.boolean(); }}}};
  return section;
}

}  // namespace meniscus::scene_file
