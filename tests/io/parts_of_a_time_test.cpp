// Lists of frames (.pvd) that name several files of one time.
#include <fmt/format.h>

#include "damage.h"

namespace meniscus {
namespace {

/// A frame of one particle at x.
std::string frame_at(int x, const std::string& arrays = {}) {
  return fmt::format("# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 1 float\n{} 2 3\n{}", x, arrays);
}
const std::string kVelocity = "POINT_DATA 1\nVECTORS velocity float\n1 2 3\n";

std::string set(const std::string& time, const std::string& part, const std::string& file,
                const std::string& group = {}) {
  return fmt::format("<DataSet timestep=\"{}\" group=\"{}\" part=\"{}\" file=\"{}\"/>\n", time, group, part, file);
}

std::string collection(const std::string& sets) {
  return "<VTKFile type=\"Collection\"><Collection>\n" + sets + "</Collection></VTKFile>\n";
}

FrameSequence found(const std::string& path) { return find_frames(std::vector<std::string>{path}); }

bool notes_have(const FrameSequence& sequence, const std::string& text) {
  return std::any_of(sequence.notes.begin(), sequence.notes.end(),
                     [&](const std::string& note) { return note.find(text) != std::string::npos; });
}

TEST(PartsOfATime, ThatDifferInNumbersAreOneFrame) {
  const Scratch scratch;
  std::string by_time, by_part;
  for (const int time : {0, 1})
    for (const int part : {0, 1, 2})
      scratch.write(fmt::format("f_{}_{}.vtk", time, part), frame_at(10 * time + part, kVelocity));
  for (const int time : {0, 1})
    for (const int part : {0, 1, 2})
      by_time += set(fmt::format("{}.5", time), std::to_string(part), fmt::format("f_{}_{}.vtk", time, part));
  for (const int part : {0, 1, 2})
    for (const int time : {0, 1})
      by_part += set(fmt::format("{}.5", time), std::to_string(part), fmt::format("f_{}_{}.vtk", time, part));
  for (const std::string& sets : {by_time, by_part}) {
    const FrameSequence sequence = found(scratch.write("f.pvd", collection(sets)));
    ASSERT_EQ(sequence.frames.size(), 2u);
    EXPECT_TRUE(sequence.notes.empty());
    EXPECT_EQ(sequence.frames[1].further.size(), 2u);
    const Particles particles = read_frame(sequence, sequence.frames[1]);
    EXPECT_EQ(particles.x, (std::vector<float>{10, 11, 12}));
    EXPECT_EQ(particles.time, 1.5);
    ASSERT_NE(particles.find("velocity"), nullptr);
    EXPECT_EQ(particles.find("velocity")->values.size(), 9u);
  }
}

TEST(PartsOfATime, OfTheWaterAreJoinedAndOfOtherThingsLeftOut) {
  const Scratch scratch;
  std::string sets;
  int part = 0;
  for (const char* name : {"boundary.vtk", "fluid_0.vtk", "fluid_1.vtk", "thing.vtk"}) {
    scratch.write(name, frame_at(part));
    sets += set("0", std::to_string(part++), name);
  }
  const FrameSequence sequence = found(scratch.write("f.pvd", collection(sets)));
  ASSERT_EQ(sequence.frames.size(), 1u);
  EXPECT_EQ(read_frame(sequence, sequence.frames[0]).x, (std::vector<float>{1, 2}));
  EXPECT_TRUE(notes_have(sequence, "took the 2 of"));
  EXPECT_TRUE(notes_have(sequence, "boundary.vtk"));
  EXPECT_TRUE(notes_have(sequence, "thing.vtk"));
}

TEST(PartsOfATime, OfOtherNamesAreJoinedWhereTheirValuesAreTheSame) {
  const Scratch scratch;
  scratch.write("left.vtk", frame_at(1, kVelocity) + std::string(500, '\n'));
  scratch.write("right.vtk", frame_at(2, kVelocity) + std::string(500, '\n'));
  scratch.write("body.vtk", frame_at(3) + std::string(9, '\n'));
  const auto sizes = [&](const std::string& other, const std::string& group) {
    const std::string sets = set("0", "0", "left.vtk") + set("0", "1", other, group);
    return 1 + found(scratch.write("f.pvd", collection(sets))).frames.at(0).further.size();
  };
  EXPECT_EQ(sizes("right.vtk", ""), 2u);
  EXPECT_EQ(sizes("body.vtk", ""), 1u);
  EXPECT_EQ(sizes("right.vtk", "1"), 1u) << "another group is another thing";
}

TEST(PartsOfATime, OfWhichOneIsMissingLeaveOutTheFrame) {
  const Scratch scratch;
  for (const char* name : {"f_0_0.vtk", "f_0_1.vtk", "f_1_0.vtk"}) scratch.write(name, frame_at(1));
  const FrameSequence sequence =
      found(scratch.write("f.pvd", collection(set("0", "0", "f_0_0.vtk") + set("0", "1", "f_0_1.vtk") +
                                              set("1", "0", "f_1_0.vtk") + set("1", "1", "f_1_1.vtk"))));
  ASSERT_EQ(sequence.frames.size(), 1u);
  EXPECT_EQ(sequence.frames[0].time, 0.0);
  EXPECT_TRUE(notes_have(sequence, "f_1_1.vtk"));
}

TEST(PartsOfATime, KeepTheFluidOfAllTogether) {
  const Scratch scratch;
  scratch.write("f_0.csv", "x,y,z,Type\n1,2,3,0\n4,5,6,1\n");  // boundaries alone
  scratch.write("f_1.csv", "x,y,z,Type\n7,8,9,3\nnan,0,0,3\n1,1,1,0\n");
  const std::string list = scratch.write("f.pvd", collection(set("0", "0", "f_0.csv") + set("0", "1", "f_1.csv")));
  FrameSequence sequence = found(list);
  const Particles particles = read_frame(sequence, sequence.frames[0]);
  EXPECT_EQ(particles.x, (std::vector<float>{7}));
  EXPECT_EQ(particles.dropped_non_finite, 1u);
  sequence.reading.boundaries = true;
  EXPECT_EQ(read_frame(sequence, sequence.frames[0]).size(), 4u);
  sequence.reading.where = "Type<2 && x<2";
  sequence.reading.scale = 0.5;
  EXPECT_EQ(read_frame(sequence, sequence.frames[0]).x, (std::vector<float>{0.5f, 0.5f}));
}

TEST(PartsOfATime, FarFromZeroAreCountedFromOneOrigin) {
  const Scratch scratch;
  scratch.write("f_0.csv", "x,y,z\n500000.001,0,0\n500000.002,0,0\n");
  scratch.write("f_1.csv", "x,y,z\n500001.003,0,0\n500002.004,0,0\n500003.005,0,0\n");
  const FrameSequence sequence =
      found(scratch.write("f.pvd", collection(set("0", "0", "f_0.csv") + set("0", "1", "f_1.csv"))));
  const Particles particles = read_frame(sequence, sequence.frames[0]);
  ASSERT_EQ(particles.size(), 5u);
  EXPECT_NEAR(static_cast<double>(particles.x[0]) + particles.origin.x, 500000.001, 1e-6);
  EXPECT_NEAR(static_cast<double>(particles.x[4]) + particles.origin.x, 500003.005, 1e-6);
}

TEST(PartsOfATime, ThatADamagedFileHoldsRefuseTheFrame) {
  const Scratch scratch;
  scratch.write("f_0.vtk", frame_at(1));
  const std::string damaged = scratch.write("f_1.vtk", "# vtk DataFile Version 3.0\nt\nASCII\n");
  const FrameSequence sequence =
      found(scratch.write("f.pvd", collection(set("0", "0", "f_0.vtk") + set("0", "1", "f_1.vtk"))));
  try {
    read_frame(sequence, sequence.frames[0]);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.detail().path, damaged);
  }
}

TEST(ListInADirectory, GivesTimesIfItNamesAllFrames) {
  const Scratch scratch;
  std::string sets;
  for (const int i : {0, 1, 2}) {
    scratch.write(fmt::format("d/f_{}.vtk", i), frame_at(i));
    sets += set(fmt::format("{}.25", i), "0", fmt::format("./f_{}.vtk", i));
  }
  scratch.write("d/f.pvd", collection(sets));
  const FrameSequence sequence = found(scratch.path("d"));
  ASSERT_EQ(sequence.frames.size(), 3u);
  EXPECT_EQ(sequence.frames[2].time, 2.25);
  // One that is older than the frames, a damaged one, one of more than the water: the frames as they are.
  const std::string short_one = sets.substr(0, sets.find("<DataSet", 9));
  const std::string more = sets + set("9", "0", "foam_0.vtk");
  scratch.write("d/foam_0.vtk", frame_at(9));
  for (const std::string& text : {collection(short_one), std::string("<VTKFile"), collection(more)}) {
    scratch.write("d/f.pvd", text);
    const FrameSequence plain = found(scratch.path("d"));
    ASSERT_EQ(plain.frames.size(), 3u);
    EXPECT_FALSE(plain.frames[2].time);
  }
}

TEST(ListInADirectory, JoinsTheParts) {
  const Scratch scratch;
  std::string sets;
  for (const int time : {0, 1, 2})
    for (const int part : {0, 1}) {
      const std::string name = fmt::format("f_{}_{}.vtk", part, time);
      scratch.write("d/" + name, frame_at(part));
      sets += set(std::to_string(time), std::to_string(part), name);
    }
  scratch.write("d/f.pvd", collection(sets));
  const FrameSequence sequence = found(scratch.path("d"));
  ASSERT_EQ(sequence.frames.size(), 3u);
  EXPECT_EQ(read_frame(sequence, sequence.frames[2]).x, (std::vector<float>{0, 1}));
  EXPECT_TRUE(notes_have(sequence, "f.pvd' lists"));
  EXPECT_FALSE(notes_have(sequence, "left out"));
}

}  // namespace
}  // namespace meniscus
