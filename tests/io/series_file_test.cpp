#include "io/series_file.h"

#include <fmt/format.h>

#include <algorithm>

#include "scratch.h"

namespace meniscus {
namespace {

const std::string kFrame = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 1 float\n1 2 3\n";

std::string collection(const std::string& sets) {
  return "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
         "<Collection>\n" +
         sets + "</Collection>\n</VTKFile>\n";
}

std::string set(const std::string& time, const std::string& file, const std::string& part = "0") {
  return fmt::format("<DataSet timestep=\"{}\" group=\"\" part=\"{}\" file=\"{}\"/>\n", time, part, file);
}

FrameSequence found(const std::string& path, bool allow_outside = false) {
  ReadOptions options;
  options.allow_outside = allow_outside;
  return find_frames(std::vector<std::string>{path}, options);
}

Error refused_series(const std::string& path) {
  try {
    found(path);
  } catch (const Error& error) {
    EXPECT_EQ(error.detail().path, path);
    return error;
  }
  ADD_FAILURE() << path << " was read";
  return {ErrorCode::io_failed, "nothing was thrown"};
}

bool notes_have(const FrameSequence& sequence, const std::string& text) {
  return std::any_of(sequence.notes.begin(), sequence.notes.end(),
                     [&](const std::string& note) { return note.find(text) != std::string::npos; });
}

TEST(SeriesFile, GivesFramesInItsOrderWithTimesAndNumbers) {
  const Scratch scratch;
  for (const int i : {1, 2, 10}) scratch.write("d/f_" + std::to_string(i) + ".vtk", kFrame);
  const std::string pvd =
      scratch.write("d/f.pvd", collection(set("0.5", "f_2.vtk") + set("0.25", "./f_1.vtk") + set(" 1e0 ", "f_10.vtk")));
  const std::string json = scratch.write("d/f.vtk.series",
                                         "{\"file-series-version\": \"1.0\", \"files\": [{\"name\": \"f_2.vtk\", "
                                         "\"time\": 0.5}, {\"name\": \"./f_1.vtk\", \"time\": 0.25}, "
                                         "{\"time\": 1, \"name\": \"f_10.vtk\"}]}");
  for (const std::string& path : {pvd, json}) {
    const FrameSequence sequence = found(path);
    ASSERT_EQ(sequence.frames.size(), 3u) << path;
    EXPECT_EQ(sequence.frames[0].time, 0.5);
    EXPECT_EQ(sequence.frames[1].time, 0.25);
    EXPECT_EQ(sequence.frames[2].time, 1.0);
    EXPECT_EQ(sequence.frames[2].number, 10);
    EXPECT_TRUE(sequence.notes.empty());
    EXPECT_EQ(read_frame(sequence, sequence.frames[1]).time, 0.25);
    EXPECT_EQ(read_frame(sequence, sequence.frames[1]).position(0), vec3(1, 2, 3));
  }
}

TEST(SeriesFile, WithoutTimesOrWithLineEndsAndAMarkIsRead) {
  const Scratch scratch;
  scratch.write("a.vtk", kFrame);
  EXPECT_EQ(found(scratch.write("f.pvd", "\xef\xbb\xbf" + collection("<DataSet file=\"a.vtk\"/>\r\n"))).frames[0].time,
            std::nullopt);
  EXPECT_EQ(found(scratch.write("f.vtk.series",
                                "\xef\xbb\xbf{\r\n\"file-series-version\":\"1.0\",\"files\":[{\"name\":\"a.vtk\"}]}"))
                .frames[0]
                .time,
            std::nullopt);
}

TEST(SeriesFile, TakesTheWaterAmongSeveralPartsOfATime) {
  const Scratch scratch;
  std::string sets;
  for (const int i : {0, 1}) {
    for (const auto& [part, name] : {std::pair("0", "boundary_{}.vtk"), std::pair("1", "fluid_{}.vtk")}) {
      const std::string file = fmt::format(fmt::runtime(name), i);
      scratch.write(file, kFrame + std::string(part == std::string("0") ? 500 : 0, '\n'));
      sets += set(std::to_string(i), file, part);
    }
  }
  const FrameSequence sequence = found(scratch.write("f.pvd", collection(sets)));
  ASSERT_EQ(sequence.frames.size(), 2u);
  EXPECT_EQ(sequence.frames[1].path, scratch.path("fluid_1.vtk"));
  EXPECT_TRUE(notes_have(sequence, "boundary_0.vtk"));
}

TEST(SeriesFile, TakesPartsThatFollowEachOtherAsOneRun) {
  const Scratch scratch;
  for (const int i : {0, 1}) scratch.write(fmt::format("f_{}.vtk", i), kFrame);
  EXPECT_EQ(
      found(scratch.write("f.pvd", collection(set("0", "f_0.vtk", "0") + set("1", "f_1.vtk", "1")))).frames.size(), 2u);
}

TEST(SeriesFile, NotesFilesThatAreMissing) {
  const Scratch scratch;
  scratch.write("a.vtk", kFrame);
  const FrameSequence sequence =
      found(scratch.write("f.pvd", collection(set("0", "a.vtk") + set("1", "gone.vtk") + set("2", "lost.vtk"))));
  EXPECT_EQ(sequence.frames.size(), 1u);
  EXPECT_TRUE(notes_have(sequence, "gone.vtk, lost.vtk"));
  EXPECT_EQ(refused_series(scratch.write("g.pvd", collection(set("0", "gone.vtk")))).code(), ErrorCode::not_found);
  EXPECT_EQ(refused_series(scratch.write("h.pvd", collection(""))).code(), ErrorCode::not_found);
}

TEST(SeriesFile, LeavesItsDirectoryOnlyWhereThatIsAllowed) {
  const Scratch scratch;
  const std::string outside = scratch.write("a.vtk", kFrame);
  scratch.write("d/a.vtk", kFrame);
  for (const std::string& name : {std::string("../a.vtk"), outside, std::string("../d/../a.vtk")}) {
    const std::string path = scratch.write("d/f.pvd", collection(set("0", name)));
    EXPECT_EQ(refused_series(path).code(), ErrorCode::invalid_argument) << name;
    EXPECT_EQ(found(path, true).frames.size(), 1u) << name;
  }
  EXPECT_EQ(found(scratch.write("d/f.pvd", collection(set("0", "../d/a.vtk")))).frames.size(), 1u);
}

TEST(SeriesFile, NamesNoOtherSeries) {
  const Scratch scratch;
  scratch.write("b.pvd", collection(set("0", "a.pvd")));
  for (const char* name : {"a.pvd", "b.pvd", "c.vtk.series", "B.PVD"})
    EXPECT_EQ(refused_series(scratch.write("a.pvd", collection(set("0", name)))).code(), ErrorCode::malformed_file);
}

TEST(SeriesFile, DamagedIsMalformed) {
  const Scratch scratch;
  for (const char* time : {"nan", "inf", "x", "", "1 2"})
    EXPECT_EQ(refused_series(scratch.write("a.pvd", collection(set(time, "a.vtk")))).code(), ErrorCode::malformed_file);
  for (const char* name : {"", "a&#0;b"})
    EXPECT_THROW(found(scratch.write("a.pvd", collection(set("0", name)))), Error);
  for (const std::string& text :
       {std::string(), std::string("{"), std::string("[]"), std::string("{\"files\": 7}"),
        std::string("{\"files\": [7]}"), std::string("{\"files\": [{\"name\": 7}]}"),
        std::string("{\"files\": [{\"name\": \"a\", \"time\": \"x\"}]}"),
        std::string("{\"files\": [{\"name\": \"\"}]}"),
        std::string("{\"files\": [{\"name\": \"a\", \"time\": 1e999}]}"), std::string(100000, '['),
        "{\"files\": " + std::string(100000, '[') + std::string(100000, ']') + "}",
        std::string("{\"files\": [{\"name\": \"a\xff\xfe\"}]}")})
    EXPECT_EQ(refused_series(scratch.write("a.vtk.series", text)).code(), ErrorCode::malformed_file)
        << text.substr(0, 60);
  const std::string whole = collection(set("0", "a.vtk"));
  scratch.write("a.vtk", kFrame);
  for (std::size_t size = 0; size < whole.size() - 2; ++size)
    EXPECT_EQ(refused_series(scratch.write("b.pvd", whole.substr(0, size))).code(), ErrorCode::malformed_file) << size;
}

TEST(SeriesFile, ReadAsAFrameIsUnsupported) {
  const Scratch scratch;
  for (const std::string& path : {scratch.write("a.pvd", collection(set("0", "a.vtk"))),
                                  scratch.write("a.vtk.series", "{\"file-series-version\": \"1.0\", \"files\": []}")}) {
    try {
      read_particles(path);
      ADD_FAILURE() << path;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::unsupported);
    }
  }
}

TEST(FindFrames, InADirectoryTakesParallelFilesAndNotTheirPieces) {
  const Scratch scratch;
  for (const int i : {1, 2, 3}) {
    scratch.write(fmt::format("d/f_{}.pvtu", i), "x");
    for (const int piece : {0, 1}) scratch.write(fmt::format("d/f_{}_{}.vtu", i, piece), std::string(1000, ' '));
  }
  const FrameSequence sequence = found(scratch.path("d"));
  ASSERT_EQ(sequence.frames.size(), 3u);
  EXPECT_EQ(sequence.frames[2].path, scratch.path("d/f_3.pvtu"));
}

}  // namespace
}  // namespace meniscus
