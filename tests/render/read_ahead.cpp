#include "render/read_ahead.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace meniscus {
namespace {

class Frames {
 public:
  Frames() : directory_(::testing::TempDir() + "read_ahead_" + std::to_string(::getpid())) {
    std::filesystem::create_directories(directory_);
    for (int i = 0; i < 3; ++i) sequence.frames.push_back({directory_ + "/f_" + std::to_string(i) + ".xyz", i, {}, {}});
    for (int i = 0; i < 3; ++i) std::ofstream(sequence.frames[static_cast<std::size_t>(i)].path) << i << " 0 0\n";
  }
  ~Frames() { std::filesystem::remove_all(directory_); }

  FrameSequence sequence;

 private:
  std::string directory_;
};

TEST(ReadAhead, GivesTheFrameThatIsAskedFor) {
  const Frames frames;
  ReadAhead ahead(frames.sequence);
  ahead.begin(frames.sequence.frames[1]);
  EXPECT_EQ(ahead.take(frames.sequence.frames[1])->x[0], 1);
  ahead.begin(frames.sequence.frames[2]);
  EXPECT_EQ(ahead.take(frames.sequence.frames[0])->x[0], 0) << "another one than was begun";
  EXPECT_EQ(ahead.take(frames.sequence.frames[2])->x[0], 2);
}

TEST(ReadAhead, FailsWhenTheDamagedFrameIsTaken) {
  const Frames frames;
  std::ofstream(frames.sequence.frames[1].path) << "0 0 0\nbroken\n";
  ReadAhead ahead(frames.sequence);
  ahead.begin(frames.sequence.frames[1]);
  EXPECT_EQ(ahead.take(frames.sequence.frames[0])->x[0], 0) << "the error is not this one's";
  ahead.begin(frames.sequence.frames[1]);
  EXPECT_THROW(ahead.take(frames.sequence.frames[1]), Error);
  EXPECT_EQ(ahead.take(frames.sequence.frames[2])->x[0], 2) << "and is over with it";
}

TEST(ReadAhead, ReadsInTheBackgroundWhereThreadsAreThere) {
  // The file is changed after it was begun and finished: what was read before is given.
  const Frames frames;
  if (thread_count() < 2) GTEST_SKIP() << "one thread";
  ReadAhead ahead(frames.sequence);
  ahead.begin(frames.sequence.frames[1]);
  ::usleep(300000);
  std::ofstream(frames.sequence.frames[1].path) << "77 0 0\n";
  EXPECT_EQ(ahead.take(frames.sequence.frames[1])->x[0], 1);
}

}  // namespace
}  // namespace meniscus
