#include <fmt/format.h>

#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

#include "render/scene_file_fields.h"
#include "scene_file_fixture.h"

namespace meniscus {
namespace {

std::string text_of(vec3 v) { return fmt::format("({}, {}, {})", v.x, v.y, v.z); }
template <class T>
std::string text_of(const std::optional<T>& value) {
  return value ? fmt::format("{}", *value) : "none";
}

/// All plain values of a scene, one a line.
std::string described(const SceneFile& s) {
  const PictureOptions& p = s.picture;
  const RaycastOptions& r = p.surface;
  const SurfelOptions& f = p.surfels;
  const CausticsOptions& c = p.caustics_options;
  std::string text =
      fmt::format("frames {} {} {} {} waves {} spacing {} up {}\n", s.frames.size(), text_of(s.first), text_of(s.last),
                  s.every.value_or(1), s.waves.has_value(), text_of(s.spacing), s.up.has_value());
  text += fmt::format("surface {} {} {} {} {} {} {} {} {} {} {} {} {} {}\n", static_cast<int>(p.method), r.spacing,
                      r.smoothing_length, static_cast<int>(r.kernel), r.iso, r.step, static_cast<int>(r.refinement),
                      r.refinement_steps, static_cast<int>(r.normals), r.normal_radius, r.blend_sharpness,
                      r.blend_agreement, r.filter_radius, r.keep_thin);
  text += fmt::format("surfels {} {} {} {} {} {} {} {}\n", f.spacing, f.smoothing_length, static_cast<int>(f.kernel),
                      f.iso, f.grid_step, f.gap_threshold, f.epsilon, f.keep_thin);
  text += fmt::format("liquid {} '{}' {} {} {} {}\n", p.drop_isolated, p.material, text_of(p.ior),
                      p.extinction.has_value(), p.tint.has_value(), text_of(p.roughness));
  text += fmt::format("colour {} {}\n", p.colour.has_value(), p.legend);
  text += fmt::format("solids {} {} {} {} {} {}\n", p.bodies.size(), static_cast<int>(p.ground),
                      text_of(p.ground_height), static_cast<int>(p.tank), p.tank_inside.has_value(), p.lamps.size());
  text += fmt::format("light '{}' {} {} {}\n", p.environment_hdr, p.sun_deg.has_value(), p.sun_scale, p.shadow);
  text += fmt::format("optics {} {} {} {}\n", static_cast<int>(p.optics.refraction), p.optics.iterations,
                      p.optics.threshold, p.optics.bounces);
  text += fmt::format("caustics {} {} {} {} {} {} {} {} {}\n", p.caustics, c.screen_width, c.screen_height,
                      static_cast<int>(c.screen), c.iterations, c.threshold, c.exact_hits + 2 * c.single_interface, c.map_size, c.most_lights);
  text += fmt::format("camera {} {} {} {} {} {} {} {} {} {}\n", p.camera.eye.has_value(), p.camera.target.has_value(),
                      text_of(p.camera.azimuth_deg), text_of(p.camera.elevation_deg), text_of(p.camera.distance),
                      text_of(p.camera.orthographic_height), p.camera.fov_deg, p.camera.margin, p.camera.orbit_deg,
                      p.path.has_value());
  text += fmt::format("picture {} {} {} {} {} {}\n", p.width, p.height, static_cast<int>(p.show), p.tone.exposure_ev,
                      static_cast<int>(p.tone.curve), static_cast<int>(p.antialias));
  return text + fmt::format("output '{}' {} {}\n", s.output, s.video.frames_per_second, s.video.quality_crf);
}

using SceneFileFields = SceneFileTest;

TEST_F(SceneFileFields, ThatAreMissingLeaveEverythingAsItIs) {
  EXPECT_EQ(described(read("{}")), described(SceneFile{}));
  EXPECT_EQ(described(read("\xef\xbb\xbf// a comment\n{ /* and another */ }")), described(SceneFile{}));
}

/// A section with every default that its table gives as a value.
std::string defaults_of(const scene_file::Section& section) {
  std::string text;
  for (const scene_file::Field& field : section.fields) {
    std::string value = field.standard.front() == '(' ? "" : field.standard;
    for (const scene_file::Form& form : field.forms)
      if (form.kind == scene_file::Kind::object && field.name != "waves" && value == "{}")
        value = defaults_of(*form.section);
    if (!value.empty()) text += fmt::format("{}\"{}\": {}", text.empty() ? "" : ", ", field.name, value);
  }
  return "{" + text + "}";
}

TEST_F(SceneFileFields, HaveTheDefaultsThatTheirTableSays) {
  std::string expected = described(SceneFile{});
  const std::string text = defaults_of(scene_file::file_section());
  ASSERT_NE(text.find("\"refinement_steps\": 2"), std::string::npos);
  ASSERT_NE(text.find("\"margin\": 0.06"), std::string::npos);
  const SceneFile scene = read(text);
  EXPECT_EQ(described(scene), expected);
  EXPECT_EQ(text_of(*scene.picture.ground_albedo), text_of(Ground{}.albedo));
  EXPECT_EQ(text_of(*scene.picture.tank_albedo), text_of(Tank{}.albedo));

  const SceneFile caustics = read("{\"caustics\": " + defaults_of(scene_file::caustics_section()) + "}");
  EXPECT_EQ(described(caustics), described(SceneFile{}));
  const SceneFile sun = read("{\"lights\": {\"sun\": {\"scale\": 1}}}");
  EXPECT_EQ(described(sun), described(SceneFile{}));

  // The defaults of a wave, a body, a lamp: beside what they cannot be without.
  const SceneFile waves = read(
      "{\"water\": {\"waves\": {\"particles\": 100000, \"frames\": 50, \"fps\": 25, \"size\": [2, 0.5, 1], "
      "\"height\": 0.06}}}");
  for (const scene_file::Section* section : scene_file::all_sections()) {
    if (section->title != "water.waves") continue;
    EXPECT_EQ(defaults_of(*section),
              "{\"particles\": 100000, \"frames\": 50, \"fps\": 25, \"size\": [2, 0.5, 1], \"height\": 0.06}");
  }
  EXPECT_EQ(waves.waves->particles, WavesOptions{}.particles);
  EXPECT_EQ(waves.waves->frames, WavesOptions{}.frames);
  EXPECT_EQ(waves.waves->frames_per_second, WavesOptions{}.frames_per_second);
  EXPECT_EQ(text_of(waves.waves->size), text_of(WavesOptions{}.size));
  EXPECT_EQ(waves.waves->height, WavesOptions{}.height);
  const SceneFile box = read(
      "{\"meshes\": [{\"shape\": \"box\", \"translate\": [0, 0, 0], \"rotate\": [0, 0, 0], \"scale\": 1, "
      "\"material\": {\"albedo\": [0.6, 0.6, 0.6], \"roughness\": 1, \"ior\": 1.5}}]}");
  EXPECT_EQ(box.picture.bodies[0].world_from_body, glm::mat4(1.0f));
  EXPECT_EQ(box.picture.bodies[0].material, SolidMaterial{});
}

TEST_F(SceneFileFields, EachChangeSomething) {
  const std::string plain = described(SceneFile{});
  for (const char* text : {"\"water\": {\"frames\": \"a\"}",
                           "\"water\": {\"first\": 1}",
                           "\"water\": {\"last\": 1}",
                           "\"water\": {\"every\": 2}",
                           "\"water\": {\"waves\": {}}",
                           "\"water\": {\"spacing\": 1}",
                           "\"water\": {\"up\": \"z\"}",
                           "\"water\": {\"surface\": \"surfels\"}",
                           "\"water\": {\"kernel\": \"poly6\"}",
                           "\"water\": {\"iso\": 0.4}",
                           "\"water\": {\"smoothing_length\": 1}",
                           "\"water\": {\"step\": 1}",
                           "\"water\": {\"refinement\": \"bisection\"}",
                           "\"water\": {\"refinement_steps\": 3}",
                           "\"water\": {\"normals\": \"pca\"}",
                           "\"water\": {\"normal_radius\": 3}",
                           "\"water\": {\"blend_sharpness\": 3}",
                           "\"water\": {\"blend_agreement\": 0.5}",
                           "\"water\": {\"filter_radius\": 0}",
                           "\"water\": {\"keep_thin\": false}",
                           "\"water\": {\"grid_step\": 3}",
                           "\"water\": {\"gap_threshold\": 3}",
                           "\"water\": {\"epsilon\": 3}",
                           "\"water\": {\"drop_isolated\": 3}",
                           "\"water\": {\"material\": \"milk\"}",
                           "\"water\": {\"ior\": 1.2}",
                           "\"water\": {\"extinction\": [1, 2, 3]}",
                           "\"water\": {\"tint\": [1, 1, 0.5]}",
                           "\"water\": {\"roughness\": 0.5}",
                           "\"colour\": {\"by\": \"velocity\"}",
                           "\"meshes\": [{\"shape\": \"box\"}]",
                           "\"ground\": {\"style\": \"plain\"}",
                           "\"ground\": {\"height\": 0}",
                           "\"tank\": {\"style\": \"glass\"}",
                           "\"tank\": {\"inside\": [[0, 0, 0], [1, 1, 1]]}",
                           "\"lights\": {\"sun\": {\"azimuth\": 1, \"elevation\": 2}}",
                           "\"lights\": {\"sun\": {\"scale\": 2}}",
                           "\"lights\": {\"lamps\": [{\"position\": [1, 1, 1]}]}",
                           "\"lights\": {\"shadow\": false}",
                           "\"camera\": {\"eye\": [1, 2, 3]}",
                           "\"camera\": {\"target\": [1, 2, 3]}",
                           "\"camera\": {\"azimuth\": 3}",
                           "\"camera\": {\"elevation\": 3}",
                           "\"camera\": {\"distance\": 3}",
                           "\"camera\": {\"orthographic\": 3}",
                           "\"camera\": {\"fov\": 3}",
                           "\"camera\": {\"margin\": 0.1}",
                           "\"camera\": {\"orbit\": 3}",
                           "\"camera\": {\"path\": [{\"frame\": 0, \"eye\": [1, 2, 3], \"target\": [0, 0, 0]}]}",
                           "\"optics\": {\"refraction\": \"image_space\"}",
                           "\"optics\": {\"bounces\": 3}",
                           "\"optics\": {\"iterations\": 3}",
                           "\"optics\": {\"threshold\": 3}",
                           "\"caustics\": false",
                           "\"caustics\": {\"screen\": [256, 0]}",
                           "\"caustics\": {\"screen\": [0, 64]}",
                           "\"caustics\": {\"direction\": \"up\"}",
                           "\"caustics\": {\"iterations\": 3}",
                           "\"caustics\": {\"threshold\": 3}",
                           "\"caustics\": {\"exact_hits\": true}",
                           "\"caustics\": {\"single_interface\": true}",
                           "\"caustics\": {\"map_size\": 3}",
                           "\"caustics\": {\"most_lights\": 3}",
                           "\"picture\": {\"size\": [640, 720]}",
                           "\"picture\": {\"size\": \"1280x700\"}",
                           "\"picture\": {\"show\": \"depth\"}",
                           "\"picture\": {\"exposure\": 1}",
                           "\"picture\": {\"tone\": \"linear\"}",
                           "\"picture\": {\"antialias\": \"2x2\"}",
                           "\"output\": {\"path\": \"a.png\"}",
                           "\"output\": {\"fps\": 3}",
                           "\"output\": {\"quality\": 3}"})
    EXPECT_NE(described(read(std::string("{") + text + "}")), plain) << text;
}

TEST_F(SceneFileFields, HoldTheValuesThatAreGiven) {
  const SceneFile s = read(R"({
    "water": {"kernel": "poly6", "iso": 0.25, "extinction": [1, 2, 3], "up": "z", "first": 3, "last": 9, "every": 2},
    "colour": {"by": "pressure", "map": "magma", "range": [-1, 2], "legend": true},
    "ground": {"albedo": [0.1, 0.2, 0.3], "style": "none"},
    "tank": {"style": "tiled", "inside": [[1, 2, 3], [0, 1, 2]], "albedo": [0.3, 0.2, 0.1]},
    "lights": {"sun": {"azimuth": 12, "elevation": 34, "scale": 0.5},
               "lamps": [{"position": [1, 2, 3], "intensity": 4}, {"position": [0, 0, 1], "intensity": [5, 6, 7]}]},
    "caustics": {"screen": [256, 64], "direction": "up"},
    "picture": {"size": "640x480"}
  })");
  const PictureOptions& p = s.picture;
  EXPECT_EQ(p.surface.kernel, Kernel::poly6);
  EXPECT_EQ(p.surfels.kernel, Kernel::poly6);
  EXPECT_EQ(p.surface.iso, 0.25f);
  EXPECT_EQ(p.surfels.iso, 0.25f);
  EXPECT_EQ(p.extinction, vec3(1, 2, 3));
  EXPECT_EQ(s.up, Axis::z);
  EXPECT_EQ(s.first, 3);
  EXPECT_EQ(s.last, 9);
  EXPECT_EQ(s.every, 2);
  ASSERT_TRUE(p.colour);
  EXPECT_EQ(p.colour->attribute, "pressure");
  EXPECT_EQ(p.colour->colormap, Colormap::magma);
  EXPECT_EQ(p.colour->range, std::make_pair(-1.0f, 2.0f));
  EXPECT_TRUE(p.legend);
  EXPECT_EQ(p.ground, GroundStyle::none);
  EXPECT_EQ(p.ground_albedo, vec3(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(p.tank, TankStyle::tiled);
  ASSERT_TRUE(p.tank_inside);
  EXPECT_EQ(p.tank_inside->low, vec3(0, 1, 2));
  EXPECT_EQ(p.tank_inside->high, vec3(1, 2, 3));
  EXPECT_EQ(p.sun_deg, vec2(12, 34));
  EXPECT_EQ(p.sun_scale, 0.5f);
  ASSERT_EQ(p.lamps.size(), 2u);
  EXPECT_EQ(p.lamps[0].position, vec3(1, 2, 3));
  EXPECT_EQ(p.lamps[0].intensity, vec3(4));
  EXPECT_EQ(p.lamps[1].intensity, vec3(5, 6, 7));
  EXPECT_TRUE(p.caustics);
  EXPECT_EQ(p.caustics_options.screen_width, 256);
  EXPECT_EQ(p.caustics_options.screen_height, 64);
  EXPECT_EQ(p.caustics_options.screen, ScreenDirection::up);
  EXPECT_EQ(p.width, 640);
  EXPECT_EQ(p.height, 480);
}

TEST_F(SceneFileFields, HoldPathsAsSeenFromTheFilesOwnFolder) {
  write("rock.obj", "");
  write("sky.hdr", "");
  write("wood.png", "");
  const SceneFile s = read(R"({"water": {"frames": ["frames/*.vtk", "/data/frames"]}, "output": {"path": "out.png"},
      "environment": {"hdr": "sky.hdr"},
      "meshes": [{"file": "rock.obj", "material": {"texture": "wood.png"}}, {"file": "rb_{:03}.obj"}]})");
  EXPECT_EQ(s.frames, (std::vector<std::string>{path_of("frames/*.vtk"), "/data/frames"}));
  EXPECT_EQ(s.output, path_of("out.png"));
  EXPECT_EQ(s.picture.environment_hdr, path_of("sky.hdr"));
  EXPECT_EQ(s.picture.bodies[0].path, path_of("rock.obj"));
  EXPECT_EQ(s.picture.bodies[0].material->texture, path_of("wood.png"));
  EXPECT_EQ(s.picture.bodies[0].material->albedo, vec3(1));
  EXPECT_EQ(s.picture.bodies[1].path, path_of("rb_{:03}.obj"));
}

TEST_F(SceneFileFields, TakeAColourOfTheScreen) {
  const SceneFile s = read("{\"meshes\": [{\"shape\": \"box\", \"material\": {\"color\": \"#ff8000\"}}]}");
  const vec3 albedo = s.picture.bodies[0].material->albedo;
  EXPECT_NEAR(albedo.x, 1, 1e-6f);
  EXPECT_NEAR(albedo.y, 0.2158605f, 1e-5f);  // IEC 61966-2-1 of 128/255
  EXPECT_EQ(albedo.z, 0);
}

class SceneFilePlacements : public SceneFileTest {
 protected:
  BodyOptions body(const std::string& fields) const {
    return read("{\"meshes\": [{\"shape\": \"box\", " + fields + "}]}").picture.bodies.at(0);
  }
  /// Where a point of the body is.
  vec3 placed(const std::string& fields, vec3 point) const {
    return vec3(body(fields).world_from_body * glm::vec4(point, 1));
  }
  static void expect_near(vec3 a, vec3 b) { EXPECT_LT(glm::length(a - b), 1e-5f) << text_of(a) << text_of(b); }
};

TEST_F(SceneFilePlacements, ScaleThenTurnThenMove) {
  expect_near(placed("\"scale\": 2, \"rotate\": [0, 0, 90], \"translate\": [10, 0, 0]", {1, 0, 0}), {10, 2, 0});
  expect_near(placed("\"translate\": [10, 0, 0], \"rotate\": {\"axis\": [0, 0, 5], \"degrees\": 90}, "
                     "\"scale\": [3, 1, 1]",
                     {1, 0, 0}),
              {10, 3, 0});
}

TEST_F(SceneFilePlacements, TurnAboutXThenYThenZ) {
  expect_near(placed("\"rotate\": [90, 90, 0]", {0, 1, 0}), {1, 0, 0});  // y to z, then z to x
  expect_near(placed("\"rotate\": [0, 90, 90]", {0, 0, 1}), {0, 1, 0});  // z to x, then x to y
  expect_near(placed("\"rotate\": [90, 0, 90]", {0, 0, 1}), {1, 0, 0});  // z to -y, then -y to x
}

TEST_F(SceneFilePlacements, TakeAMatrixRowByRow) {
  const std::string rows = "[1, 0, 0, 5], [0, 0, -1, 6], [0, 1, 0, 7]";
  for (const std::string& matrix : {"[" + rows + "]", "[" + rows + ", [0, 0, 0, 1]]"})
    expect_near(placed("\"matrix\": " + matrix, {1, 2, 3}), {6, 3, 9});
}

TEST_F(SceneFilePlacements, TakeFramesFromAListOrAFile) {
  write("moves.json", "[{\"translate\": [1, 0, 0]}, {\"rotate\": [0, 0, 90]}, {}]");
  for (const char* frames : {"\"moves.json\"", "[{\"translate\": [1, 0, 0]}, {\"rotate\": [0, 0, 90]}, {}]"}) {
    const BodyOptions moving = body(std::string("\"translate\": [0, 0, 4], \"frames\": ") + frames);
    ASSERT_EQ(moving.frames.size(), 3u);
    expect_near(vec3(moving.frames[0] * glm::vec4(0, 0, 0, 1)), {1, 0, 0});
    expect_near(vec3(moving.frames[1] * glm::vec4(1, 0, 0, 1)), {0, 1, 0});
    EXPECT_EQ(moving.frames[2], glm::mat4(1.0f));
    expect_near(vec3(moving.world_from_body * glm::vec4(0, 0, 0, 1)), {0, 0, 4});
  }
}

TEST_F(SceneFilePlacements, DoNotReachTheNextBody) {
  const SceneFile s = read(R"({"meshes": [{"shape": "box", "frames": [{"scale": 3}], "translate": [1, 1, 1],
      "material": {"roughness": 0.5}}, {"shape": "sphere", "material": {}}, {"shape": "cylinder"}]})");
  ASSERT_EQ(s.picture.bodies.size(), 3u);
  EXPECT_EQ(s.picture.bodies[1].world_from_body, glm::mat4(1.0f));
  EXPECT_TRUE(s.picture.bodies[1].frames.empty());
  EXPECT_EQ(s.picture.bodies[1].material, SolidMaterial{});
  EXPECT_FALSE(s.picture.bodies[2].material);
}

using SceneFileCamera = SceneFileTest;

TEST_F(SceneFileCamera, TakesKeysHereOrFromAFile) {
  const std::string keys =
      "[{\"frame\": 0, \"eye\": [0, 1, 5], \"target\": [0, 0, 0]}, "
      "{\"frame\": 10, \"eye\": [5, 1, 0], \"target\": [0, 0, 1], \"fov\": 20}]";
  write("way.json", "{\"keys\": " + keys + "}");
  for (const std::string& path : {keys, std::string("\"way.json\"")}) {
    const SceneFile s = read("{\"camera\": {\"path\": " + path + ", \"fov\": 50}}");
    ASSERT_TRUE(s.picture.path);
    EXPECT_FALSE(s.picture.path->in_seconds());
    ASSERT_EQ(s.picture.path->keys().size(), 2u);
    EXPECT_EQ(s.picture.path->keys()[0].fov_deg, 50);
    EXPECT_EQ(s.picture.path->keys()[1].fov_deg, 20);
    EXPECT_EQ(s.picture.path->keys()[1].eye, vec3(5, 1, 0));
    EXPECT_EQ(s.picture.path->keys()[1].at, 10);
  }
}

}  // namespace
}  // namespace meniscus
