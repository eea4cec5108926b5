/// The sections on height fields: how they are found in particles, and those that are made up.
#include "render/scene_file_fields.h"

namespace meniscus::scene_file {
namespace {

MadeHeights& heights(Draft& d) { return *d.scene.heights; }
WaveTrain& wave(Draft& d) { return heights(d).waves.back(); }
HeightFieldOptions& field(Draft& d) { return d.scene.picture.height_field; }

const Section& wave_section() {
  static const Section section{
      "water.heights.waves[]",
      "One train of waves.",
      {{"kind",
        {a_name({"sine", "gerstner"})},
        "\"sine\"",
        "Even waves, or ones with sharp crests",
        [](const JsonValue& v, Draft& d) {
          wave(d).kind = v.text() == "gerstner" ? WaveTrain::Kind::gerstner : WaveTrain::Kind::sine;
        }},
       {"amplitude",
        {a_number(at_least(0))},
        "0.02",
        "From the still level to a crest, m",
        [](const JsonValue& v, Draft& d) { wave(d).amplitude = v.real(); }},
       {"wavelength",
        {a_number(above(0))},
        "0.5",
        "m",
        [](const JsonValue& v, Draft& d) { wave(d).wavelength = v.real(); }},
       {"direction",
        {a_number(between(-36000, 36000))},
        "0",
        "Degrees that it runs at, from the first horizontal axis towards the second (from x towards z where y is up)",
        [](const JsonValue& v, Draft& d) { wave(d).direction_deg = v.real(); }},
       {"phase",
        {a_number(between(-36000, 36000))},
        "0",
        "Degrees, at the start",
        [](const JsonValue& v, Draft& d) { wave(d).phase_deg = v.real(); }},
       {"speed",
        {a_number(between(-1000, 1000))},
        "0",
        "m/s; 0: of gravity waves over the region's depth",
        [](const JsonValue& v, Draft& d) { wave(d).speed = v.real(); }},
       {"steepness",
        {a_number(between(0, 1))},
        "0.8",
        "gerstner: 0 a sine, 1 the sharpest crests that do not fold",
        [](const JsonValue& v, Draft& d) { wave(d).steepness = v.real(); }}},
      [](Draft& d) { heights(d).waves.emplace_back(); }};
  return section;
}

void finish_heights(const JsonValue& value, Draft& draft) {
  if (heights(draft).waves.empty() && heights(draft).image.empty())
    value.refuse("says no heights", "waves or an image", "neither");
  if (value.has("smoothing") && heights(draft).image.empty())
    value.refuse_key("smoothing", "is of an image only", "leave it out, or name an image");
}

}  // namespace

const Section& heights_section() {
  static const Section section{
      "water.heights",
      "Water that is a made-up height field without particles: waves, an image, or waves on top of an image. Its "
      "frames "
      "are numbered from 0, and it is drawn with the surface `height_field`.",
      {{"waves", {objects(wave_section())}, "[]", "Trains of waves, added up", nullptr},
       {"image",
        {{Kind::file}},
        "(none)",
        "A PNG file: black is the region's lower end, white its upper; its first row is the far end of the second "
        "horizontal axis",
        [](const JsonValue& v, Draft& d) { heights(d).image = d.resolved(v.text()); }},
       {"region",
        {{Kind::rows, {}, 2, 2, 3}},
        "(must be said)",
        "Two opposite corners of the still water, m: its level is the upper end, its floor the lower",
        [](const JsonValue& v, Draft& d) { heights(d).region = box_of(v); }},
       {"step",
        {a_number(above(0))},
        "(an eighth of the shortest wave, or of the image)",
        "Between columns, m",
        [](const JsonValue& v, Draft& d) { heights(d).step = v.real(); }},
       {"smoothing",
        {a_number(at_least(0))},
        "0",
        "Of the image: standard deviation of a Gaussian, m",
        [](const JsonValue& v, Draft& d) { heights(d).smoothing = v.real(); }},
       {"frames",
        {an_integer(1, 1e6)},
        "50",
        "Number of frames",
        [](const JsonValue& v, Draft& d) { heights(d).frames = static_cast<std::size_t>(v.integer()); }},
       {"fps",
        {a_number(between(0.1, 1000))},
        "25",
        "Frames a second of the water's time, and of the film unless output.fps says otherwise",
        [](const JsonValue& v, Draft& d) { heights(d).frames_per_second = v.number(); }}},
      nullptr,
      finish_heights};
  return section;
}

const Section& height_field_section() {
  static const Section section{"water.height_field",
                               "How the surface `height_field` finds its columns in particles.",
                               {{"step",
                                 {a_number(above(0))},
                                 "(half a spacing)",
                                 "Between columns, m",
                                 [](const JsonValue& v, Draft& d) { field(d).step = v.real(); }},
                                {"smoothing",
                                 {a_number(at_least(0))},
                                 "(by the spacing)",
                                 "Standard deviation of a Gaussian over the heights, m; 0: none",
                                 [](const JsonValue& v, Draft& d) { field(d).smoothing = v.real(); }},
                                {"iso_radius",
                                 {a_number(above(0))},
                                 "(by the spacing)",
                                 "Reach of a particle's potential, m",
                                 [](const JsonValue& v, Draft& d) { field(d).iso_radius = v.real(); }},
                                {"iso",
                                 {a_number(above(0))},
                                 "(so that still water keeps its level)",
                                 "Potential at the surface",
                                 [](const JsonValue& v, Draft& d) { field(d).iso = v.real(); }}}};
  return section;
}

}  // namespace meniscus::scene_file
