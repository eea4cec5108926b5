/// The section on standing waves that are made up as particles.
#include "render/scene_file_fields.h"
#include "render/synthetic_waves.h"

namespace meniscus::scene_file {
namespace {

WavesOptions& waves(Draft& d) { return *d.scene.waves; }

void finish_waves(const JsonValue& value, Draft& draft) {
  try {
    check_waves(waves(draft));
  } catch (const Error& error) {
    value.refuse("cannot be: " + error.detail().problem, error.detail().expected, error.detail().found);
  }
}

}  // namespace

const Section& waves_section() {
  static const Section section{
      "water.waves",
      "Water that is made up instead of read: standing waves in a tank, y up, its lower corner at the origin. Their "
      "frames are numbered from 0.",
      {{"particles",
        {an_integer(1, 100e6)},
        "100000",
        "Number of particles, about",
        [](const JsonValue& v, Draft& d) { waves(d).particles = static_cast<std::size_t>(v.integer()); }},
       {"frames",
        {an_integer(1, 1e6)},
        "50",
        "Number of frames",
        [](const JsonValue& v, Draft& d) { waves(d).frames = static_cast<std::size_t>(v.integer()); }},
       {"fps",
        {a_number({0.1, 1000})},
        "25",
        "Frames a second of the water's time",
        [](const JsonValue& v, Draft& d) { waves(d).frames_per_second = v.number(); }},
       {"size",
        {numbers(3, above(0))},
        "[2, 0.5, 1]",
        "Of the still water along x, y and z, m",
        [](const JsonValue& v, Draft& d) { waves(d).size = v.three(); }},
       {"height",
        {a_number(at_least(0))},
        "0.06",
        "Of the waves over the still level, at most, m",
        [](const JsonValue& v, Draft& d) { waves(d).height = v.real(); }},
       {"shortest",
        {a_number(above(0))},
        "(an eighth of the longer side)",
        "Shortest wavelength, m",
        [](const JsonValue& v, Draft& d) { waves(d).shortest = v.real(); }}},
      nullptr,
      finish_waves};
  return section;
}

}  // namespace meniscus::scene_file
