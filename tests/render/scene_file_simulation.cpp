#include <glm/gtc/quaternion.hpp>

#include "render/scene_file_fields.h"
#include "scene_file_fixture.h"

namespace meniscus {
namespace {

class SceneFileSimulation : public SceneFileTest {
 protected:
  void expect_refused(const std::string& text, const std::string& field, const std::string& says) const {
    const Error error = error_of(text);
    EXPECT_EQ(error.code(), ErrorCode::malformed_file) << text << error.what();
    EXPECT_EQ(error.detail().line, 1u) << text;
    EXPECT_EQ(error.detail().problem.substr(0, field.size() + 1), field + " ") << error.what();
    EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << error.what();
  }
  static std::string simulation(const std::string& fields, const std::string& sections = "") {
    return "{\"water\": {\"simulation\": {\"tank\": [[0, 0, 0], [1, 1, 1]], " + fields + "}}" +
           (sections.empty() ? "" : ", " + sections) + "}";
  }
};

const std::string kBlock = "\"blocks\": [[[0, 0, 0], [0.5, 0.5, 0.5]]]";

TEST_F(SceneFileSimulation, ReadsEveryField) {
  const SceneFile scene = read(simulation(
      kBlock +
          ", \"solver\": \"pbf\", \"spacing\": 0.05, \"step\": 0.01, \"frames\": 7, \"fps\": 50, \"most_steps\": 3, "
          "\"viscosity\": 0.2, \"iterations\": 6, \"vorticity\": 0.1, \"gravity\": 2, \"density\": 900, "
          "\"pour\": [{\"from\": 0.01, \"until\": 0.1, \"at\": [0.5, 0.9, 0.5], \"velocity\": [0, -2, 0], "
          "\"radius\": 0.1}], \"stir\": [{\"centre\": [0.2, 0.3, 0.4], \"radius\": 0.2, \"speed\": -3}], "
          "\"tilt\": [{\"axis\": [1, 0, 0], \"angle\": 90}], "
          "\"drag\": [{\"body\": \"post\", \"to\": [0.6, 0.2, 0.2], \"from\": 0.02, \"until\": 0.08}]",
      "\"meshes\": [{\"shape\": \"sphere\"}, {\"name\": \"post\", \"shape\": \"box\", \"obstacle\": {\"motion\": "
      "\"dynamic\", \"density\": 700, \"appears\": 0.5}}]"));
  ASSERT_TRUE(scene.simulation);
  const SimulatedWater& water = *scene.simulation;
  const SimulationOptions& simulation = water.simulation;
  EXPECT_EQ(simulation.fluid.solver, Solver::pbf);
  EXPECT_FLOAT_EQ(simulation.fluid.spacing, 0.05f);
  EXPECT_FLOAT_EQ(simulation.fluid.step, 0.01f);
  EXPECT_EQ(water.frames, 7u);
  EXPECT_EQ(water.frames_per_second, 50);
  EXPECT_EQ(scene.video.frames_per_second, 50) << "a film runs as fast as its water";
  EXPECT_EQ(water.most_steps, 3);
  EXPECT_FLOAT_EQ(simulation.fluid.viscosity, 0.2f);
  EXPECT_EQ(simulation.fluid.iterations, 6);
  EXPECT_FLOAT_EQ(simulation.fluid.vorticity, 0.1f);
  EXPECT_EQ(simulation.fluid.gravity, vec3(0, -2, 0));
  EXPECT_FLOAT_EQ(simulation.fluid.rest_density, 900);
  ASSERT_EQ(simulation.blocks.size(), 1u);
  EXPECT_EQ(simulation.blocks[0].high, vec3(0.5f));
  ASSERT_EQ(simulation.pours.size(), 1u);
  EXPECT_EQ(simulation.pours[0].until, 0.1);
  EXPECT_EQ(simulation.pours[0].velocity, vec3(0, -2, 0));
  ASSERT_EQ(simulation.stirs.size(), 1u);
  EXPECT_NEAR(simulation.stirs[0].until, 0.14, 1e-12) << "to the film's end";
  EXPECT_EQ(simulation.stirs[0].axis, vec3(0, 1, 0));
  EXPECT_FLOAT_EQ(simulation.stirs[0].speed, -3);
  ASSERT_EQ(simulation.tilts.size(), 1u);
  EXPECT_NEAR(simulation.tilts[0].angle, 1.5707963f, 1e-5f);
  ASSERT_EQ(water.dragged, std::vector<std::string>{"post"});
  EXPECT_EQ(simulation.drags[0].to, vec3(0.6f, 0.2f, 0.2f));
  EXPECT_FALSE(scene.picture.bodies[0].role);
  ASSERT_TRUE(scene.picture.bodies[1].role);
  EXPECT_TRUE(scene.picture.bodies[1].role->dynamic);
  EXPECT_EQ(scene.picture.bodies[1].role->appears, 0.5);
  EXPECT_EQ(scene.picture.tank_inside->high, vec3(1)) << "the tank that is drawn is the one that is simulated";
  EXPECT_EQ(*scene.picture.ground_height, 0);
}

TEST_F(SceneFileSimulation, TakesTankSpacingAndUpFromTheScene) {
  const SceneFile scene = read(
      "{\"water\": {\"up\": \"z\", \"spacing\": 0.1, \"simulation\": {\"pour\": [{\"at\": [1, 1, 1]}]}}, "
      "\"tank\": {\"inside\": [[0, 0, 0], [2, 2, 3]]}}");
  const SimulationOptions& simulation = scene.simulation->simulation;
  EXPECT_EQ(simulation.tank.high, vec3(2, 2, 3));
  EXPECT_FLOAT_EQ(simulation.fluid.spacing, 0.1f);
  EXPECT_EQ(simulation.up, Axis::z);
  EXPECT_EQ(simulation.fluid.gravity, vec3(0, 0, -9.81f));
  EXPECT_EQ(simulation.pours[0].velocity, vec3(0, 0, -1));
}

TEST_F(SceneFileSimulation, ReadsTheWayOfAnObstacle) {
  const SceneFile scene = read(
      simulation(kBlock,
                 "\"meshes\": [{\"shape\": \"box\", \"rotate\": [0, 90, 0], \"translate\": [1, 2, 3], \"scale\": 2, "
                 "\"obstacle\": {\"path\": [{\"time\": 0}, {\"time\": 1, \"position\": [4, 5, 6]}, "
                 "{\"time\": 2, \"rotation\": [2, 0, 0, 0]}, "
                 "{\"time\": 3, \"rotation\": {\"axis\": [0, 2, 0], \"degrees\": 180}}]}}]"));
  const std::vector<PoseKey>& path = scene.picture.bodies[0].role->path;
  ASSERT_EQ(path.size(), 4u);
  EXPECT_EQ(path[0].pose.position, vec3(1, 2, 3)) << "what a key leaves out is as the body is placed";
  EXPECT_NEAR(path[0].pose.rotation.y, std::sqrt(0.5f), 1e-6f);
  EXPECT_EQ(path[1].pose.position, vec3(4, 5, 6));
  EXPECT_NEAR(path[2].pose.rotation.w, 1, 1e-6f);
  EXPECT_NEAR(std::abs(path[3].pose.rotation.y), 1, 1e-6f);
  EXPECT_FLOAT_EQ(scene.picture.bodies[0].world_from_body[3].x, 1) << "the key's rotation is not the body's";
}

TEST_F(SceneFileSimulation, RefusesWhatDoesNotGoTogether) {
  const std::string box = "{\"shape\": \"box\", \"name\": \"crate\"";
  expect_refused("{\"water\": {\"frames\": \"f\", \"simulation\": {}}}", "water.simulation", "beside frames");
  expect_refused("{\"water\": {\"waves\": {}, \"heights\": {\"waves\": [{}]}}}", "water.heights", "beside waves");
  expect_refused("{\"water\": {\"simulation\": {" + kBlock + "}}}", "water.simulation", "tank");
  expect_refused(simulation("\"frames\": 3"), "water.simulation", "no water");
  expect_refused(simulation("\"blocks\": [[[0, 0, 0], [2, 0.5, 1]]]"), "water.simulation.blocks[0]", "out of the tank");
  expect_refused(simulation("\"blocks\": [[[0, 0, 0]]]"), "water.simulation.blocks[0]", "two opposite corners");
  expect_refused(simulation(kBlock + ", \"iterations\": 3"), "water.simulation.iterations", "pbf only");
  expect_refused(simulation(kBlock + ", \"solver\": \"pfb\""), "water.simulation.solver", "did you mean pbf?");
  expect_refused(simulation(kBlock + ", \"blocs\": 1"), "water.simulation.blocs", "did you mean blocks?");
  expect_refused(simulation("\"pour\": [{}]"), "water.simulation.pour[0]", "has no at");
  expect_refused(simulation("\"pour\": [{\"at\": [0, 0, 0], \"from\": 2, \"until\": 1}]"),
                 "water.simulation.pour[0].until", "after from");
  expect_refused(simulation("\"pour\": [{\"at\": [0, 0, 0], \"from\": 5}]"), "water.simulation.pour[0].from",
                 "last frame");
  const std::string drag = kBlock + ", \"drag\": [{\"body\": \"crat\", \"to\": [0, 0, 0]}]";
  expect_refused(simulation(drag), "water.simulation.drag[0].body", "name of no mesh");
  expect_refused(simulation(drag, "\"meshes\": [" + box + ", \"obstacle\": {}}]"), "water.simulation.drag[0].body",
                 "did you mean crate?");
  expect_refused(
      simulation(kBlock + ", \"drag\": [{\"body\": \"crate\", \"to\": [0, 0, 0]}]", "\"meshes\": [" + box + "}]"),
      "water.simulation.drag[0].body", "is no obstacle");
  expect_refused("{\"meshes\": [" + box + ", \"obstacle\": {}}]}", "meshes[0].obstacle", "water.simulation");
  expect_refused(simulation(kBlock, "\"meshes\": [" + box + ", \"obstacle\": {}, \"frames\": [{}]}]"),
                 "meshes[0].frames", "obstacle");
  expect_refused(simulation(kBlock, "\"meshes\": [" + box + ", \"obstacle\": {\"density\": 3}}]"),
                 "meshes[0].obstacle.density", "dynamic");
  expect_refused(simulation(kBlock, "\"meshes\": [" + box + ", \"obstacle\": {\"motion\": \"path\"}}]"),
                 "meshes[0].obstacle", "has no path");
  expect_refused(
      simulation(kBlock, "\"meshes\": [" + box + ", \"obstacle\": {\"path\": [{\"time\": 1}, {\"time\": 1}]}}]"),
      "meshes[0].obstacle.path[1]", "more than 1 s");
  expect_refused(simulation(kBlock, "\"meshes\": [" + box + "}, " + box + "}]"), "meshes[1].name", "another mesh");
}

TEST_F(SceneFileSimulation, ReadsMadeUpHeights) {
  const SceneFile scene = read(
      "{\"water\": {\"heights\": {\"region\": [[0, 0, 0], [2, 0.5, 1]], \"step\": 0.05, \"frames\": 9, \"fps\": 10, "
      "\"waves\": [{\"kind\": \"gerstner\", \"amplitude\": 0.03, \"wavelength\": 0.7, \"direction\": 30, \"phase\": "
      "45, "
      "\"speed\": 2, \"steepness\": 0.4}, {}]}}}");
  ASSERT_TRUE(scene.heights);
  ASSERT_EQ(scene.heights->waves.size(), 2u);
  const WaveTrain& wave = scene.heights->waves[0];
  EXPECT_EQ(wave.kind, WaveTrain::Kind::gerstner);
  EXPECT_FLOAT_EQ(wave.direction_deg, 30);
  EXPECT_FLOAT_EQ(wave.steepness, 0.4f);
  EXPECT_EQ(scene.picture.method, SurfaceMethod::height_field);
  ASSERT_TRUE(scene.picture.heights);
  const HeightField now = scene.picture.heights(0), later = scene.picture.heights(0.2);
  EXPECT_FALSE(now.empty());
  EXPECT_NE(now.height(3, 3), later.height(3, 3));
  expect_refused("{\"water\": {\"heights\": {\"waves\": [{}]}}}", "water.heights", "region");
  expect_refused("{\"water\": {\"heights\": {\"region\": [[0, 0, 0], [1, 1, 1]]}}}", "water.heights",
                 "waves or an image");
  expect_refused(
      "{\"water\": {\"surface\": \"raycast\", \"heights\": {\"waves\": [{}], \"region\": [[0, 0, 0], [1, 1, 1]]}}}",
      "water.surface", "height_field");
}

TEST_F(SceneFileSimulation, ReadsTheOpticsOfVirtualEyes) {
  const PictureOptions picture =
      read(
          "{\"water\": {\"surface\": \"height_field\", \"height_field\": {\"step\": 0.1, \"smoothing\": 0, "
          "\"iso_radius\": 0.2, \"iso\": 3}}, \"optics\": {\"refraction\": \"virtual_eye\", \"fresnel\": \"schlick\", "
          "\"dispersion\": true, \"eyes\": {\"map_size\": 64, \"displaced_eye\": false, \"trapezium_a\": 0.5, "
          "\"per_point\": true, \"object_position\": true, \"static_position\": false, \"combine_distance\": 0.3}}, "
          "\"caustics\": {\"method\": \"combined\", \"simple\": [1, 2, 3], \"simple_keeps_mean\": false, "
          "\"on_walls\": false}}")
          .picture;
  EXPECT_EQ(picture.method, SurfaceMethod::height_field);
  EXPECT_FLOAT_EQ(picture.height_field.step, 0.1f);
  EXPECT_EQ(picture.height_field.smoothing, 0);
  EXPECT_FLOAT_EQ(picture.height_field.iso, 3);
  EXPECT_EQ(picture.optics.refraction, RefractionMethod::virtual_eye);
  EXPECT_EQ(picture.optics.fresnel, FresnelFormula::schlick);
  EXPECT_TRUE(picture.optics.dispersion);
  EXPECT_EQ(picture.optics.eyes.map_size, 64);
  EXPECT_FALSE(picture.optics.eyes.displaced_eye);
  EXPECT_TRUE(picture.optics.eyes.per_point);
  EXPECT_TRUE(picture.optics.eyes.object_position);
  EXPECT_FALSE(picture.optics.eyes.static_position);
  EXPECT_FLOAT_EQ(picture.optics.eyes.combine_distance, 0.3f);
  EXPECT_EQ(picture.caustics_options.method, CausticsMethod::combined);
  EXPECT_FLOAT_EQ(picture.caustics_options.simple_b, 2);
  EXPECT_FALSE(picture.caustics_options.simple_keeps_mean);
  EXPECT_FALSE(picture.caustics_options.on_walls);
}

/// An object with every field of a section whose default is a value, at that default.
std::string at_defaults(const scene_file::Section& section) {
  std::string text;
  for (const scene_file::Field& field : section.fields)
    if (field.standard.front() != '(') text += (text.empty() ? "\"" : ", \"") + field.name + "\": " + field.standard;
  return "{" + text + "}";
}

TEST_F(SceneFileSimulation, DocumentsTheDefaultsThatOpticsHave) {
  const PictureOptions said = read("{\"optics\": {\"eyes\": " + at_defaults(scene_file::eyes_section()) +
                                   "}, \"caustics\": " + at_defaults(scene_file::caustics_section()) + "}")
                                  .picture;
  const VirtualEyeOptions eyes;
  const VirtualEyeOptions& said_eyes = said.optics.eyes;
  EXPECT_EQ(said_eyes.map_size, eyes.map_size);
  EXPECT_EQ(said_eyes.displaced_eye, eyes.displaced_eye);
  EXPECT_EQ(said_eyes.scale_correction, eyes.scale_correction);
  EXPECT_EQ(said_eyes.adaptation, eyes.adaptation);
  EXPECT_EQ(said_eyes.trapezium, eyes.trapezium);
  EXPECT_EQ(said_eyes.trapezium_a, eyes.trapezium_a);
  EXPECT_EQ(said_eyes.trapezium_b, eyes.trapezium_b);
  EXPECT_EQ(said_eyes.per_point, eyes.per_point);
  EXPECT_EQ(said_eyes.object_position, eyes.object_position);
  EXPECT_EQ(said_eyes.static_position, eyes.static_position);
  EXPECT_EQ(said_eyes.adaptation_width, eyes.adaptation_width);
  const CausticsOptions caustics;
  const CausticsOptions& said_caustics = said.caustics_options;
  EXPECT_EQ(said_caustics.method, caustics.method);
  EXPECT_EQ(said_caustics.simple_a, caustics.simple_a);
  EXPECT_EQ(said_caustics.simple_b, caustics.simple_b);
  EXPECT_EQ(said_caustics.simple_c, caustics.simple_c);
  EXPECT_EQ(said_caustics.simple_keeps_mean, caustics.simple_keeps_mean);
  EXPECT_EQ(said_caustics.on_walls, caustics.on_walls);
  EXPECT_EQ(said_caustics.screen, caustics.screen);
  EXPECT_EQ(said_caustics.iterations, caustics.iterations);
  EXPECT_EQ(said_caustics.exact_hits, caustics.exact_hits);
  EXPECT_EQ(said_caustics.single_interface, caustics.single_interface);
  EXPECT_EQ(said_caustics.most_lights, caustics.most_lights);
}

}  // namespace
}  // namespace meniscus
