#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <glm/gtc/matrix_transform.hpp>

#include "meniscus/render.h"

namespace meniscus {
namespace {

class BodiesTest : public testing::Test {
 protected:
  BodiesTest() { std::filesystem::create_directories(folder_); }
  ~BodiesTest() override { std::filesystem::remove_all(folder_); }
  /// A triangle that reaches as far as `size`.
  std::string triangle(const std::string& name, float size) const {
    const std::string path = folder_ + "/" + name;
    std::ofstream(path) << "v 0 0 0\nv " << size << " 0 0\nv 0 " << size << " 0\nf 1 2 3\n";
    return path;
  }
  const std::string folder_ =
      testing::TempDir() + "/bodies_" + testing::UnitTest::GetInstance()->current_test_info()->name();
  std::vector<std::string> notes_;
};

BodyOptions shape(const std::string& name) {
  BodyOptions body;
  body.shape = name;
  return body;
}
BodyOptions file(const std::string& path) {
  BodyOptions body;
  body.path = path;
  return body;
}

TEST_F(BodiesTest, StandWhereTheyArePlaced) {
  BodyOptions body = shape("box");
  body.world_from_body = glm::translate(glm::mat4(1.0f), {1, 2, 3});
  body.material = SolidMaterial{};
  body.material->roughness = 0.25f;
  const Bodies bodies({body});
  EXPECT_TRUE(bodies.still());
  EXPECT_FALSE(bodies.empty());
  const auto placed = bodies.at(0, 0, notes_);
  ASSERT_EQ(placed.size(), 1u);
  EXPECT_EQ(placed[0].world_from_solid, body.world_from_body);
  EXPECT_EQ(placed[0].material, body.material);
  EXPECT_NEAR(placed[0].solid->bounds().high.x, 0.5f, 1e-6f);
  EXPECT_EQ(bodies.at(7, 70, notes_)[0].solid, placed[0].solid);
  EXPECT_TRUE(notes_.empty());
}

TEST_F(BodiesTest, AreShapesOfOneMetre) {
  for (const char* name : {"box", "sphere", "cylinder"}) {
    const Bounds bounds = Bodies({shape(name)}).at(0, 0, notes_)[0].solid->bounds();
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(bounds.low[axis], -0.5f, 0.01f) << name;
      EXPECT_NEAR(bounds.high[axis], 0.5f, 0.01f) << name;
    }
  }
}

TEST_F(BodiesTest, MoveByTheirFramesAndHoldTheLastOne) {
  BodyOptions body = shape("sphere");
  body.world_from_body = glm::scale(glm::mat4(1.0f), vec3(2));
  for (const float x : {0.0f, 1.0f, 3.0f}) body.frames.push_back(glm::translate(glm::mat4(1.0f), {x, 0, 0}));
  const Bodies bodies({body});
  EXPECT_FALSE(bodies.still());
  // The frame's transform comes first, then the body's own: 3 m along x, doubled.
  EXPECT_EQ(bodies.at(1, 0, notes_)[0].world_from_solid[3].x, 2.0f);
  EXPECT_EQ(bodies.at(2, 0, notes_)[0].world_from_solid[3].x, 6.0f);
  EXPECT_EQ(bodies.at(99, 0, notes_)[0].world_from_solid[3].x, 6.0f);
  body.frames.assign(5, glm::mat4(1.0f));
  EXPECT_TRUE(Bodies({body}).still());
}

TEST_F(BodiesTest, OfOneFileAreReadOnce) {
  const std::string path = triangle("rock.obj", 2);
  const Bodies bodies({file(path), file(path)});
  std::filesystem::remove(path);
  const auto placed = bodies.at(3, 3, notes_);
  ASSERT_EQ(placed.size(), 2u);
  EXPECT_EQ(placed[0].solid, placed[1].solid);
  EXPECT_EQ(placed[0].solid->bounds().high.x, 2);
}

TEST_F(BodiesTest, OfAFileAFrameAreReadAsTheyCome) {
  triangle("rb_1_0003.obj", 3);
  triangle("rb_1_0004.obj", 4);
  const Bodies bodies({file(folder_ + "/rb_1_{:04}.obj")});
  EXPECT_FALSE(bodies.still());
  EXPECT_EQ(bodies.at(0, 3, notes_)[0].solid->bounds().high.x, 3);
  const auto fourth = bodies.at(1, 4, notes_);
  EXPECT_EQ(fourth[0].solid->bounds().high.x, 4);
  EXPECT_EQ(bodies.at(1, 4, notes_)[0].solid, fourth[0].solid);
  EXPECT_TRUE(notes_.empty());
}

TEST_F(BodiesTest, WithoutAFileForAFrameAreLeftOutAndSaidSo) {
  triangle("rb_8.obj", 1);
  const Bodies bodies({file(folder_ + "/rb_{}.obj"), shape("box")});
  EXPECT_EQ(bodies.at(0, 8, notes_).size(), 2u);
  EXPECT_TRUE(notes_.empty());
  EXPECT_EQ(bodies.at(1, 9, notes_).size(), 1u);
  ASSERT_EQ(notes_.size(), 1u);
  EXPECT_NE(notes_[0].find("rb_9.obj"), std::string::npos);
  EXPECT_EQ(bodies.at(2, 8, notes_).size(), 2u);
}

TEST_F(BodiesTest, RefuseWhatIsNoBody) {
  const auto code_of = [](const BodyOptions& body) {
    try {
      Bodies bodies({body});
    } catch (const Error& error) {
      return error.code();
    }
    return ErrorCode::io_failed;
  };
  EXPECT_EQ(code_of({}), ErrorCode::invalid_argument);
  EXPECT_EQ(code_of(shape("cone")), ErrorCode::invalid_argument);
  BodyOptions both = shape("box");
  both.path = "x.obj";
  EXPECT_EQ(code_of(both), ErrorCode::invalid_argument);
  EXPECT_EQ(code_of(file("rb_{:x}.obj")), ErrorCode::invalid_argument);
  EXPECT_EQ(code_of(file(folder_ + "/none.obj")), ErrorCode::not_found);
  EXPECT_TRUE(Bodies({}).empty());
  EXPECT_TRUE(Bodies({}).still());
}

}  // namespace
}  // namespace meniscus
