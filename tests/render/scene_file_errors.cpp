#include "scene_file_fixture.h"

namespace meniscus {
namespace {

class SceneFileErrors : public SceneFileTest {
 protected:
  /// One line about a bad scene: what it must be refused for.
  void expect_refused(const std::string& text, std::uint64_t line, const std::string& field,
                      const std::string& says) const {
    const Error error = error_of(text);
    EXPECT_EQ(error.code(), ErrorCode::malformed_file) << text;
    EXPECT_EQ(error.detail().path, path_of("scene.json")) << text;
    EXPECT_EQ(error.detail().line, line) << text << error.what();
    EXPECT_EQ(error.detail().problem.substr(0, field.size() + 1), field + " ") << error.what();
    EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << error.what();
  }
};

TEST_F(SceneFileErrors, NameUnknownFieldsAndTheNearestKnownOne) {
  expect_refused("{\n \"water\": {\n  \"isso\": 0.5}}", 3, "water.isso", "did you mean iso?");
  expect_refused("{\"meshes\": [{\"shape\": \"box\"},\n {\"shape\": \"box\", \"rotat\": [0, 0, 0]}]}", 2,
                 "meshes[1].rotat", "did you mean rotate?");
  expect_refused("{\"color\": {}}", 1, "color", "did you mean colour?");
  expect_refused("{\"camera\": {\"exposure\": 1}}", 1, "camera.exposure", "there is picture.exposure");
  expect_refused("{\"qqqqqqqqq\": 1}", 1, "qqqqqqqqq", "known here: $schema, water");
}

TEST_F(SceneFileErrors, NameTheColumn) {
  const Error error = error_of("{\n \"water\": { \"isso\": 0.5}}");
  EXPECT_NE(std::string(error.what()).find("column 13"), std::string::npos) << error.what();
}

TEST_F(SceneFileErrors, NameTheWrongKind) {
  expect_refused("{\"water\": []}", 1, "water", "an object");
  expect_refused("{\"water\":\n {\"iso\": \"half\"}}", 2, "water.iso", "a number");
  expect_refused("{\"water\": {\"refinement_steps\": 1.5}}", 1, "water.refinement_steps", "whole number");
  expect_refused("{\"water\": {\"keep_thin\": 1}}", 1, "water.keep_thin", "true or false");
  expect_refused("{\"water\": {\"kernel\": \"wyvil\"}}", 1, "water.kernel", "did you mean wyvill?");
  expect_refused("{\"water\": {\"frames\": [1]}}", 1, "water.frames[0]", "a text");
  expect_refused("{\"meshes\": [7]}", 1, "meshes[0]", "an object");
  expect_refused("{\"camera\": {\"eye\": [1, 2]}}", 1, "camera.eye", "a list of 3 numbers");
  expect_refused("{\"camera\": {\"eye\": [1, 2, null]}}", 1, "camera.eye[2]", "a number");
  expect_refused("{\"camera\": null}", 1, "camera", "an object");
  expect_refused("{\"picture\": {\"size\": [640.5, 480]}}", 1, "picture.size[0]", "whole");
  expect_refused("{\"picture\": {\"size\": \"640*480\"}}", 1, "picture.size", "WIDTHxHEIGHT");
  expect_refused("{\"caustics\": 3}", 1, "caustics", "true or false, or an object");
}

TEST_F(SceneFileErrors, NameTheRange) {
  expect_refused("{\"water\": {\"iso\": 1}}", 1, "water.iso", "above 0 to below 1");
  expect_refused("{\"water\": {\"iso\": 0}}", 1, "water.iso", "above 0 to below 1");
  expect_refused("{\"water\": {\"spacing\": 0}}", 1, "water.spacing", "above 0");
  expect_refused("{\"water\": {\"spacing\": 1e300}}", 1, "water.spacing", "above 0");
  expect_refused("{\"water\": {\"ior\": 1}}", 1, "water.ior", "above 1 to 4");
  expect_refused("{\"water\": {\"tint\": [0.5, 0, 1]}}", 1, "water.tint[1]", "above 0 to 1");
  expect_refused("{\"optics\": {\"bounces\": 65}}", 1, "optics.bounces", "1 to 64");
  expect_refused("{\"camera\": {\"fov\": 180}}", 1, "camera.fov", "below 180");
  expect_refused("{\"output\": {\"quality\": 52}}", 1, "output.quality", "0 to 51");
  expect_refused("{\"picture\": {\"size\": [0, 480]}}", 1, "picture.size[0]", "1 to 65535");
}

TEST_F(SceneFileErrors, NameFieldsThatDoNotGoTogether) {
  expect_refused("{\"meshes\": [{}]}", 1, "meshes[0]", "one of them");
  expect_refused("{\"meshes\": [{\"shape\": \"box\", \"file\": \"{}.obj\"}]}", 1, "meshes[0]", "both");
  expect_refused("{\"meshes\": [{\"shape\": \"box\", \"scale\": 2,\n \"matrix\": [[1,0,0,0],[0,1,0,0],[0,0,1,0]]}]}", 2,
                 "meshes[0].matrix", "cannot stand beside");
  expect_refused("{\"water\": {\"frames\": \"f\", \"waves\": {}}}", 1, "water.waves", "cannot stand beside frames");
  expect_refused("{\"water\": {\"first\": 5, \"last\": 4}}", 1, "water.last", "comes before first");
  expect_refused("{\"water\": {\"waves\": {\"height\": 0.45}}}", 1, "water.waves", "0.4 m");
  expect_refused("{\"lights\": {\"sun\": {\"azimuth\": 5}}}", 1, "lights.sun", "azimuth alone");
  expect_refused("{\"lights\": {\"lamps\": [{\"intensity\": 5}]}}", 1, "lights.lamps[0]", "position");
  expect_refused("{\"colour\": {\"legend\": true}}", 1, "colour", "attribute");
  expect_refused("{\"colour\": {\"by\": \"v\", \"range\": [2, 2]}}", 1, "colour.range", "rise");
  expect_refused("{\"tank\": {\"inside\": [[0, 0, 0], [1, 0, 1]]}}", 1, "tank.inside", "space");
}

TEST_F(SceneFileErrors, NameBadPlacements) {
  const auto mesh = [](const std::string& fields) { return "{\"meshes\": [{\"shape\": \"box\", " + fields + "}]}"; };
  expect_refused(mesh("\"scale\": 0"), 1, "meshes[0].scale", "1e-09");
  expect_refused(mesh("\"scale\": [1, -1, 1]"), 1, "meshes[0].scale[1]", "1e-09");
  expect_refused(mesh("\"rotate\": {\"axis\": [0, 0, 0], \"degrees\": 3}"), 1, "meshes[0].rotate.axis", "length");
  expect_refused(mesh("\"matrix\": [[1,0,0,0],[0,1,0,0]]"), 1, "meshes[0].matrix", "2 rows");
  expect_refused(mesh("\"matrix\": [[1,0,0,0],[0,1,0],[0,0,1,0]]"), 1, "meshes[0].matrix[1]", "3 numbers");
  expect_refused(mesh("\"matrix\": [[1,0,0,0],[0,0,0,0],[0,0,1,0]]"), 1, "meshes[0].matrix", "inverted");
  expect_refused(mesh("\"matrix\": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,1,1]]"), 1, "meshes[0].matrix[3]",
                 "[0, 0, 0, 1]");
  expect_refused(mesh("\"frames\": []"), 1, "meshes[0].frames", "at least one");
  expect_refused(mesh("\"frames\": [{}, {\"turn\": 1}]"), 1, "meshes[0].frames[1].turn", "known here");
  expect_refused(mesh("\"material\": {\"color\": \"red\"}"), 1, "meshes[0].material.color", "#rrggbb");
  expect_refused(mesh("\"material\": {\"color\": \"#12345g\"}"), 1, "meshes[0].material.color", "#rrggbb");
}

TEST_F(SceneFileErrors, NameBadCameraKeys) {
  const auto path = [](const std::string& keys) { return "{\"camera\": {\"path\": [" + keys + "]}}"; };
  const std::string good = "{\"frame\": 0, \"eye\": [0, 1, 2], \"target\": [0, 0, 0]}";
  EXPECT_NO_THROW(read(path(good)));
  expect_refused(path(""), 1, "camera.path", "at least one");
  expect_refused(path("{\"eye\": [0, 1, 2], \"target\": [0, 0, 0]}"), 1, "camera.path[0]", "neither");
  expect_refused(path(good + ", " + good), 1, "camera.path[1]", "more than 0");
  expect_refused(path(good + ", {\"time\": 1, \"eye\": [0, 1, 2], \"target\": [0, 0, 0]}"), 1, "camera.path[1]",
                 "frame");
  expect_refused(path("{\"frame\": 0, \"eye\": [0, 1, 2]}"), 1, "camera.path[0]", "target");
  expect_refused(path("{\"frame\": 0, \"eye\": [0, 1, 2], \"target\": [0, 1, 2]}"), 1, "camera.path[0]", "two points");
}

TEST_F(SceneFileErrors, NameMissingFilesWithTheirField) {
  for (const char* text :
       {"{\"meshes\":\n [{\"file\": \"no.obj\"}]}", "{\"environment\":\n {\"hdr\": \"no.hdr\"}}",
        "{\"camera\":\n {\"path\": \"no.json\"}}", "{\"meshes\":\n [{\"shape\": \"box\", \"frames\": \"no.json\"}]}"}) {
    const Error error = error_of(text);
    EXPECT_EQ(error.code(), ErrorCode::not_found) << error.what();
    EXPECT_EQ(error.detail().line, 2u) << error.what();
    EXPECT_NE(error.detail().found.find(path_of("no.")), std::string::npos) << error.what();
  }
  EXPECT_THROW(read_scene_file(path_of("none.json")), Error);
  EXPECT_THROW(read_scene_file(path_of("")), Error);  // a folder
  EXPECT_EQ(error_of("{\"meshes\": [{\"file\": \"rb_{:x}.obj\"}]}").code(), ErrorCode::malformed_file);
}

TEST_F(SceneFileErrors, NameTheFileOfTransforms) {
  write("moves.json", "[{},\n {\"translate\": 3}]");
  const Error error = error_of("{\"meshes\": [{\"shape\": \"box\", \"frames\": \"moves.json\"}]}");
  EXPECT_EQ(error.detail().path, path_of("moves.json"));
  EXPECT_EQ(error.detail().line, 2u);
  EXPECT_EQ(error.detail().problem.substr(0, 13), "[1].translate") << error.what();
}

TEST_F(SceneFileErrors, AreNoCrashForAnyByteChanged) {
  const std::string good =
      "{\"water\": {\"waves\": {\"height\": 0.05}, \"iso\": 0.4}, \"meshes\": [{\"shape\": \"box\", \"rotate\": [1, 2, "
      "3]}], \"picture\": {\"size\": \"64x48\"}}";
  ASSERT_NO_THROW(read(good));
  for (std::size_t i = 0; i < good.size(); ++i)
    for (const char c : {'"', '{', ']', '9', '-', '\0', '\xff'}) {
      std::string bad = good;
      bad[i] = c;
      try {
        read(bad);
      } catch (const Error&) {
      }
    }
}

}  // namespace
}  // namespace meniscus
