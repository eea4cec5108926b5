#include <gtest/gtest.h>

#include "program.h"

namespace meniscus {
namespace {

/// One line, with the program's name in front.
void expect_one_error(const Outcome& run, const std::string& part) {
  EXPECT_EQ(run.err.rfind("meniscus: error: ", 0), 0u) << run.err;
  EXPECT_EQ(run.err.find('\n'), run.err.size() - 1) << run.err;
  EXPECT_NE(run.err.find(part), std::string::npos) << run.err;
}

TEST(Help, ExitsWithZeroForEveryCommand) {
  const std::vector<std::vector<std::string>> commands = {
      {}, {"info"}, {"render"}, {"simulate"}, {"bench"}, {"bench", "raycast"}, {"compare"}};
  for (std::vector<std::string> command : commands) {
    command.push_back("--help");
    const Outcome run = run_program(command);
    EXPECT_EQ(run.exit_code, 0) << command.front();
    EXPECT_NE(run.out.find("Usage: meniscus"), std::string::npos) << run.out;
    EXPECT_EQ(run.err, "");
  }
  EXPECT_EQ(run_program({"--version"}).exit_code, 0);
}

TEST(Help, GivesUnitsAndGroups) {
  const std::string help = run_program({"render", "--help"}).out;
  for (const char* part :
       {"Input:", "Surface:", "Colour:", "Picture:", "Camera:", "Output:", "METRES", "DEGREES", "1/m"})
    EXPECT_NE(help.find(part), std::string::npos) << part;
}

TEST(WrongUsage, ExitsWithTwoAndOneLine) {
  const Folder folder;
  folder.write_block("a.xyz", 2);
  folder.write_block("b.xyz", 2);
  folder.write("waves.json",
               "{\"water\": {\"heights\": {\"waves\": [{\"amplitude\": 0.01}], \"region\": [[0, 0, 0], [1, "
               "0.5, 1]]}}}");
  const std::string frame = folder / "a.xyz", out = folder / "out.png";
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{}, "subcommand"},
      {{"paint"}, "paint"},
      {{"render"}, "WHAT"},
      {{"render", frame}, "--output"},
      {{"render", frame, "-o", out, "--colour-of-the-sea"}, "--colour-of-the-sea"},
      {{"render", frame, "-o", out, "--size", "big"}, "--size"},
      {{"render", frame, "-o", out, "--size", "0x10"}, "--size"},
      {{"render", frame, "-o", out, "--size", "99999x10"}, "--size"},
      {{"render", frame, "-o", out, "--iso", "2"}, "iso"},
      {{"render", frame, "-o", out, "--iso", "much"}, "--iso"},
      {{"render", frame, "-o", out, "--spacing", "-1"}, "--spacing"},
      {{"render", frame, "-o", out, "--kernel", "popcorn"}, "popcorn"},
      {{"render", frame, "-o", out, "--normals", "popcorn"}, "popcorn"},
      {{"render", frame, "-o", out, "--material", "popcorn"}, "popcorn"},
      {{"render", frame, "-o", out, "--colormap", "popcorn"}, "popcorn"},
      {{"render", frame, "-o", out, "--antialias", "popcorn"}, "popcorn"},
      {{"render", frame, "-o", out, "--ground", "popcorn"}, "popcorn"},
      {{"render", frame, "-o", out, "--instruction-set", "popcorn"}, "popcorn"},
      {{"render", frame, "-o", out, "--eye", "1,2"}, "--eye"},
      {{"render", frame, "-o", out, "--range", "3:1"}, "--range"},
      {{"render", frame, "-o", out, "--legend"}, "--color-by"},
      {{"render", frame, "-o", out, "--frames", "0:5:0"}, "--frames"},
      {{"render", frame, "-o", out, "--frames", "7:9"}, "--frames"},
      {{"render", frame, "-o", out, "--fov", "180"}, "field of view"},
      {{"render", frame, "-o", out, "--layers", "onion"}, "onion"},
      {{"render", frame, "-o", folder / "out.jpg"}, "out.jpg"},
      {{"render", frame, "-o", folder / "out"}, ".mp4"},
      {{"render", folder.path(), "-o", out}, "{}"},
      {{"render", frame, "-o", out, "--refraction", "virtual_eye", "--orthographic", "2"}, "--orthographic"},
      {{"render", folder / "waves.json", "-o", out, "--surface", "raycast"}, "--surface"},
      {{"bench"}, "subcommand"},
      {{"bench", "cooking"}, "cooking"},
      {{"bench", "raycast", "--particles", "0"}, "--particles"},
      {{"compare", out}, "B"},
  };
  for (const auto& [arguments, part] : cases) {
    const Outcome run = run_program(arguments);
    EXPECT_EQ(run.exit_code, 2) << part;
    expect_one_error(run, part);
  }
  EXPECT_FALSE(folder.has("out.png"));
}

TEST(FailedRun, ExitsWithOneAndNamesTheFile) {
  const Folder folder;
  folder.write_block("frame.xyz", 2);
  folder.write("truncated.ply",
               "ply\nformat binary_little_endian 1.0\nelement vertex 1000\nproperty float x\n"
               "property float y\nproperty float z\nend_header\nabcdefgh");
  folder.write("file", "not a directory");
  folder.write("nothing/readme.txt.md", "no frames");
  folder.write("scene.json", "{}");
  const std::string frame = folder / "frame.xyz", out = folder / "out.png";
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{"render", folder / "truncated.ply", "-o", out}, "truncated.ply"},
      {{"info", folder / "truncated.ply"}, "truncated.ply"},
      {{"render", folder / "missing.vtk", "-o", out}, "missing.vtk"},
      {{"render", folder / "nothing", "-o", out}, "nothing"},
      {{"render", folder / "scene.json", "-o", out}, "scene.json"},
      {{"render", frame, "-o", folder / "file/out.png"}, "file/out.png"},
      {{"render", frame, "-o", out, "--report", folder / "file/report.json"}, "file/report.json"},
      {{"render", frame, "-o", out, "--camera", folder / "missing.json"}, "missing.json"},
      {{"render", frame, "-o", out, "--environment", folder / "missing.hdr"}, "missing.hdr"},
      {{"render", frame, "-o", out, "--color-by", "loudness"}, "loudness"},
      {{"compare", out, out}, "out.png"},
  };
  for (const auto& [arguments, part] : cases) {
    const Outcome run = run_program(arguments);
    EXPECT_EQ(run.exit_code, 1) << part;
    expect_one_error(run, part);
  }
  EXPECT_FALSE(folder.has("out.png"));
}

}  // namespace
}  // namespace meniscus
