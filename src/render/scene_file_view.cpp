/// The sections on camera and picture, and where it goes.
#include <fmt/format.h>

#include "render/scene_file_fields.h"

namespace meniscus::scene_file {
namespace {

PictureOptions& picture(Draft& d) { return d.scene.picture; }
CameraOptions& camera(Draft& d) { return d.scene.picture.camera; }

void finish_key(const JsonValue& value, Draft& draft) {
  if (draft.key_frame.has_value() == draft.key_time.has_value())
    value.refuse("needs either frame or time", "one of them", draft.key_frame ? "both" : "neither");
  for (const char* needed : {"eye", "target"})
    if (!value.has(needed)) value.refuse(fmt::format("has no {}", needed), "[x, y, z] in metres", "none");
  if (draft.key.eye == draft.key.target) value.refuse("looks from where it looks to", "two points", "one");
  const bool in_seconds = draft.key_time.has_value();
  draft.key.at = in_seconds ? *draft.key_time : *draft.key_frame;
  if (draft.keys.empty()) draft.keys_in_seconds = in_seconds;
  if (in_seconds != draft.keys_in_seconds)
    value.refuse("counts otherwise than the first key", in_seconds ? "frame" : "time", in_seconds ? "time" : "frame");
  if (!draft.keys.empty() && !(draft.key.at > draft.keys.back().at))
    value.refuse("does not come after the key before it", fmt::format("more than {}", draft.keys.back().at),
                 fmt::format("{}", draft.key.at));
  draft.keys.push_back(draft.key);
}

const Section& key_section() {
  static const Section section{"camera.path[]",
                               "One key of the camera's way; all keys count frames, or all count seconds.",
                               {{"frame",
                                 {a_number(between(-1e9, 1e9))},
                                 "(none)",
                                 "Of the film, from 0",
                                 [](const JsonValue& v, Draft& d) { d.key_frame = v.number(); }},
                                {"time",
                                 {a_number(between(-1e9, 1e9))},
                                 "(none)",
                                 "Instead of a frame: s of the film",
                                 [](const JsonValue& v, Draft& d) { d.key_time = v.number(); }},
                                {"eye",
                                 {numbers(3)},
                                 "(must be said)",
                                 "Where the camera stands, m",
                                 [](const JsonValue& v, Draft& d) { d.key.eye = v.three(); }},
                                {"target",
                                 {numbers(3)},
                                 "(must be said)",
                                 "Where it looks, m",
                                 [](const JsonValue& v, Draft& d) { d.key.target = v.three(); }},
                                {"fov",
                                 {a_number({0, 180, true, true})},
                                 "(the camera's)",
                                 "Full vertical field of view, degrees",
                                 [](const JsonValue& v, Draft& d) { d.key.fov_deg = v.real(); }}},
                               [](Draft& d) {
                                 d.key = {};
                                 d.key.fov_deg = camera(d).fov_deg;
                                 d.key_frame.reset();
                                 d.key_time.reset();
                               },
                               finish_key};
  return section;
}

void store_path(const JsonValue& value, Draft& draft) {
  draft.keys.clear();
  if (value.is_text())
    picture(draft).path = read_camera_path(draft.resolved(value.text()), camera(draft).fov_deg);
  else if (value.size() == 0)
    value.refuse("is empty", "at least one key", "none");
}

void store_size(const JsonValue& value, Draft& draft) {
  int width = 0, height = 0;
  if (value.is_list()) {
    width = static_cast<int>(value.at(0).integer());
    height = static_cast<int>(value.at(1).integer());
  } else {
    const std::string text = value.text();
    const std::size_t x = text.find('x');
    const auto number = [&](const std::string& digits) {
      const bool good =
          !digits.empty() && digits.size() <= 5 && digits.find_first_not_of("0123456789") == std::string::npos;
      return good ? std::stoi(digits) : 0;
    };
    if (x != std::string::npos) {
      width = number(text.substr(0, x));
      height = number(text.substr(x + 1));
    }
  }
  if (width < 1 || height < 1 || width > 65535 || height > 65535)
    value.refuse("is no size of a picture", "[width, height] or \"WIDTHxHEIGHT\", 1 to 65535 px", value.dump());
  picture(draft).width = width;
  picture(draft).height = height;
}

}  // namespace

const Section& camera_section() {
  static const Section section{
      "camera",
      "Where the picture is taken from; what is not said is fitted so that all the water is seen.",
      {{"eye",
        {numbers(3)},
        "(fitted)",
        "Where the camera stands, m",
        [](const JsonValue& v, Draft& d) { camera(d).eye = v.three(); }},
       {"target",
        {numbers(3)},
        "(the middle of the water)",
        "Where it looks, m",
        [](const JsonValue& v, Draft& d) { camera(d).target = v.three(); }},
       {"azimuth",
        {a_number(between(-36000, 36000))},
        "(30 off the longer side)",
        "Degrees about the up axis; at 0 from the front: from +z where y is up, from -y where z is up; at 90 from +x",
        [](const JsonValue& v, Draft& d) { camera(d).azimuth_deg = v.real(); }},
       {"elevation",
        {a_number(between(-90, 90))},
        "(16)",
        "Degrees above the horizon",
        [](const JsonValue& v, Draft& d) { camera(d).elevation_deg = v.real(); }},
       {"distance",
        {a_number(above(0))},
        "(fitted)",
        "From the target, m",
        [](const JsonValue& v, Draft& d) { camera(d).distance = v.real(); }},
       {"orthographic",
        {a_number(above(0))},
        "(perspective)",
        "Parallel rays; the picture is this high, m",
        [](const JsonValue& v, Draft& d) { camera(d).orthographic_height = v.real(); }},
       {"fov",
        {a_number({0, 180, true, true})},
        "35",
        "Full vertical field of view, degrees",
        [](const JsonValue& v, Draft& d) { camera(d).fov_deg = v.real(); }},
       {"margin",
        {a_number({0, 1, false, true})},
        "0.06",
        "Of the picture's half size, left free at each side",
        [](const JsonValue& v, Draft& d) { camera(d).margin = v.real(); }},
       {"orbit",
        {a_number(between(-36000, 36000))},
        "0",
        "Turned about the water over the whole sequence, degrees",
        [](const JsonValue& v, Draft& d) { camera(d).orbit_deg = v.real(); }},
       // After fov, which is the default of its keys.
       {"path",
        {objects(key_section()), {Kind::file}},
        "(none)",
        "A way through keys, or the path of a camera file; goes before all else of the camera",
        store_path}},
      nullptr,
      [](const JsonValue& value, Draft& draft) {
        if (!draft.keys.empty()) picture(draft).path.emplace(std::move(draft.keys), draft.keys_in_seconds);
        if (camera(draft).eye && camera(draft).target && *camera(draft).eye == *camera(draft).target)
          value.refuse("looks from where it looks to", "two points", "one");
      }};
  return section;
}

const Section& picture_section() {
  static const Section section{
      "picture",
      "The picture itself.",
      {{"size",
        {whole_numbers(2, between(1, 65535)), {Kind::text}},
        "[1280, 720]",
        "Width and height, px; or `\"1280x720\"`",
        store_size},
       {"show",
        {a_name({"water", "normals", "thickness", "depth"})},
        "\"water\"",
        "The shaded scene, or one of the buffers behind it",
        [](const JsonValue& v, Draft& d) { picture(d).show = show_of(v.text()); }},
       {"exposure",
        {a_number(between(-100, 100))},
        "0",
        "Brighter by this many stops",
        [](const JsonValue& v, Draft& d) { picture(d).tone.exposure_ev = v.real(); }},
       {"tone",
        {a_name({"filmic", "linear"})},
        "\"filmic\"",
        "Tone curve",
        [](const JsonValue& v, Draft& d) {
          picture(d).tone.curve = v.text() == "linear" ? ToneCurve::linear : ToneCurve::filmic;
        }},
       {"antialias",
        {a_name({"edges", "2x2", "off"})},
        "\"edges\"",
        "16 rays in pixels on outlines, the whole picture at twice its size, or one ray a pixel",
        [](const JsonValue& v, Draft& d) { picture(d).antialias = antialias_of(v.text()); }}}};
  return section;
}

const Section& output_section() {
  static const Section section{
      "output",
      "Where pictures go; `-o` of the command line goes before it.",
      {{"path",
        {{Kind::path}},
        "(must be said, here or by `-o`)",
        "A .png, .exr or .mp4 file, or a pattern with `{}` or `{:04}` for the frame's number",
        [](const JsonValue& v, Draft& d) {
          try {
            d.scene.output = d.resolved(v.text());
            static_cast<void>(OutputTarget(d.scene.output));
          } catch (const Error& error) {
            v.refuse("is no output: " + error.detail().problem, error.detail().expected, error.detail().found);
          }
        }},
       {"fps",
        {a_number(between(0.1, 1000))},
        "25",
        "Frames a second of a film",
        [](const JsonValue& v, Draft& d) { d.scene.video.frames_per_second = v.number(); }},
       {"quality", {an_integer(0, 51)}, "18", "Of a film: 0 lossless to 51 worst", [](const JsonValue& v, Draft& d) {
          d.scene.video.quality_crf = static_cast<int>(v.integer());
        }}}};
  return section;
}

}  // namespace meniscus::scene_file
