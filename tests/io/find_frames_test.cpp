#include <algorithm>

#include "io/frame_name.h"
#include "meniscus/io.h"
#include "scratch.h"

namespace meniscus {
namespace {

using Names = std::vector<std::string>;

const std::string kRow = "1 2 3\n";

FrameSequence found(std::vector<std::string> arguments) { return find_frames(arguments); }

Names names_of(const FrameSequence& sequence) {
  Names names;
  for (const FramePath& frame : sequence.frames) names.push_back(std::filesystem::path(frame.path).filename().string());
  return names;
}

bool notes_have(const FrameSequence& sequence, const std::string& text) {
  return std::any_of(sequence.notes.begin(), sequence.notes.end(),
                     [&](const std::string& note) { return note.find(text) != std::string::npos; });
}

ErrorCode code_of(std::vector<std::string> arguments) {
  try {
    find_frames(arguments);
  } catch (const Error& error) {
    return error.code();
  }
  ADD_FAILURE() << arguments[0] << " names something";
  return ErrorCode::invalid_argument;
}

TEST(NaturalOrder, ComparesDigitsAsNumbers) {
  Names names{"f10.vtk", "f9.vtk", "f009b.vtk", "f1.vtk", "f99999999999999999999.vtk", "f100000000000000000000.vtk",
              "e.vtk",   "f.vtk"};
  std::sort(names.begin(), names.end(), io::natural_less);
  EXPECT_EQ(names, (Names{"e.vtk", "f.vtk", "f1.vtk", "f9.vtk", "f009b.vtk", "f10.vtk", "f99999999999999999999.vtk",
                          "f100000000000000000000.vtk"}));
}

TEST(NaturalOrder, IsStrict) {
  for (const char* name : {"", "a", "1", "01", "a1b02"}) EXPECT_FALSE(io::natural_less(name, name));
  EXPECT_NE(io::natural_less("f1", "f01"), io::natural_less("f01", "f1"));
}

TEST(FindFrames, OfADirectoryComeInNaturalOrderWithNumbers) {
  const Scratch scratch;
  for (const int i : {1, 2, 9, 10, 11, 3, 4, 5, 6, 7, 8, 100}) scratch.write("d/f_" + std::to_string(i) + ".xyz", kRow);
  const FrameSequence sequence = found({scratch.path("d")});
  ASSERT_EQ(sequence.frames.size(), 12u);
  EXPECT_EQ(names_of(sequence)[9], "f_10.xyz");
  EXPECT_EQ(sequence.frames[9].number, 10);
  EXPECT_EQ(sequence.frames[11].number, 100);
  EXPECT_EQ(names_of(found({scratch.path("d") + "/"})), names_of(sequence));
}

TEST(FindFrames, NotesNumbersThatAreMissing) {
  const Scratch scratch;
  for (const int i : {0, 90, 180, 360, 450, 810}) scratch.write("d/dam_break_3d_" + std::to_string(i) + ".vtk", kRow);
  const FrameSequence sequence = found({scratch.path("d")});
  EXPECT_EQ(sequence.frames.size(), 6u);
  ASSERT_EQ(sequence.notes.size(), 1u);
  EXPECT_EQ(sequence.notes[0], "4 frames are missing (frames come every 90): 270, 540, 630, 720");
  std::filesystem::remove(scratch.path("d/dam_break_3d_810.vtk"));
  EXPECT_EQ(found({scratch.path("d")}).notes, (Names{"frame 270 is missing (frames come every 90)"}));
}

TEST(FindFrames, SaysNothingOfNumbersWithoutARule) {
  const Scratch scratch;
  for (const int i : {1, 5, 9, 10, 15, 20, 30, 40}) scratch.write("d/f_" + std::to_string(i) + ".vtk", kRow);
  EXPECT_TRUE(found({scratch.path("d")}).notes.empty());
}

TEST(FindFrames, TakesTheWaterAmongSeveralSeriesAndNotesTheRest) {
  const Scratch scratch;
  for (int i = 1; i <= 12; ++i) {
    const std::string n = std::to_string(i);
    scratch.write("d/ParticleData_Fluid_" + n + ".bgeo", kRow);
    scratch.write("d/foam_" + n + "_spray.bgeo", std::string(5000, ' '));
    scratch.write("d/foam_" + n + "_bubbles.bgeo", std::string(5000, ' '));
    scratch.write("d/rb_data_1_" + n + ".obj", std::string(9000, ' '));
    scratch.write("d/rb_data_" + n + ".bin", std::string(9000, ' '));
  }
  scratch.write("d/README.txt", "The frames of a run.\n");
  const FrameSequence sequence = found({scratch.path("d")});
  ASSERT_EQ(sequence.frames.size(), 12u);
  EXPECT_EQ(names_of(sequence)[11], "ParticleData_Fluid_12.bgeo");
  EXPECT_EQ(sequence.frames[11].number, 12);
  EXPECT_TRUE(notes_have(sequence, "foam_{}_spray.bgeo (12)"));
  EXPECT_FALSE(notes_have(sequence, "README"));
  EXPECT_FALSE(notes_have(sequence, ".obj"));
}

TEST(FindFrames, TakesTheLargerFilesWhereNamesDoNotTell) {
  const Scratch scratch;
  for (int i = 1; i <= 3; ++i) {
    scratch.write("d/a_" + std::to_string(i) + ".vtk", kRow);
    scratch.write("d/b_" + std::to_string(i) + ".vtk", kRow + kRow);
    scratch.write("d/boundary_" + std::to_string(i) + ".vtk", kRow + kRow + kRow);
  }
  EXPECT_EQ(names_of(found({scratch.path("d")})), (Names{"b_1.vtk", "b_2.vtk", "b_3.vtk"}));
}

TEST(FindFrames, TakesOneOfTwoFormatsOfTheSameFrames) {
  const Scratch scratch;
  for (const int i : {1, 5, 9}) {
    scratch.write("d/fluid_" + std::to_string(i) + ".bgeo", kRow);
    scratch.write("d/fluid_" + std::to_string(i) + ".vtk", kRow + kRow);
  }
  FrameSequence sequence = found({scratch.path("d")});
  EXPECT_EQ(names_of(sequence), (Names{"fluid_1.bgeo", "fluid_5.bgeo", "fluid_9.bgeo"}));
  EXPECT_TRUE(notes_have(sequence, "fluid_{}.vtk (3)"));
  scratch.write("d/fluid_13.vtk", kRow);
  EXPECT_EQ(found({scratch.path("d")}).frames.size(), 4u);
}

TEST(FindFrames, KnowsWhichOfSeveralNumbersIsTheFrame) {
  const Scratch scratch;
  for (int body = 1; body <= 2; ++body) {
    for (int i = 1; i <= 4; ++i) {
      scratch.write("a/run_" + std::to_string(body) + "_" + std::to_string(i) + ".vtk",
                    std::string(static_cast<std::size_t>(body), ' '));
    }
  }
  const FrameSequence sequence = found({scratch.path("a")});
  EXPECT_EQ(names_of(sequence), (Names{"run_2_1.vtk", "run_2_2.vtk", "run_2_3.vtk", "run_2_4.vtk"}));
  EXPECT_TRUE(notes_have(sequence, "run_1_{}.vtk (4)"));
  // A number of particles that changes with the frame makes no series of its own.
  for (const char* name : {"frame_9_6859_particles.vtk", "frame_10_6700_particles.vtk", "frame_8_7001_particles.vtk"}) {
    scratch.write(std::string("b/") + name, kRow);
  }
  const FrameSequence counted = found({scratch.path("b")});
  EXPECT_EQ(names_of(counted)[2], "frame_10_6700_particles.vtk");
  EXPECT_EQ(counted.frames[2].number, 10);
}

TEST(FindFrames, OfOneFileKnowsItsNumber) {
  const Scratch scratch;
  EXPECT_EQ(found({scratch.write("dam_break_3d_00090.hdf5", "")}).frames[0].number, 90);
  EXPECT_EQ(found({scratch.write("dam_break_3d.hdf5", "")}).frames[0].number, std::nullopt);
  EXPECT_EQ(found({scratch.write("Case_Dp0.02_Fluid.csv", "")}).frames[0].number, std::nullopt);
  EXPECT_EQ(found({scratch.write("sim.0012.vtk.gz", "")}).frames[0].number, 12);
  EXPECT_EQ(found({scratch.write("123456789012345678901234.vtk", "")}).frames[0].number, std::nullopt);
}

TEST(FindFrames, TakesFilesWithoutNumbersOneByOne) {
  const Scratch scratch;
  for (const char* name : {"d/splash.ply", "d/calm.ply", "d/pour.ply"}) scratch.write(name, kRow);
  EXPECT_EQ(names_of(found({scratch.path("d")})), (Names{"calm.ply", "pour.ply", "splash.ply"}));
}

TEST(FindFrames, PutsFilesOfOneSeriesIntoNaturalOrder) {
  const Scratch scratch;
  std::vector<std::string> paths;
  for (const int i : {1, 10, 2, 3}) paths.push_back(scratch.write("f_" + std::to_string(i) + ".vtk", kRow));
  EXPECT_EQ(names_of(find_frames(paths)), (Names{"f_1.vtk", "f_2.vtk", "f_3.vtk", "f_10.vtk"}));
  // Backwards is meant so.
  EXPECT_EQ(names_of(found({paths[1], paths[3], paths[2]})), (Names{"f_10.vtk", "f_3.vtk", "f_2.vtk"}));
  // Different names keep the order given.
  const std::string other = scratch.write("a.vtk", kRow);
  EXPECT_EQ(names_of(found({paths[0], other})), (Names{"f_1.vtk", "a.vtk"}));
}

TEST(FindFrames, ExpandsWildcardsAndBraces) {
  const Scratch scratch;
  for (const int i : {1, 2, 10}) scratch.write("d/f_" + std::to_string(i) + ".vtk", kRow);
  scratch.write("d/f_x.vtk", kRow);
  scratch.write("d/f_.vtk", kRow);
  scratch.write("d/f_1.obj", kRow);
  const Names three{"f_1.vtk", "f_2.vtk", "f_10.vtk"};
  EXPECT_EQ(names_of(found({scratch.path("d/f_{}.vtk")})), three);
  EXPECT_EQ(names_of(found({scratch.path("d/f_[0-9]*")})), three);
  EXPECT_EQ(names_of(found({scratch.path("d/f_?.vtk")})), (Names{"f_1.vtk", "f_2.vtk"}));
  EXPECT_EQ(found({scratch.path("d/f_{}.vtk")}).frames[2].number, 10);
  EXPECT_EQ(found({scratch.path("d/f_{}.vtk"), scratch.path("d/f_x.vtk")}).frames.size(), 4u);
}

TEST(FindFrames, TakesPatternsWithAWidth) {
  const Scratch scratch;
  for (const char* n : {"0001", "0002", "12345"}) scratch.write(std::string("d/p_") + n + ".xyz", kRow);
  for (const char* pattern : {"d/p_{:04}.xyz", "d/p_{:04d}.xyz"})
    EXPECT_EQ(found({scratch.path(pattern)}).frames.size(), 3u) << pattern;
  EXPECT_THROW(found({scratch.path("d/p_{:x}.xyz")}), Error);
}

TEST(FindFrames, ExpandsBracesInTheNameOfADirectory) {
  const Scratch scratch;
  for (const int i : {2, 10, 1}) scratch.write("step_" + std::to_string(i) + "/water.vtk", kRow);
  std::filesystem::create_directories(scratch.path("step_3"));
  const FrameSequence sequence = found({scratch.path("step_{}/water.vtk")});
  ASSERT_EQ(sequence.frames.size(), 3u);
  EXPECT_EQ(sequence.frames[2].path, scratch.path("step_10/water.vtk"));
  EXPECT_EQ(sequence.frames[2].number, 10);
}

TEST(FindFrames, TakesANameThatExistsAsItIs) {
  const Scratch scratch;
  const std::string path = scratch.write("odd[1]*{}.vtk", kRow);
  EXPECT_EQ(found({path}).frames[0].path, path);
}

TEST(FindFrames, RefusesArgumentsThatNameNothing) {
  const Scratch scratch;
  std::filesystem::create_directories(scratch.path("empty"));
  scratch.write("other/body.obj", "v 0 0 0\n");
  scratch.write("text/README.txt", "words only\n");
  for (const char* name :
       {"empty", "other", "text", "absent", "absent/f_{}.vtk", "absent*", "other/f_{}.vtk", "other/*.obj"}) {
    EXPECT_EQ(code_of({scratch.path(name)}), ErrorCode::not_found) << name;
  }
  EXPECT_EQ(code_of({""}), ErrorCode::not_found);
  EXPECT_THROW(find_frames({}), Error);
  EXPECT_EQ(code_of({scratch.path("a_{}_{}.vtk")}), ErrorCode::invalid_argument);
}

TEST(FindFrames, PointsToTheDirectoryBelowThatHasFrames) {
  const Scratch scratch;
  scratch.write("out/vtk/f_1.vtk", kRow);
  try {
    found({scratch.path("out")});
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(error.detail().advice.find(scratch.path("out/vtk")), std::string::npos);
  }
}

}  // namespace
}  // namespace meniscus
