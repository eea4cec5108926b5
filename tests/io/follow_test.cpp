// Frames of a simulation that is still running.
#include <chrono>
#include <thread>

#include "small_frames.h"

namespace meniscus {
namespace {

constexpr double kSettle = 0.15;

FrameFollower::Options quick() {
  FrameFollower::Options options;
  options.settle = kSettle;
  options.poll = 0.01;
  options.patience = 0.4;
  options.end_after = 0.5;
  return options;
}

/// For what comes: a slow machine may take its time.
FrameFollower::Options patient() {
  FrameFollower::Options options = quick();
  options.settle = 3 * kSettle;
  options.patience = options.end_after.emplace(20);
  return options;
}

void sleep(double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }

TEST(FrameFollower, WaitsForTheFirstFrame) {
  const Scratch scratch;
  FrameFollower follower({scratch.path("in_{}.xyz")}, {}, patient());
  std::thread writer([&] {
    sleep(0.1);
    scratch.write("in_1.xyz", "0 0 0\n");
  });
  // Its directory may come later, too.
  const FrameSequence first = follower.first();
  writer.join();
  ASSERT_EQ(first.frames.size(), 1u);
  EXPECT_EQ(first.frames[0].number, 1);
}

TEST(FrameFollower, GivesAFrameOnceItIsWhole) {
  const Scratch scratch;
  scratch.write("in/f_1.xyz", "0 0 0\n");
  FrameFollower follower({scratch.path("in")}, {}, patient());
  ASSERT_EQ(follower.first().frames.size(), 1u);
  std::thread writer([&] {
    std::ofstream file(scratch.path("in/f_2.xyz"));
    for (int row = 0; row < 12; ++row) {
      file << row << " 0 0\n" << std::flush;
      sleep(0.03);
    }
  });
  const std::vector<FramePath> second = follower.further();
  const std::size_t rows = second.empty() ? 0 : read_particles(second[0].path).size();
  writer.join();
  ASSERT_EQ(second.size(), 1u);
  EXPECT_EQ(rows, 12u);
}

TEST(FrameFollower, GivesEachFrameOnceAndInOrder) {
  const Scratch scratch;
  for (const int number : {1, 2, 10}) scratch.write("f_" + std::to_string(number) + ".xyz", "0 0 0\n");
  sleep(2 * kSettle);
  FrameFollower::Options options = quick();
  options.end_after = 3;
  FrameFollower follower({scratch.path("f_{}.xyz")}, {}, options);
  const FrameSequence first = follower.first();
  ASSERT_EQ(first.frames.size(), 3u);
  EXPECT_EQ(first.frames[2].number, 10);
  scratch.write("f_11.xyz", "0 0 0\n");
  const std::vector<FramePath> more = follower.further();
  ASSERT_EQ(more.size(), 1u);
  EXPECT_EQ(more[0].number, 11);
  EXPECT_EQ(more[0].place, 3u);
  EXPECT_TRUE(follower.further().empty()) << "nothing comes any more";
}

TEST(FrameFollower, EndsWhenItIsStopped) {
  const Scratch scratch;
  FrameFollower::Options options = quick();
  options.end_after.reset();
  options.stopped = [] { return true; };
  FrameFollower follower({scratch.path("f_{}.xyz")}, {}, options);
  EXPECT_TRUE(follower.further().empty());
  try {
    follower.first();
    ADD_FAILURE() << "there is no frame";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::not_found);
  }
}

TEST(FrameFollower, WaitsForADamagedFileToChange) {
  const Scratch scratch;
  const FramePath frame{scratch.write("f_1.bgeo", small_bgeo().substr(0, 100)), 1, {}, {}};
  FrameFollower follower({frame.path}, {}, quick());
  EXPECT_FALSE(follower.wait_for_change(frame)) << "it stays as it is";
  FrameFollower longer({frame.path}, {}, patient());
  std::thread writer([&] {
    sleep(0.1);
    scratch.write("f_1.bgeo", small_bgeo());
  });
  EXPECT_TRUE(longer.wait_for_change(frame));
  writer.join();
  expect_small(read_particles(frame.path));
}

TEST(FrameFollower, GivesFramesThatShareAFileAndWaitsForAllOfTheirs) {
  const Scratch scratch;
  std::string list = "<VTKFile type=\"Collection\"><Collection>";
  for (int time = 0; time < 2; ++time) {
    scratch.write("water_m_" + std::to_string(time) + ".xyz", "1 0 0\n");
    const std::string at = "<DataSet timestep=\"" + std::to_string(time) + "\" group=\"g\" part=\"";
    list += at + "0\" file=\"water_static.xyz\"/>" + at + "1\" file=\"water_m_" + std::to_string(time) + ".xyz\"/>";
  }
  scratch.write("water_static.xyz", "0 0 0\n");
  const std::string path = scratch.write("a.pvd", list + "</Collection></VTKFile>");
  sleep(6 * kSettle);
  FrameFollower follower({path}, {}, patient());
  scratch.write("water_m_1.xyz", "1 0 0\n2 0 0\n");  // begins to settle once more
  const FrameSequence first = follower.first();
  ASSERT_EQ(first.frames.size(), 1u);
  ASSERT_EQ(first.frames[0].further.size(), 1u);
  const std::vector<FramePath> more = follower.further();
  ASSERT_EQ(more.size(), 1u);
  EXPECT_EQ(more[0].path, first.frames[0].path);
  EXPECT_NE(more[0].further, first.frames[0].further);

  std::thread writer([&] {
    sleep(0.1);
    scratch.write("water_m_1.xyz", "1 0 0\n2 0 0\n3 0 0\n");
  });
  EXPECT_TRUE(follower.wait_for_change(more[0]));
  writer.join();
}

}  // namespace
}  // namespace meniscus
