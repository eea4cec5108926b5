#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <glm/gtc/matrix_transform.hpp>

#include "meniscus/render.h"
#include "render/body_placement.h"

namespace meniscus {
namespace {

SimulatedWater small_tank() {
  SimulatedWater water;
  water.frames = 6;
  water.simulation.fluid.solver = Solver::pbf;
  water.simulation.fluid.spacing = 0.05f;
  water.simulation.tank = {{0, 0, 0}, {0.6f, 0.6f, 0.4f}};
  water.simulation.blocks = {{{0, 0, 0}, {0.3f, 0.3f, 0.4f}}};
  return water;
}

BodyOptions body_at(const std::string& shape, vec3 place, vec3 scale) {
  BodyOptions body;
  body.shape = shape;
  body.name = shape;
  body.world_from_body = glm::scale(glm::rotate(glm::translate(glm::mat4(1), place), 0.5f, {0, 1, 0}), scale);
  body.role.emplace();
  return body;
}

void expect_near(const glm::mat4& a, const glm::mat4& b, float within) {
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) EXPECT_NEAR(a[i][j], b[i][j], within) << i << ' ' << j;
}

TEST(BodyPlacement, IsTheMatrixAgain) {
  const glm::mat4 matrix = body_at("box", {1, 2, 3}, {0.5f, 2, 3}).world_from_body;
  const BodyPlacement placement = placement_of(matrix);
  EXPECT_TRUE(placement.scales);
  expect_near(matrix_of(placement.pose) * glm::mat4(placement.shape), matrix, 1e-6f);
  glm::mat4 sheared = matrix;
  sheared[1][0] += 1;
  EXPECT_FALSE(placement_of(sheared).scales);
  expect_near(matrix_of(placement_of(sheared).pose) * glm::mat4(placement_of(sheared).shape), sheared, 1e-6f);
}

TEST(BodyPlacement, KeepsShapesWhereTheScaleFits) {
  const auto kind = [](const std::string& shape, vec3 scale) {
    return obstacle_shape_of(box_mesh(vec3(-0.5f), vec3(0.5f)), shape,
                             placement_of(body_at(shape, vec3(0), scale).world_from_body))
        .kind;
  };
  EXPECT_EQ(kind("box", {1, 2, 3}), ObstacleShape::Kind::box);
  EXPECT_EQ(kind("sphere", vec3(2)), ObstacleShape::Kind::sphere);
  EXPECT_EQ(kind("sphere", {1, 2, 1}), ObstacleShape::Kind::mesh);
  EXPECT_EQ(kind("cylinder", {1, 2, 1}), ObstacleShape::Kind::cylinder);
  EXPECT_EQ(kind("cylinder", {1, 2, 2}), ObstacleShape::Kind::mesh);
}

TEST(BodyPlacement, WeldsMeshes) {
  const ObstacleShape shape = obstacle_shape_of(box_mesh(vec3(-0.5f), vec3(0.5f)), "", placement_of(glm::mat4(2.0f)));
  EXPECT_EQ(shape.positions.size(), 8u) << "a box's faces share their corners";
  EXPECT_EQ(shape.corners.size(), 36u);
}

TEST(SimulatedScene, GivesFramesInRisingOrderOnly) {
  SimulatedScene scene(small_tank(), {});
  const Particles start = scene.frame(0);
  EXPECT_EQ(start.size(), 6u * 6u * 8u);
  EXPECT_EQ(*start.time, 0);
  EXPECT_NEAR(*scene.frame(3).time, 0.12, 0.005);
  EXPECT_EQ(scene.frame(3).x, scene.frame(3).x);
  EXPECT_THROW(scene.frame(2), Error);
  EXPECT_THROW(scene.frame(6), Error);
}

TEST(SimulatedScene, DoesNotDriftAndSkipsFrames) {
  SimulatedWater water = small_tank();
  water.frames = 31;
  water.frames_per_second = 31;  // no multiple of a step
  SimulatedScene one(water, {}), other(water, {});
  Particles last;
  for (std::size_t i = 0; i < 31; ++i) last = one.frame(i);
  EXPECT_NEAR(*last.time, 30.0 / 31, 1.0 / 240 + 1e-6);
  const Particles skipped = other.frame(30);
  EXPECT_EQ(last.x, skipped.x);
  EXPECT_EQ(last.y, skipped.y);
}

TEST(SimulatedScene, SlowsTheWaterRatherThanThePicture) {
  SimulatedWater water = small_tank();
  water.most_steps = 1;
  SimulatedScene scene(water, {});
  scene.frame(5);
  EXPECT_EQ(scene.simulation().steps(), 5u);
}

std::string refusal(const SimulatedWater& water) {
  try {
    SimulatedScene scene(water, {});
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
    return error.what();
  }
  return "nothing was refused";
}

TEST(SimulatedScene, RefusesStepsLongerThanAFrame) {
  SimulatedWater water = small_tank();
  water.simulation.fluid.step = 0.1f;
  EXPECT_NE(refusal(water).find("longer than a frame (expected at most 0.04 s, a frame at 25 a second, found a step of "
                                "0.1 s"),
            std::string::npos)
      << refusal(water);
  water.simulation.fluid.step = 0.04f;
  EXPECT_NO_THROW(SimulatedScene(water, {}));
}

TEST(SimulatedScene, MakesDefaultStepsNoLongerThanAFrame) {
  SimulatedWater water = small_tank();
  water.frames_per_second = 1000;
  for (const Solver solver : {Solver::sph, Solver::pbf}) {
    water.simulation.fluid.solver = solver;
    SimulatedScene scene(water, {});
    EXPECT_NEAR(*scene.frame(5).time, 0.005, 1e-6);
    EXPECT_EQ(scene.simulation().steps(), 5u);
  }
}

TEST(SimulatedScene, RefusesFramesOfTooManySteps) {
  SimulatedWater water = small_tank();
  water.simulation.fluid.step = 2e-6f;
  EXPECT_NE(refusal(water).find("found 20000 steps a frame"), std::string::npos) << refusal(water);
  water.most_steps = 10;
  EXPECT_NO_THROW(SimulatedScene(water, {}));
  water.most_steps = 0;
  water.simulation.fluid.solver = Solver::sph;
  water.simulation.fluid.step = 0;
  water.simulation.fluid.stiffness = 2e8f;  // h = 0.1 m: 3.5 microseconds
  EXPECT_NE(refusal(water).find("steps a frame"), std::string::npos) << refusal(water);
  water.simulation.fluid.step = 2e-4f;  // in 57 parts
  EXPECT_NE(refusal(water).find("steps a frame"), std::string::npos) << refusal(water);
}

TEST(SimulatedScene, LeavesStandingBodiesExactlyWhereTheyArePlaced) {
  SimulatedScene scene(small_tank(), {body_at("box", {0.45f, 0.1f, 0.2f}, vec3(0.1f))});
  scene.frame(2);
  ASSERT_EQ(scene.transforms().size(), 1u);
  EXPECT_EQ(*scene.transforms()[0], glm::mat4(1.0f));
}

TEST(SimulatedScene, DrawsBodiesWhereTheirObstaclesAre) {
  BodyOptions body = body_at("box", {0.45f, 0.3f, 0.2f}, {0.1f, 0.05f, 0.08f});
  body.role->dynamic = true;
  body.role->appears = 0.06;
  SimulatedScene scene(small_tank(), {body});
  scene.frame(0);
  EXPECT_FALSE(scene.transforms()[0]) << "it has not appeared";
  scene.frame(5);
  ASSERT_TRUE(scene.transforms()[0]);
  const BodyPlacement placement = placement_of(body.world_from_body);
  expect_near(body.world_from_body * *scene.transforms()[0],
              matrix_of(scene.simulation().pose(0)) * glm::mat4(placement.shape), 1e-5f);
  EXPECT_LT((body.world_from_body * *scene.transforms()[0])[3].y, 0.299f) << "it falls";
}

TEST(SimulatedScene, KnowsItsPicturesBeforehand) {
  const Survey survey = SimulatedScene(small_tank(), {}).survey();
  EXPECT_EQ(survey.frames, 6u);
  EXPECT_EQ(survey.most_particles, 288u);
  EXPECT_EQ(survey.bounds.high, vec3(0.6f, 0.6f, 0.4f));
  EXPECT_FLOAT_EQ(survey.spacing.spacing, 0.05f);
}

TEST(SimulatedScene, RefusesBodiesThatCannotBeObstacles) {
  BodyOptions mesh = body_at("sphere", {0.4f, 0.4f, 0.2f}, {0.1f, 0.2f, 0.1f});
  mesh.role->dynamic = true;
  EXPECT_THROW(SimulatedScene(small_tank(), {mesh}), Error);
  BodyOptions moved = body_at("box", {0.4f, 0.4f, 0.2f}, vec3(0.1f));
  moved.frames.push_back(glm::mat4(1));
  EXPECT_THROW(SimulatedScene(small_tank(), {moved}), Error);
  SimulatedWater water = small_tank();
  water.simulation.drags.push_back({0, 1, 0, vec3(0.2f)});
  water.dragged = {"bx"};
  try {
    SimulatedScene(water, {body_at("box", {0.4f, 0.4f, 0.2f}, vec3(0.1f))});
    ADD_FAILURE() << "nothing was refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::not_found);
    EXPECT_NE(std::string(error.what()).find("did you mean box?"), std::string::npos) << error.what();
  }
}

class SimulatedFilesTest : public testing::Test {
 protected:
  SimulatedFilesTest() { std::filesystem::create_directories(folder_); }
  ~SimulatedFilesTest() override { std::filesystem::remove_all(folder_); }
  const std::string folder_ =
      testing::TempDir() + "/simulated_" + testing::UnitTest::GetInstance()->current_test_info()->name();
};

TEST_F(SimulatedFilesTest, AreReadBackBitForBit) {
  SimulatedScene scene(small_tank(), {}), again(small_tank(), {});
  const SimulationReport report = write_simulation(scene, {}, folder_ + "/f_{}.ply", 3);
  ASSERT_EQ(report.frames.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    const Particles read = read_particles(folder_ + "/f_" + std::to_string(i) + ".ply"), made = again.frame(i);
    EXPECT_EQ(read.x, made.x);
    EXPECT_EQ(read.y, made.y);
    EXPECT_EQ(read.z, made.z);
    ASSERT_TRUE(read.find("velocity"));
    EXPECT_EQ(read.find("velocity")->values, made.find("velocity")->values);
    EXPECT_EQ(read.time, made.time);
    EXPECT_EQ(read.spacing, 0.05f);
    EXPECT_EQ(read.up, Axis::y);
  }
  EXPECT_THROW(write_simulation(scene, {}, folder_ + "/one.ply", 3), Error) << "three frames in one file";
  for (const char* other : {"/f_{}.png", "/f_{}.vtk", "/f_{}"}) try {
      write_simulation(scene, {}, folder_ + other, 3);
      ADD_FAILURE() << other << " was written";
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(".ply"), std::string::npos) << error.what();
    }
}

TEST_F(SimulatedFilesTest, AreDrawnByTheSceneFileBesideThem) {
  const std::string scene_path = folder_ + "/scene.json";
  std::ofstream(scene_path) << R"({"water": {"simulation": {"solver": "pbf", "spacing": 0.05, "frames": 4,
    "tank": [[0, 0, 0], [0.6, 0.6, 0.4]], "blocks": [[[0, 0, 0], [0.3, 0.3, 0.4]]]}},
    "meshes": [{"shape": "box", "scale": 0.1, "translate": [0.45, 0.1, 0.2], "obstacle": {}},
      {"name": "a ball", "shape": "sphere", "scale": 0.1, "translate": [0.45, 0.5, 0.2],
       "obstacle": {"motion": "dynamic", "appears": 0.06}}]})";
  const SceneFile scene = read_scene_file(scene_path);
  SimulatedScene simulated(*scene.simulation, scene.picture.bodies);
  std::vector<std::vector<std::optional<glm::mat4>>> transforms;
  const SimulationReport report = write_simulation(simulated, scene.picture.bodies, folder_ + "/frames/{}.ply", 4);
  ASSERT_EQ(report.ways.size(), 2u);
  EXPECT_TRUE(report.ways[0].empty()) << "it stands still";
  EXPECT_EQ(report.ways[1], folder_ + "/frames/a_ball_way.json");
  std::ofstream(folder_ + "/frames/draw.json")
      << scene_of_written_frames(scene_path, folder_ + "/frames", folder_ + "/frames/{}.ply", report);
  const SceneFile drawn = read_scene_file(folder_ + "/frames/draw.json");
  EXPECT_EQ(find_frames(drawn.frames).frames.size(), 4u);
  EXPECT_EQ(*drawn.spacing, 0.05f);
  EXPECT_EQ(drawn.picture.tank_inside->high, scene.picture.tank_inside->high);
  const BodyOptions& ball = drawn.picture.bodies[1];
  ASSERT_EQ(ball.frames.size(), 4u);
  EXPECT_EQ(ball.absent, (std::vector<bool>{true, true, false, false}));
  EXPECT_EQ(ball.frames[3], *simulated.transforms()[1]) << "every digit is kept";
  std::vector<std::string> notes;
  EXPECT_EQ(Bodies(drawn.picture.bodies).at(0, 0, notes).size(), 1u);
  EXPECT_EQ(Bodies(drawn.picture.bodies).at(3, 3, notes).size(), 2u);
}

}  // namespace
}  // namespace meniscus
