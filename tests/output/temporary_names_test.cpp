#include <sys/stat.h>
#include <csignal>
#include <cstdlib>

#include "meniscus/output.h"
#include "output/scratch.h"

namespace meniscus {
namespace {

/// Every kind of file that this stage writes, by its path alone.
using Writer = void (*)(const std::string& path);

constexpr int kSize = 96;

/// Pixels that no coder can shrink much, so that a file is larger than all buffers on its way.
Image<vec3> noise() {
  Image<vec3> picture(kSize, kSize);
  std::uint32_t seed = 1;
  for (vec3& pixel : picture)
    for (int i = 0; i < 3; ++i) {
      seed = seed * 1664525u + 1013904223u;
      pixel[i] = static_cast<float>(seed >> 8) / 16777216.0f;
    }
  return picture;
}

void write_a_png(const std::string& path) { write_png(path, developed(noise(), {})); }

void write_an_exr(const std::string& path) {
  const Image<vec3> picture = noise();
  const std::vector<ExrLayer> layers{{.vector = &picture}};
  write_exr(path, layers);
}

void write_a_film(const std::string& path) {
  VideoWriter writer(path, kSize, kSize, {.quality_crf = 5});
  const Image<Rgb8> picture = developed(noise(), {});
  for (int i = 0; i < 4; ++i) writer.add(picture);
  writer.finish();
}

class EveryWriter : public testing::TestWithParam<Writer> {};
std::string name_of_writer(const testing::TestParamInfo<Writer>& info) {
  const char* names[] = {"Png", "Exr", "Film"};
  return names[info.index];
}
INSTANTIATE_TEST_SUITE_P(Formats, EveryWriter, testing::Values(write_a_png, write_an_exr, write_a_film),
                         name_of_writer);

TEST_P(EveryWriter, LeavesOnlyTheFileItself) {
  const Scratch scratch;
  GetParam()(scratch / "a file");
  EXPECT_EQ(scratch.names(), std::vector<std::string>{"a file"});
}

TEST(StoppedProgram, LeavesNoTemporaryFile) {
  const Scratch scratch;
  EXPECT_EXIT(
      {
        remove_temporary_files_when_stopped();
        const VideoWriter film(scratch / "film.mp4", kSize, kSize, {});
        if (scratch.names().size() != 1) std::exit(1);  // the temporary file is there
        std::raise(SIGTERM);
      },
      testing::KilledBySignal(SIGTERM), "");
  EXPECT_TRUE(scratch.names().empty());
}

TEST_P(EveryWriter, SaysWhyAFileCannotBeMade) {
  const Scratch scratch;
  const std::string missing = scratch / "missing/a.out";
  EXPECT_NE(refusal(ErrorCode::io_failed, missing, [&] { GetParam()(missing); }).find("No such file or directory"),
            std::string::npos);
  write_bytes(scratch / "file", "");
  const std::string below_file = scratch / "file/a.out";
  EXPECT_NE(refusal(ErrorCode::io_failed, below_file, [&] { GetParam()(below_file); }).find("Not a directory"),
            std::string::npos);
  const std::string directory = scratch / "directory";
  std::filesystem::create_directory(directory);
  EXPECT_NE(refusal(ErrorCode::io_failed, directory, [&] { GetParam()(directory); }).find("Is a directory"),
            std::string::npos);
  refusal(ErrorCode::io_failed, directory + "/", [&] { GetParam()(directory + "/"); });
  EXPECT_THROW(GetParam()(""), Error);
  EXPECT_EQ(scratch.names(), (std::vector<std::string>{"directory", "file"}));
  EXPECT_TRUE(std::filesystem::is_empty(directory));
}

TEST_P(EveryWriter, SaysThatADirectoryIsNotWritable) {
  if (geteuid() == 0) GTEST_SKIP() << "nothing is forbidden to root";
  const Scratch scratch;
  const std::string locked = scratch / "locked";
  std::filesystem::create_directory(locked);
  std::filesystem::permissions(locked, std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  const std::string path = locked + "/a.out";
  EXPECT_NE(refusal(ErrorCode::io_failed, path, [&] { GetParam()(path); }).find("Permission denied"),
            std::string::npos);
  std::filesystem::permissions(locked, std::filesystem::perms::owner_all);
}

TEST_P(EveryWriter, LeavesNothingBehindWhenTheDiskIsFull) {
  const Scratch scratch;
  write_bytes(scratch / "a.out", "old");
  // At any moment: at once, in the middle, at the last byte.
  GetParam()(scratch / "whole");
  const std::size_t whole = bytes_of(scratch / "whole").size();
  ASSERT_GT(whole, 8192u);
  for (const std::size_t room : {std::size_t{0}, std::size_t{100}, std::size_t{5000}, whole / 2, whole - 1}) {
    std::string message;
    {
      const FullDisk full(room);
      message = refusal(ErrorCode::io_failed, scratch / "a.out", [&] { GetParam()(scratch / "a.out"); });
    }
    EXPECT_NE(message.find("File too large"), std::string::npos) << message;
    EXPECT_EQ(scratch.names(), (std::vector<std::string>{"a.out", "whole"})) << room;
    EXPECT_EQ(bytes_of(scratch / "a.out"), "old") << room;
  }
}

TEST_P(EveryWriter, NeverReplacesADevice) {
  const Scratch scratch;
  const std::string pipe = scratch / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  refusal(ErrorCode::io_failed, pipe, [&] { GetParam()(pipe); });
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
}

TEST_P(EveryWriter, WritesThroughASymbolicLink) {
  const Scratch scratch;
  std::filesystem::create_directory(scratch / "there");
  write_bytes(scratch / "there/target", "old");
  std::filesystem::create_symlink(scratch / "there/target", scratch / "link");
  GetParam()(scratch / "link");
  EXPECT_TRUE(std::filesystem::is_symlink(scratch / "link"));
  EXPECT_GT(bytes_of(scratch / "there/target").size(), 100u);
}

TEST_P(EveryWriter, TakesTheLongestNameThatAFileCanHave) {
  const Scratch scratch;
  const std::string name(255, 'n');
  GetParam()(scratch / name);
  EXPECT_EQ(scratch.names(), std::vector<std::string>{name});
}

TEST_P(EveryWriter, IsNotStoppedByALeftOverOfTheSameName) {
  const Scratch scratch;
  const std::string left_over = ".a.out.tmp-" + std::to_string(getpid());
  write_bytes(scratch / left_over, "left over");
  GetParam()(scratch / "a.out");
  EXPECT_EQ(scratch.names(), (std::vector<std::string>{left_over, "a.out"}));
  EXPECT_EQ(bytes_of(scratch / left_over), "left over");
}

TEST_P(EveryWriter, WritesIntoTheWorkingDirectory) {
  const Scratch scratch;
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(scratch.path());
  GetParam()("a.out");
  std::filesystem::current_path(before);
  EXPECT_EQ(scratch.names(), std::vector<std::string>{"a.out"});
}

}  // namespace
}  // namespace meniscus
